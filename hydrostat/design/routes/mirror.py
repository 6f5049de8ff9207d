"""`mirrored`: the last line of a layout, and its twin on the other side."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Points
from hydrostat.design.routes.layout import Layout, Line, Stand
from hydrostat.robot import Mount


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
    image_line = Line(
        twin, flipped(layout, points), lead=line.lead, slack=line.slack, ratio=line.ratio, make=line.make,
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
