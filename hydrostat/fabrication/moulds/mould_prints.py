"""`mould_prints`: the pieces of a mould as they lie on the bed of the printer."""

from manifold3d import Manifold

from hydrostat.fabrication.moulds.closing import Block
from hydrostat.fabrication.moulds.halves import Halves
from hydrostat.fabrication.moulds.positive import Frames, Positive
from hydrostat.fabrication.moulds.split import Pieces, grid, split
from hydrostat.fabrication.solids.printed import Printed

_HALF = "Back on the bed, no support. Walls of 3 lines and 10 to 15 % infill are enough; layers of 0.2 mm."
_POSITIVE = "Flat side on the bed. 10 % infill; fill and sand what silicone should not copy."
_FRAME = "As it lies. Seal it to the board and at its joints with clay or tape: silicone finds every gap."
_DOME = "Flat side on the bed. They lie at the corners of the first pour and leave sockets in the silicone."
_JOINED = " Glue it to its neighbours with 3 mm dowels in the holes."

_Lying = tuple[float, float, float]
_UP: _Lying = (0.0, 0.0, 0.0)
_OVER: _Lying = (180.0, 0.0, 0.0)


def mould_prints(
    halves: Halves, positive: Positive, frames: Frames | None, block: Block, bed: tuple[float, float, float]
) -> tuple[tuple[Printed, ...], int, float]:
    """All pieces, how many dowels join those of the mould, and what cutting takes [mm^3].

    Of a printed mould the positive is spare: its dowels do not count. What cutting takes is taken from the halves of
    the mould, or of the positive where the mould is of silicone.
    """
    printed: list[Printed] = []
    dowels, holes = (positive.dowels, positive.lost) if frames else (0, 0.0)
    if frames is None:
        for name, title, solid, lying in (
            ("mould_lower", "lower half", halves.lower, _UP),
            ("mould_upper", "upper half", halves.upper, _OVER),
        ):
            pieces = split(solid, block.x_cuts, block.y_cuts)
            printed += _printed(name, title, pieces.solids, lying, _HALF)
            dowels += pieces.dowels
            holes += pieces.lost
    for name, title, solid, lying in (
        ("positive_lower", "lower half of the positive", positive.lower, _OVER),
        ("positive_upper", "upper half of the positive", positive.upper, _UP),
        *(
            (
                ("frame_lower", "lower frame", frames.lower, _UP),
                ("frame_upper", "upper frame", frames.upper, _UP),
            )
            if frames
            else ()
        ),
    ):
        pieces = _fitted(solid, bed)
        framing = name.startswith("frame")
        printed += _printed(name, title, pieces.solids, lying, _FRAME if framing else _POSITIVE)
        dowels += pieces.dowels if frames else 0
        holes += pieces.lost if frames and not framing else 0.0
    if frames:
        printed.append(Printed(name="key_dome", title="key dome", solid=frames.dome, count=4, note=_DOME))
    return tuple(printed), dowels, holes


def _fitted(solid: Manifold, bed: tuple[float, float, float]) -> Pieces:
    """Pieces of a solid that fit the bed; none for a half with nothing in it."""
    if solid.is_empty():
        return Pieces(solids=(), dowels=0, lost=0.0)
    box = solid.bounding_box()
    return split(solid, *grid(box[:3], box[3:], bed))


def _printed(name: str, title: str, solids: tuple[Manifold, ...], lying: _Lying, note: str) -> list[Printed]:
    if len(solids) == 1:
        return [Printed(name=name, title=title, solid=_laid(solids[0], lying), note=note)]
    return [
        Printed(
            name=f"{name}_{number}",
            title=f"{title}, piece {number} of {len(solids)}",
            solid=_laid(solid, lying),
            note=note + _JOINED,
        )
        for number, solid in enumerate(solids, start=1)
    ]


def _laid(solid: Manifold, lying: _Lying) -> Manifold:
    """A solid turned, its lowest corner at the origin."""
    turned = solid.rotate(lying)
    low = turned.bounding_box()[:3]
    return turned.translate(tuple(-place for place in low))
