"""`Notch`: a stroke across the seam allowance, by which two panels are matched."""

from collections.abc import Iterator
from dataclasses import dataclass
from string import ascii_uppercase

import shapely
from shapely import LinearRing, LineString, Polygon

from hydrostat.fabrication.patterns.skin import Skin

_SPACING = 80.0
"""About how far apart notches are along the seam [mm]."""

_PAIR = 5.0
"""How far apart the two notches of the double notch are [mm]: it tells where top is."""


@dataclass(frozen=True)
class Notch:
    """One stroke.

    Attributes:
        ring: which seam it is on: 0 for the outer one, then the holes in order.
        along: how far along that seam from its top, with the body on the left [mm].
        name: a letter, the same on every panel; empty for the second stroke of the double notch.
        stroke: from the seam to the cut, seen from the front [mm].
    """

    ring: int
    along: float
    name: str
    stroke: LineString


def find_notches(skin: Skin) -> tuple[Notch, ...]:
    """Notches that meet when the panels lie on each other; none where the allowance is shared with another seam."""
    notches: list[Notch] = []
    allowance = skin.seam.boundary.distance(skin.cut.boundary)
    names = _names()
    for ring, seam, cut in _allowances(skin):
        top = seam_top(seam)
        count = max(4, round(seam.length / _SPACING))
        for along in sorted([_PAIR, *(seam.length * index / count for index in range(count))]):
            stroke = shapely.shortest_line(seam.interpolate((top + along) % seam.length), cut)
            if isinstance(stroke, LineString) and stroke.length < 1.5 * allowance and not stroke.intersects(skin.slits):
                notches.append(Notch(ring, along, "" if along == _PAIR else next(names), stroke))
    return tuple(notches)


def seam_top(seam: LinearRing) -> float:
    """How far along a seam its highest corner is [mm]: the double notch, and the join of the side strip."""
    return seam.project(shapely.Point(max(seam.coords, key=lambda corner: corner[1])))


def _names() -> Iterator[str]:
    """A, B, ... Z, AA, AB, ..."""
    yield from ascii_uppercase
    for first in _names():
        yield from (first + second for second in ascii_uppercase)


def _allowances(skin: Skin) -> Iterator[tuple[int, LinearRing, LinearRing]]:
    """Each ring of the seam with its parallel in the cut."""
    if skin.seam.boundary.distance(skin.cut.boundary) < 1.0:
        return
    yield 0, skin.seam.exterior, skin.cut.exterior
    for cut in skin.cut.interiors:
        inner = shapely.Point(cut.coords[0])
        holes = list(enumerate(skin.seam.interiors, start=1))
        ring, seam = min(holes, key=lambda hole: Polygon(hole[1]).distance(inner))
        yield ring, seam, cut
