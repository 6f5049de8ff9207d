"""`hole_violations`: how near to one another cables pass the cloth, and how near to winches."""

from collections.abc import Iterator

import numpy as np

from hydrostat.design.checks.parts import LENGTH, Parts, mm
from hydrostat.robot import Mount

SAME = 1e-5
"""Points no farther apart than this [m] share a hole."""


def hole_violations(parts: Parts) -> Iterator[str]:
    """Via points of cables too near to each other, or to a winch in the body that pulls other cables.

    The first point of a cable, at its winch, is no hole.
    """
    cables = parts.robot.cables
    holes = [(index, at) for index, cable in enumerate(cables) for at in range(1, len(cable.points))]
    if not holes:
        return
    places = np.concatenate([points[1:] for points in parts.points])
    new = np.isin([index for index, _ in holes], parts.new_cables)
    yield from _near_each_other(parts, holes, places, new)
    yield from _near_winches(parts, holes, places, new)


def _near_each_other(parts: Parts, holes: list[tuple[int, int]], places: np.ndarray, new: np.ndarray) -> Iterator[str]:
    least = parts.constraints.hole_gap
    gaps = np.linalg.norm(places[:, None] - places, axis=2)
    close = (gaps < least - LENGTH) & (gaps > SAME * (1 + 1e-6)) & (new[:, None] | new)
    for one, other in np.argwhere(np.triu(close, 1)):
        yield (
            f"{_name(holes[other])} is {mm(gaps[one, other])} from {_name(holes[one])}, "
            f"less than the hole_gap of {mm(least)}"
        )


def _near_winches(parts: Parts, holes: list[tuple[int, int]], places: np.ndarray, new: np.ndarray) -> Iterator[str]:
    owners = np.array([parts.numbers[parts.robot.cables[index].winch] for index, _ in holes])
    for number, winch in enumerate(parts.robot.winches):
        if winch.mount is Mount.WORLD:
            continue
        gaps = np.linalg.norm(places - np.array(winch.at), axis=1)
        least = 2 * winch.spool_radius
        asked = (owners != number) & (new | (number in parts.new_winches))
        for index in np.flatnonzero(asked & (gaps < least - LENGTH)):
            yield (
                f"{_name(holes[index])} is {mm(gaps[index])} from {parts.winch_name(number)}, which pulls "
                f"other cables, less than two spool radii of {mm(least)}"
            )


def _name(hole: tuple[int, int]) -> str:
    return f"cable[{hole[0]}].points[{hole[1]}]"
