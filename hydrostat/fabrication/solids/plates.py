"""`lay_plates`: printed parts side by side, on as many beds as they need."""

from collections.abc import Iterable
from dataclasses import dataclass

from hydrostat.fabrication.solids.printed import Printed

_GAP = 5.0
"""Between parts on the bed [mm]."""


@dataclass(frozen=True)
class Laid:
    """One part on a bed.

    Attributes:
        part: its index.
        x: how far it is moved [mm], after it is turned.
        y: the same along y.
        turned: whether it is turned by a quarter, counter-clockwise from above.
    """

    part: int
    x: float
    y: float
    turned: bool


@dataclass(frozen=True)
class _Piece:
    part: int
    turned: bool
    low: tuple[float, float]
    size: tuple[float, float]


def lay_plates(parts: Iterable[Printed], bed: tuple[float, float]) -> tuple[tuple[Laid, ...], ...]:
    """The parts of each bed, every part as often as it is needed, in rows, the deepest first.

    A part is turned where only so it fits; one that does not fit at all has a bed of its own.

    Args:
        parts: to print.
        bed: its width and depth [mm].
    """
    pieces = [_piece(number, part, bed) for number, part in enumerate(parts) for _ in range(part.count)]
    pieces.sort(key=lambda piece: (-piece.size[1], piece.part))
    plates: list[list[Laid]] = [[]]
    x = y = row = 0.0
    for piece in pieces:
        wide, deep = piece.size
        if x > 0 and x + wide > bed[0]:
            x, y, row = 0.0, y + row + _GAP, 0.0
        if y > 0 and y + deep > bed[1]:
            plates.append([])
            x = y = row = 0.0
        plates[-1].append(Laid(piece.part, x - piece.low[0], y - piece.low[1], piece.turned))
        x, row = x + wide + _GAP, max(row, deep)
    return tuple(tuple(plate) for plate in plates if plate)


def _piece(number: int, part: Printed, bed: tuple[float, float]) -> _Piece:
    """A part as it lies best."""
    low_x, low_y, _, high_x, high_y, _ = part.solid.bounding_box()
    wide, deep = high_x - low_x, high_y - low_y
    turned = (wide > bed[0] or deep > bed[1]) and deep <= bed[0] and wide <= bed[1]
    if turned:
        return _Piece(number, turned, (-high_y, low_x), (deep, wide))
    return _Piece(number, turned, (low_x, low_y), (wide, deep))
