"""`CableStitches`: how a cable is sewn through the cloth, hole by hole (R10)."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby

import shapely
from shapely import Polygon

from hydrostat.fabrication.patterns.shape import Place
from hydrostat.robot import Cable, Mount, Robot, sewn_sides


class Side(StrEnum):
    """Side of the cloth of a panel."""

    INSIDE = "inside"
    OUTSIDE = "outside"

    @property
    def other(self) -> "Side":
        """Side on which a cable is after it went through the cloth."""
        return Side.OUTSIDE if self is Side.INSIDE else Side.INSIDE


@dataclass(frozen=True, kw_only=True)
class Stitch:
    """Point of a cable, and what the cable does there."""

    number: int  # number of the point along its cable, 1 at the winch
    place: Place  # seen from the front, from the origin of the robot [mm]
    # True if the cable goes through the cloth here; else its winch or sheath is tied to the cloth with thread
    passes: bool
    after: Side  # on which side the cable runs on


@dataclass(frozen=True, kw_only=True)
class CableStitches:
    """All stitches of a cable, from its winch to its stopper."""

    cable: int  # its number, 1 for the first cable of the robot as it is sewn (`sewn_robot`)
    winch: str  # name of its winch
    begins: Side  # the side on which it comes from its winch
    stitches: tuple[Stitch, ...]  # one for each point of the cable
    panel: str = "front"  # name of the panel on which it is sewn

    @property
    def passes(self) -> tuple[Stitch, ...]:
        """Stitches that go through the cloth: out, in, out, ..."""
        return tuple(stitch for stitch in self.stitches if stitch.passes)

    @property
    def stopper(self) -> Side:
        """Side on which its stopper sits: the tension pulls it against the last hole."""
        return self.stitches[-1].after


def cable_stitches(robot: Robot, seam: Polygon) -> tuple[CableStitches, ...]:
    """Sew each cable: a running stitch through its points that ends outside, where its stopper can be adjusted.

    In pairs all are sewn on the front, and then all on the back.

    The winch sits inside, so its cables begin there; a sheath lies inside too. A bare stretch goes through the cloth at
    each of its points. Where that would end on the wrong side, it stays inside up to its second point: its beginning
    is held there by the winch or by the end of the sheath.

    A cable whose winch stands beside the body comes over the cloth, or through the seam, whichever ends outside; a
    sheath that begins at such a winch lies outside.
    """
    ways = [(panel, cable) for panel in sewn_sides(robot) for cable in robot.cables]
    return tuple(
        _stitch_cable(robot, number, cable, seam, panel) for number, (panel, cable) in enumerate(ways, start=1)
    )


def _stitch_cable(robot: Robot, number: int, cable: Cable, seam: Polygon, panel: str) -> CableStitches:
    places = [(1e3 * point[0], 1e3 * point[1]) for point in cable.points]
    world = robot.winch(cable.winch).mount is Mount.WORLD
    beside = world and not seam.intersects(shapely.Point(places[0]))
    begins = Side.OUTSIDE if world else Side.INSIDE
    if beside and cable.bare[0]:
        bare = next(run for run in runs_of(cable))[1]
        begins = Side.OUTSIDE if (bare[-1] - bare[0]) % 2 == (_end(cable, bare) is Side.INSIDE) else Side.INSIDE
    passes = [False] * len(places)
    side = begins
    for is_bare, points in runs_of(cable):
        if is_bare:
            holes = [point for point in points if point or not beside]
            wanted = _end(cable, points) is not side
            for hole in holes if len(holes) % 2 == wanted else holes[1:]:
                passes[hole] = True
            side = _end(cable, points)
        elif points[-1] == len(places) - 1:
            passes[-1] = side is Side.INSIDE
    stitches, side = [], begins
    for index, (at, through) in enumerate(zip(places, passes, strict=True)):
        side = side.other if through else side
        stitches.append(Stitch(number=index + 1, place=at, passes=through, after=side))
    return CableStitches(cable=number, winch=cable.winch, begins=begins, stitches=tuple(stitches), panel=panel)


def runs_of(cable: Cable) -> Iterator[tuple[bool, list[int]]]:
    """Stretches of a cable: whether each is bare, and the indices of its points."""
    for bare, group in groupby(range(len(cable.points) - 1), key=lambda segment: bool(cable.bare[segment])):
        segments = list(group)
        yield bare, [*segments, segments[-1] + 1]


def _end(cable: Cable, points: list[int]) -> Side:
    """Side on which a bare stretch has to end: outside at the stopper, inside before a sheath."""
    return Side.OUTSIDE if points[-1] == len(cable.points) - 1 else Side.INSIDE
