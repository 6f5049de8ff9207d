"""`layout_of`, `mirrored`: the network of a robot as a layout, and parts with their images on the other side."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Points
from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.layout import Layout, Line, Stand
from hydrostat.robot import Cable, Mount, Robot


def mirrored(layout: Layout) -> Layout | None:
    """The layout with the mirror image of its last line, and of that line's winch where that has none yet.

    A new winch nearer to the mirror than half the gap that two winches keep is put into it and pulls both lines. None
    where that winch is locked, or where the world has no winch for the other side.
    """
    line = layout.lines[-1]
    number, stand = line.winch, layout.stands[line.winch]
    stands = list(layout.stands)
    twin = stand.twin
    if twin is None and any(other.twin == number for other in stands):
        twin = next(index for index, other in enumerate(stands) if other.twin == number)
    elif twin is None:
        image = flipped(layout, np.array([stand.winch.at]))[0]
        gap = float(np.linalg.norm(image - stand.winch.at))
        other = _standing(stands, image, number)
        world = stand.winch.mount is Mount.WORLD
        if gap < 1e-6:
            stands[number] = replace(stand, twin=number)
            twin = number
        elif other is not None:
            twin = other
        elif world:
            name = _world_winch(layout, image)
            if name is None:
                return None
            twin = len(stands)
            stands.append(Stand(replace(stand.winch, name=name, at=tuple(map(float, image))), twin=number))
        elif gap < layout.constraints.winch_gap:
            if stand.fixed:
                return None
            middle = tuple(float(value) for value in 0.5 * (image + stand.winch.at))
            stands[number] = replace(stand, winch=replace(stand.winch, at=middle), twin=number)
            twin = number
        else:
            twin = len(stands)
            stands.append(
                Stand(
                    replace(stand.winch, name=f"{stand.winch.name}_mirrored", at=tuple(map(float, image))), twin=number
                )
            )
    points = np.vstack([stands[number].winch.at, line.points[1:]])
    own = replace(line, points=points)
    make = None if line.make is None else replace(line.make, name="")
    image_line = Line(
        twin, flipped(layout, points), lead=line.lead, slack=line.slack, ratio=line.ratio, make=make,
        twin=len(layout.lines) - 1,
    )  # fmt: skip
    return replace(layout, stands=tuple(stands), lines=(*layout.lines[:-1], own, image_line))


def flipped(layout: Layout, points: Points) -> Points:
    """Points on the other side of the mirror."""
    assert layout.constraints.mirror is not None
    flip = np.ones(layout.dim)
    flip["xyz".index(layout.constraints.mirror)] = -1.0
    return points * flip


def _world_winch(layout: Layout, place: np.ndarray) -> str | None:
    """Name of the robot's own winch at a place in the world; None if there is none."""
    for winch in layout.source.winches:
        if winch.mount is Mount.WORLD and np.linalg.norm(np.subtract(winch.at, place)) < _SAME_PLACE:
            return winch.name
    return None


def _standing(stands: list[Stand], place: np.ndarray, but: int) -> int | None:
    """A winch that stands at a place already."""
    for index, stand in enumerate(stands):
        if index != but and np.linalg.norm(np.subtract(stand.winch.at, place)) < 1e-6:
            return index
    return None


_SAME_PLACE = 1e-4
"""Winches of the two sides may miss each other's image by so much [m]."""


def layout_of(robot: Robot, constraints: Constraints) -> Layout:
    """Winches and cables of a robot; those that are locked stay as they are.

    A cable sheathed anywhere but from its winch on is kept as it is too, and its winch: what is sheathed in the middle
    is not moved. Parts that mirror each other are tied together where the design should be symmetric.

    Args:
        robot: with the network.
        constraints: that it should keep.
    """
    names = [winch.name for winch in robot.winches]
    lines = []
    for cable, given_name in zip(robot.cables, robot.given_cable_names, strict=True):
        lead = _lead(cable)
        kept = cable.name in constraints.locked_cables or lead is None
        winch = robot.winch(cable.winch)
        ratio = 1.0 if cable.spool_radius is None else cable.spool_radius / winch.spool_radius
        lines.append(
            Line(
                names.index(cable.winch),
                np.array(cable.points),
                lead=lead or 0,
                slack=cable.slack,
                ratio=ratio,
                make=replace(cable, name=given_name),  # one that was made up follows its winch
                kept=cable if kept else None,
            )
        )
    held = {line.winch for line in lines if line.kept is not None}
    stands = [
        Stand(winch, fixed=number in held or winch.name in constraints.locked_winches)
        for number, winch in enumerate(robot.winches)
    ]
    layout = Layout(robot, constraints, tuple(stands), tuple(lines))
    return layout if constraints.mirror is None else _tied(layout)


def _tied(layout: Layout) -> Layout:
    """The layout whose parts know their mirror images; what has none is left free."""
    stands, lines = list(layout.stands), list(layout.lines)
    places = np.array([stand.winch.at for stand in stands], dtype=float).reshape(-1, layout.dim)
    images: dict[int, int] = {}
    for index, image in enumerate(flipped(layout, places)):
        away = np.linalg.norm(places - image, axis=1)
        if away.min() <= _NEAR:
            images[index] = int(away.argmin())
    for index, other in images.items():
        if other <= index and not stands[index].fixed:
            stands[index] = replace(stands[index], twin=other)
    for index, line in enumerate(lines):
        taken = {other.twin for other in lines}
        for before, first in enumerate(lines[:index]):
            free = line.kept is None and first.twin is None and before not in taken
            if free and _are_twins(layout, first, line, images):
                lines[index] = replace(line, twin=before)
                break
    return replace(layout, stands=tuple(stands), lines=tuple(lines))


def _are_twins(layout: Layout, first: Line, second: Line, images: dict[int, int]) -> bool:
    return (
        images.get(first.winch) == second.winch
        and first.points.shape == second.points.shape
        and first.lead == second.lead
        and float(np.abs(flipped(layout, first.points) - second.points).max()) <= _NEAR
    )


def _lead(cable: Cable) -> int | None:
    """How many segments from the winch on are sheathed; None if others are."""
    sheathed = ~cable.bare
    count = int(np.argmin(sheathed)) if sheathed.any() else 0
    return None if sheathed[count:].any() else count


_NEAR = 1e-4
"""What is so near to a mirror image [m] is that image."""
