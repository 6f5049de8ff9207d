"""`PartAssembly`: solids where they belong, and whether they get into each other's way."""

from dataclasses import dataclass
from itertools import combinations
from math import pi

from manifold3d import Manifold

MIN_OVERLAP = 1e-3  # mean thickness of what two pieces share, above which they are in each other's way [mm]


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """Part of an assembly."""

    name: str  # name of the piece, unique in the assembly, as in `Printed.name` if it is printed
    title: str  # title for a person
    solid: Manifold  # solid in its assembled place [mm]
    pulled: tuple[float, float, float] = (0.0, 0.0, 0.0)  # offset in an exploded picture [mm]
    printed: bool = True  # True if it is printed; else it is bought, and this is its envelope


@dataclass(frozen=True, eq=False, kw_only=True)
class PartAssembly:
    """Parts put together, in millimeters."""

    name: str  # name of the assembly
    pieces: tuple[Placed, ...]  # in the order in which they are put together


@dataclass(frozen=True)
class Interference:
    """Two pieces that need the same place."""

    one: str  # name of a piece
    other: str  # name of another
    volume: float  # volume of their overlap [mm^3]


def interferences(assembly: PartAssembly, *, least: float = MIN_OVERLAP) -> tuple[Interference, ...]:
    """All pairs of pieces that share room, by booleans.

    What two share is what they lose when they are joined: measured on the intersection itself it would be wrong where
    faces of many triangles touch, as the film that it leaves there has no volume, but gets one when it is tidied up.

    Faces that touch are rounded, each by itself: what they share is a film. So that it counts, what is shared must have
    a mean thickness (twice its volume over its area) of more than `least` [mm]. No shape of a volume is thicker than a
    ball, so hardly a pair has to be intersected too, which takes longer still where faces of many triangles touch.
    """
    found = []
    for one, other in combinations(assembly.pieces, 2):
        if not _near(one.solid, other.solid):
            continue
        volume = float(one.solid.volume() + other.solid.volume() - (one.solid + other.solid).volume())
        if volume <= 4 / 3 * pi * (1.5 * least) ** 3:
            continue
        area = float((one.solid ^ other.solid).surface_area())
        if area > 0 and 2 * volume / area > least:
            found.append(Interference(one.name, other.name, volume))
    return tuple(found)


def _near(one: Manifold, other: Manifold) -> bool:
    """Return True if the bounding boxes of two solids intersect."""
    mine, theirs = one.bounding_box(), other.bounding_box()
    return all(mine[axis] <= theirs[axis + 3] and theirs[axis] <= mine[axis + 3] for axis in range(3))
