"""`Assembly`: solids where they belong, and whether they get into each other's way."""

from dataclasses import dataclass
from itertools import combinations

from manifold3d import Manifold


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """One thing in an assembly.

    Attributes:
        name: of the piece, unique in the assembly, as in `Printed.name` if it is printed.
        title: what a person calls it.
        solid: where it belongs when assembled [mm].
        pulled: how far it is drawn away in an exploded picture [mm].
        printed: whether it is printed; else it is bought, and this is its envelope.
    """

    name: str
    title: str
    solid: Manifold
    pulled: tuple[float, float, float] = (0.0, 0.0, 0.0)
    printed: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Assembly:
    """Things put together, in millimetres.

    Attributes:
        name: of the whole.
        pieces: in the order in which they are put together.
    """

    name: str
    pieces: tuple[Placed, ...]


@dataclass(frozen=True)
class Interference:
    """Two pieces that need the same place.

    Attributes:
        one: name of a piece.
        other: name of another.
        volume: of what they share [mm^3].
    """

    one: str
    other: str
    volume: float


def interferences(assembly: Assembly, *, least: float = 1e-3) -> tuple[Interference, ...]:
    """All pairs of pieces that share more than `least` [mm^3], by boolean intersection."""
    found = []
    for one, other in combinations(assembly.pieces, 2):
        shared = float((one.solid ^ other.solid).volume())
        if shared > least:
            found.append(Interference(one.name, other.name, shared))
    return tuple(found)
