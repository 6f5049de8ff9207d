"""`layout_of`: the network of a robot as a layout, to be kept or improved."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.layout import Layout, Line, Stand
from hydrostat.design.routes.mirror import flipped
from hydrostat.robot import Cable, Robot


def layout_of(robot: Robot, constraints: Constraints, *, locked: Collection[int] | None = None) -> Layout:
    """Winches and cables of a robot; those that are locked stay as they are.

    A cable sheathed anywhere but from its winch on is kept as it is too, and its winch: what is sheathed in the middle
    is not moved. Parts that mirror each other are tied together where the design should be symmetric.

    Args:
        robot: with the network.
        constraints: that it should keep.
        locked: numbers of the cables that stay; those of the constraints if left out, which count the cables of the
            robot that is designed for.
    """
    locked = constraints.locked_cables if locked is None else locked
    names = [winch.name for winch in robot.winches]
    lines = []
    for number, cable in enumerate(robot.cables):
        lead = _lead(cable)
        kept = number in locked or lead is None
        winch = robot.winch(cable.winch)
        ratio = 1.0 if cable.spool_radius is None else cable.spool_radius / winch.spool_radius
        lines.append(
            Line(
                names.index(cable.winch),
                np.array(cable.points),
                lead=lead or 0,
                slack=cable.slack,
                ratio=ratio,
                make=cable,
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
