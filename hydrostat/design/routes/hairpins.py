"""`hairpin_margins`: room that is left to cables from the world before they turn back past their own winch."""

from collections.abc import Iterator

import numpy as np

from hydrostat.arrays import Float, Int, Points, Vector
from hydrostat.design.checks.cables import BEHIND, HAIRPIN
from hydrostat.design.polyline import nearest_shares
from hydrostat.design.routes.layout import Layout
from hydrostat.robot import Mount

Row = tuple[Vector, float]  # slopes of a limit by the numbers of a layout, and the room that it leaves [m]


def hairpin_margins(layout: Layout, *, reach: float, hair: float, degrees: float) -> Iterator[Row]:
    """Yield limits within reach [m]; `hair` [m] and `degrees` are kept back from them.

    A cable may turn back where it enters if it stays away from its winch, and come near its winch if it does not turn
    back: the limit that leaves more room holds.
    """
    chain = layout.chains
    for index, route in enumerate(layout.routes):
        winch = layout.sites[route.winch].winch
        members = chain.members[chain.begins[index] : chain.begins[index + 1]]
        if winch.mount is not Mount.WORLD or route.kept is not None or len(members) < 3:
            continue
        turn = _turn_margin(layout, members[:3], np.radians(HAIRPIN - degrees))
        gaps = list(_gap_margins(layout, members, BEHIND * winch.spool_radius + hair, reach))
        closest = min((left for _, left in gaps), default=reach)
        yield from gaps if closest > turn[1] else [turn] if turn[1] <= reach else []


def _turn_margin(layout: Layout, corner: Int[np.ndarray, " 3"], most: float) -> Row:
    """Room of the turn at the second of three places, its angle times the shorter segment [m]."""
    places = layout.places[corner]
    spans = np.diff(places, axis=0)
    lengths = np.maximum(np.linalg.norm(spans, axis=1), _ZERO_LENGTH)
    units = spans / lengths[:, None]
    cosine = float(np.clip(units[0] @ units[1], -1.0, 1.0))
    room, short = most - float(np.arccos(cosine)), int(np.argmin(lengths))
    by_spans = lengths[short] * np.stack([_aside(units[0], units[1]), _aside(units[1], units[0])]) / lengths[:, None]
    by_spans[short] += room * units[short]
    slopes = np.stack([-by_spans[0], by_spans[0] - by_spans[1], by_spans[1]])
    return _row(layout, corner, -slopes), float(room * lengths[short])


def _aside(unit: Vector, other: Vector) -> Vector:
    """Direction across `unit` that leads to the other; any where the two are opposite."""
    across = other - (other @ unit) * unit
    size = float(np.linalg.norm(across))
    if size > _OPPOSITE:
        return across / size
    axis = np.eye(len(unit))[np.argmin(np.abs(unit))]
    across = axis - (axis @ unit) * unit
    return across / np.linalg.norm(across)


def _gap_margins(layout: Layout, members: Int[np.ndarray, " _"], least: float, reach: float) -> Iterator[Row]:
    """Room of each segment behind the entry to the winch [m]."""
    places: Points = layout.places[members]
    runs = np.stack([places[1:-1], places[2:]], axis=1)
    shares = nearest_shares(runs, np.tile(places[0], (len(runs), 2, 1)))[0]
    spans = runs[:, 0] + shares[:, None] * (runs[:, 1] - runs[:, 0]) - places[0]
    for at, (share, span) in enumerate(zip(shares, spans, strict=True), start=1):
        distance = float(np.linalg.norm(span))
        if distance - least > reach:
            continue
        run = places[at + 1] - places[at]
        way = (
            span / distance
            if distance > _ZERO_LENGTH
            else _aside(run / max(np.linalg.norm(run), _ZERO_LENGTH), 0.0 * run)
        )
        slopes: Float[np.ndarray, "3 dim"] = np.stack([way, -(1 - share) * way, -share * way])
        yield _row(layout, members[[0, at, at + 1]], slopes), distance - least


def _row(layout: Layout, places: Int[np.ndarray, " places"], slopes: Float[np.ndarray, "places dim"]) -> Vector:
    row = np.zeros(layout.size)
    np.add.at(row, layout.dim * places[:, None] + np.arange(layout.dim), slopes)
    return row


_ZERO_LENGTH = 1e-9  # lengths below it have no direction [m]
_OPPOSITE = 1e-9  # sine below which two directions have no plane
