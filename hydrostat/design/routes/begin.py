"""`layout_of`, `add_mirror_image`: the network of a robot as a layout, and parts with their mirror images."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Points
from hydrostat.design.checks.winches import MIRROR_TOLERANCE
from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
from hydrostat.robot import Cable, Mount, Robot


def add_mirror_image(layout: Layout) -> Layout | None:
    """Add the mirror image of the last line, and of that line's winch where that has none yet.

    A new winch nearer to the mirror than half the gap that two winches keep is put into it and pulls both lines. None
    where that winch is locked, or where the world has no winch for the other side.
    """
    route = layout.routes[-1]
    number, site = route.winch, layout.sites[route.winch]
    sites = list(layout.sites)
    twin = site.twin
    if twin is None and any(other.twin == number for other in sites):
        twin = next(index for index, other in enumerate(sites) if other.twin == number)
    elif twin is None:
        image = reflect_points(layout, np.array([site.winch.at]))[0]
        gap = float(np.linalg.norm(image - site.winch.at))
        other = _site_at(sites, image, number)
        world = site.winch.mount is Mount.WORLD
        if gap < 1e-6:
            sites[number] = replace(site, twin=number)
            twin = number
        elif other is not None:
            twin = other
        elif world:
            name = _world_winch(layout, image)
            if name is None:
                return None
            twin = len(sites)
            sites.append(WinchSite(replace(site.winch, name=name, at=tuple(map(float, image))), twin=number))
        elif gap < layout.constraints.winch_gap:
            if site.fixed:
                return None
            middle = tuple(float(value) for value in 0.5 * (image + site.winch.at))
            sites[number] = replace(site, winch=replace(site.winch, at=middle), twin=number)
            twin = number
        else:
            twin = len(sites)
            sites.append(
                WinchSite(
                    replace(site.winch, name=f"{site.winch.name}_mirrored", at=tuple(map(float, image))), twin=number
                )
            )
    points = np.vstack([sites[number].winch.at, route.points[1:]])
    own = replace(route, points=points)
    make = None if route.make is None else replace(route.make, name="")
    image_route = CableRoute(
        twin, reflect_points(layout, points), lead=route.lead, slack=route.slack, ratio=route.ratio, make=make,
        twin=len(layout.routes) - 1,
    )  # fmt: skip
    return replace(layout, sites=tuple(sites), routes=(*layout.routes[:-1], own, image_route))


def reflect_points(layout: Layout, points: Points) -> Points:
    """Return points on the other side of the mirror."""
    return points * layout.constraints.flip(layout.dim)


def _world_winch(layout: Layout, place: np.ndarray) -> str | None:
    """Name of the robot's own winch at a place in the world; None if there is none."""
    for winch in layout.source.winches:
        if winch.mount is Mount.WORLD and np.linalg.norm(np.subtract(winch.at, place)) < _SAME_PLACE:
            return winch.name
    return None


def _site_at(sites: list[WinchSite], place: np.ndarray, but: int) -> int | None:
    """A winch that stands at a place already."""
    for index, site in enumerate(sites):
        if index != but and np.linalg.norm(np.subtract(site.winch.at, place)) < 1e-6:
            return index
    return None


_SAME_PLACE = 1e-4  # winches of the two sides may miss each other's image by so much [m]


def layout_of(robot: Robot, constraints: Constraints) -> Layout:
    """Winches and cables of a robot; those that are locked stay as they are.

    A cable sheathed anywhere but from its winch on is kept as it is too, and its winch: what is sheathed in the middle
    is not moved. Parts that mirror each other are tied together where the design should be symmetric.
    """
    names = [winch.name for winch in robot.winches]
    routes = []
    for cable, given_name in zip(robot.cables, robot.given_cable_names, strict=True):
        lead = _lead(cable)
        kept = cable.name in constraints.locked_cables or lead is None
        winch = robot.winch(cable.winch)
        ratio = 1.0 if cable.spool_radius is None else cable.spool_radius / winch.spool_radius
        ratio = -ratio if cable.reverse else ratio
        routes.append(
            CableRoute(
                names.index(cable.winch),
                np.array(cable.points),
                lead=lead or 0,
                slack=cable.slack,
                ratio=ratio,
                make=replace(cable, name=given_name),  # one that was made up follows its winch
                kept=cable if kept else None,
            )
        )
    held = {route.winch for route in routes if route.kept is not None}
    sites = [
        WinchSite(winch, fixed=number in held or winch.name in constraints.locked_winches)
        for number, winch in enumerate(robot.winches)
    ]
    layout = Layout(robot, constraints, tuple(sites), tuple(routes))
    return layout if constraints.mirror is None else _tie_twins(layout)


def _tie_twins(layout: Layout) -> Layout:
    """Link each part to its mirror image; parts without one stay free."""
    sites, routes = list(layout.sites), list(layout.routes)
    places = np.array([site.winch.at for site in sites], dtype=float).reshape(-1, layout.dim)
    images: dict[int, int] = {}
    for index, image in enumerate(reflect_points(layout, places)):
        away = np.linalg.norm(places - image, axis=1)
        if away.min() <= MIRROR_TOLERANCE:
            images[index] = int(away.argmin())
    for index, other in images.items():
        if other <= index and not sites[index].fixed:
            sites[index] = replace(sites[index], twin=other)
    for index, route in enumerate(routes):
        taken = {other.twin for other in routes}
        for before, first in enumerate(routes[:index]):
            free = route.kept is None and first.twin is None and before not in taken
            if free and _are_twins(layout, first, route, images):
                routes[index] = replace(route, twin=before)
                break
    return replace(layout, sites=tuple(sites), routes=tuple(routes))


def _are_twins(layout: Layout, first: CableRoute, second: CableRoute, images: dict[int, int]) -> bool:
    return (
        images.get(first.winch) == second.winch
        and first.points.shape == second.points.shape
        and first.lead == second.lead
        and float(np.abs(reflect_points(layout, first.points) - second.points).max()) <= MIRROR_TOLERANCE
    )


def _lead(cable: Cable) -> int | None:
    """Number of segments that are sheathed from the winch on; None if others are."""
    sheathed = ~cable.bare
    count = int(np.argmin(sheathed)) if sheathed.any() else 0
    return None if sheathed[count:].any() else count
