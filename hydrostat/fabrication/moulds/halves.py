"""`Halves`: two halves of a block round a cavity, where its volume goes, and the pieces as they are printed."""

from dataclasses import dataclass

from manifold3d import Manifold

from hydrostat.fabrication.moulds.closing import Closing, MoldBlock
from hydrostat.fabrication.moulds.openings import Sprue, Vent
from hydrostat.fabrication.moulds.pocket import Pocket
from hydrostat.fabrication.moulds.positive import Frames, Positive
from hydrostat.fabrication.moulds.solids import join_solids
from hydrostat.fabrication.moulds.split import Pieces, grid, split_solid
from hydrostat.fabrication.solids.printed import Printed


@dataclass(frozen=True, eq=False, kw_only=True)
class Halves:
    """A mold, closed, in its own coordinates."""

    upper: Manifold  # half that is drawn along the pull
    lower: Manifold  # half that stays
    cavity: Manifold  # the body less pockets and dents: what the foam becomes
    poured: Manifold  # all that is filled with foam: the cavity with sprue and vents, as far as they are in the block
    # volume of each part [mm^3], see `Mold.volumes`; each is measured on its own solid, none is a remainder
    volumes: dict[str, float]


def make_cavity(body: Manifold, dents: Manifold, pockets: tuple[Pocket, ...]) -> Manifold:
    """The body without what the mold reaches into it."""
    cavity = body - dents
    for pocket in pockets:
        cavity = cavity - pocket.core
    return cavity


def make_halves(
    block: MoldBlock,
    body: Manifold,
    dents: Manifold,
    pockets: tuple[Pocket, ...],
    *,
    sprue: Sprue | None,
    vents: tuple[Vent, ...],
    closing: Closing,
) -> Halves:
    """Both halves; parted at z = 0, but cores of pockets stay whole with the half they are drawn off with."""
    cavity = make_cavity(body, dents, pockets)
    openings = {
        "sprue": Manifold() if sprue is None else sprue.solid,
        "vents": join_solids(vent.solid for vent in vents),
        "bolts": closing.holes,
        "slots": closing.slots,
    }
    solid = block.solid - cavity
    for opening in openings.values():
        solid = solid - opening
    above = _upper_side(pockets)
    upper, lower = (solid ^ above) - closing.sockets, (solid - above) + closing.bumps
    account = {"box": volume(block.solid), "body": volume(body)}
    account["dents"], account["pockets"] = _removed_volumes(body, dents, pockets)
    account["cavity"] = volume(cavity)
    account |= _voids(block, cavity, openings, closing)
    account |= {"upper": volume(upper), "lower": volume(lower)}
    poured = cavity + ((openings["sprue"] + openings["vents"]) ^ block.solid)
    return Halves(upper=upper, lower=lower, cavity=cavity, poured=poured, volumes=account)


def _voids(block: MoldBlock, cavity: Manifold, openings: dict[str, Manifold], closing: Closing) -> dict[str, float]:
    """Volume that each opening removes from the plastic [mm^3], overlaps by the first, and of the gaps round keys."""
    account, taken = {}, cavity
    for name, opening in openings.items():
        inside = opening ^ block.solid
        account[name] = volume(inside - taken)
        taken = taken + inside
    keys = closing.bumps.trim_by_plane((0.0, 0.0, 1.0), 0.0)
    sockets = closing.sockets.trim_by_plane((0.0, 0.0, 1.0), 0.0)
    return account | {"keys": volume((sockets ^ block.solid) - taken) - volume(keys)}


def volume(solid: Manifold) -> float:
    """Volume of a solid [mm^3]."""
    return float(solid.volume())


def _removed_volumes(body: Manifold, dents: Manifold, pockets: tuple[Pocket, ...]) -> tuple[float, float]:
    """Volumes that dents remove from the body, and pockets from the rest [mm^3]."""
    cores = join_solids(pocket.core for pocket in pockets)
    return volume(body ^ dents), volume(cores ^ body) - volume(cores ^ body ^ dents)


