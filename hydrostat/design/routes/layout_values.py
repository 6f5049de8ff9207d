"""`layout_values`, `read_layout`: a layout as plain values, and back with the same bits."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
from hydrostat.robot import Cable, Robot, Winch

Values = dict[str, Any]


def layout_values(layout: Layout) -> Values:
    """Winches and cables of a layout as numbers, texts and lists [m]."""
    return {
        "winches": [{"winch": asdict(site.winch), "fixed": site.fixed, "mirrors": site.twin} for site in layout.sites],
        "cables": [
            {
                "winch": route.winch,
                "points": route.points.tolist(),
                "lead": route.lead,
                "slack": route.slack,
                "ratio": route.ratio,
                "make": None if route.make is None else asdict(route.make),
                "kept": None if route.kept is None else asdict(route.kept),
                "mirrors": route.twin,
            }
            for route in layout.routes
        ],
    }


def read_layout(values: Mapping[str, Any], source: Robot, constraints: Constraints) -> Layout:
    """The layout of some values, of a robot and its constraints."""
    sites = tuple(
        WinchSite(Winch(**(one["winch"] | {"at": tuple(one["winch"]["at"])})), fixed=one["fixed"], twin=one["mirrors"])
        for one in values["winches"]
    )
    routes = tuple(
        CableRoute(
            one["winch"],
            np.array(one["points"], dtype=float),
            lead=one["lead"],
            slack=one["slack"],
            ratio=one["ratio"],
            make=_read_cable(one["make"]),
            kept=_read_cable(one["kept"]),
            twin=one["mirrors"],
        )
        for one in values["cables"]
    )
    return Layout(source, constraints, sites, routes)


def _read_cable(values: Mapping[str, Any] | None) -> Cable | None:
    if values is None:
        return None
    pairs: Values = {name: tuple(map(tuple, values[name])) for name in ("points", "sheathed")}
    return Cable(**(dict(values) | pairs))