def _upper_side(pockets: tuple[Pocket, ...]) -> Manifold:
    """All that belongs to the upper half: what is above the parting plane, less cores of the lower half, and so on."""
    far = 1e4
    side = Manifold.cube((2 * far, 2 * far, far)).translate((-far, -far, 0.0))
    for pocket in pockets:
        side = side + pocket.reach if pocket.upper else side - pocket.reach
    return side


_HALF = "Back on the bed, no support. Walls of 3 lines and 10 to 15 % infill are enough; layers of 0.2 mm."
_POSITIVE = "Flat side on the bed. 10 % infill; fill and sand what silicone should not copy."
_FRAME = "As it lies. Seal it to the board and at its joints with clay or tape: silicone finds every gap."
_DOME = "Flat side on the bed. They lie at the corners of the first pour and leave sockets in the silicone."
_JOINED = " Glue it to its neighbors with 3 mm dowels in the holes."

_Lying = tuple[float, float, float]
_UP: _Lying = (0.0, 0.0, 0.0)
_OVER: _Lying = (180.0, 0.0, 0.0)


def mold_prints(
    halves: Halves, positive: Positive, frames: Frames | None, block: MoldBlock, bed: tuple[float, float, float]
) -> tuple[tuple[Printed, ...], int, float]:
    """All pieces, how many dowels join those of the mold, and what cutting takes [mm^3].

    Of a printed mold the positive is spare: its dowels do not count. What cutting takes is taken from the halves of
    the mold, or of the positive where the mold is of silicone.
    """
    printed: list[Printed] = []
    dowels, holes = (positive.dowels, positive.lost) if frames else (0, 0.0)
    if frames is None:
        for name, title, solid, lying in (
            ("mould_lower", "lower half", halves.lower, _UP),
            ("mould_upper", "upper half", halves.upper, _OVER),
        ):
            pieces = split_solid(solid, block.x_cuts, block.y_cuts)
            printed += _make_pieces(name, title, pieces.solids, lying, _HALF)
            dowels += pieces.dowels
            holes += pieces.lost
    for name, title, solid, lying in (
        ("positive_lower", "lower half of the positive", positive.lower, _OVER),
        ("positive_upper", "upper half of the positive", positive.upper, _UP),
        *(
            (("frame_lower", "lower frame", frames.lower, _UP), ("frame_upper", "upper frame", frames.upper, _UP))
            if frames
            else ()
        ),
    ):
        pieces = _fit_pieces(solid, bed)
        framing = name.startswith("frame")
        printed += _make_pieces(name, title, pieces.solids, lying, _FRAME if framing else _POSITIVE)
        dowels += pieces.dowels if frames else 0
        holes += pieces.lost if frames and not framing else 0.0
    if frames:
        printed.append(Printed(name="key_dome", title="key dome", solid=frames.dome, count=4, note=_DOME))
    return tuple(printed), dowels, holes


def _fit_pieces(solid: Manifold, bed: tuple[float, float, float]) -> Pieces:
    """Pieces of a solid that fit the bed; none for a half with nothing in it."""
    if solid.is_empty():
        return Pieces(solids=(), dowels=0, lost=0.0)
    box = solid.bounding_box()
    return split_solid(solid, *grid(box[:3], box[3:], bed))


def _make_pieces(name: str, title: str, solids: tuple[Manifold, ...], lying: _Lying, note: str) -> list[Printed]:
    if len(solids) == 1:
        return [Printed(name=name, title=title, solid=_on_bed(solids[0], lying), note=note)]
    return [
        Printed(
            name=f"{name}_{number}",
            title=f"{title}, piece {number} of {len(solids)}",
            solid=_on_bed(solid, lying),
            note=note + _JOINED,
            kind=title,
        )
        for number, solid in enumerate(solids, start=1)
    ]


def _on_bed(solid: Manifold, lying: _Lying) -> Manifold:
    """A solid turned, its lowest corner at the origin."""
    turned = solid.rotate(lying)
    low = turned.bounding_box()[:3]
    return turned.translate(tuple(-place for place in low))
