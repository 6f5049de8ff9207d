"""`make_halves`: two halves of a block round a cavity, with an exact account of where its volume goes."""

from dataclasses import dataclass

from manifold3d import Manifold

from hydrostat.fabrication.moulds.closing import Block, Closing
from hydrostat.fabrication.moulds.openings import Sprue, Vent
from hydrostat.fabrication.moulds.pocket import Pocket
from hydrostat.fabrication.moulds.simple_solids import joined

_FAR = 1e4


@dataclass(frozen=True, eq=False, kw_only=True)
class Halves:
    """A mould, closed, in its own coordinates.

    Attributes:
        upper: half that is drawn along the pull.
        lower: half that stays.
        cavity: the body less pockets and dents: what the foam becomes.
        poured: all that is filled with foam: the cavity with sprue and vents, as far as they are in the block.
        volumes: of each thing [mm^3], see `Mould.volumes`; each is measured on its own solid, none is what is left.
    """

    upper: Manifold
    lower: Manifold
    cavity: Manifold
    poured: Manifold
    volumes: dict[str, float]


def make_cavity(body: Manifold, dents: Manifold, pockets: tuple[Pocket, ...]) -> Manifold:
    """The body without what the mould reaches into it."""
    cavity = body - dents
    for pocket in pockets:
        cavity = cavity - pocket.core
    return cavity


def make_halves(
    block: Block,
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
        "vents": joined(vent.solid for vent in vents),
        "bolts": closing.holes,
        "slots": closing.slots,
    }
    solid = block.solid - cavity
    for opening in openings.values():
        solid = solid - opening
    above = _upper_side(pockets)
    upper, lower = (solid ^ above) - closing.sockets, (solid - above) + closing.bumps
    account = {"box": volume(block.solid), "body": volume(body)}
    account["dents"], account["pockets"] = _inside(body, dents, pockets)
    account["cavity"] = volume(cavity)
    account |= _voids(block, cavity, openings, closing)
    account |= {"upper": volume(upper), "lower": volume(lower)}
    poured = cavity + ((openings["sprue"] + openings["vents"]) ^ block.solid)
    return Halves(upper=upper, lower=lower, cavity=cavity, poured=poured, volumes=account)


def _voids(block: Block, cavity: Manifold, openings: dict[str, Manifold], closing: Closing) -> dict[str, float]:
    """What each opening takes of the plastic [mm^3], where two meet the first of them; and the gaps round the keys."""
    account, taken = {}, cavity
    for name, opening in openings.items():
        inside = opening ^ block.solid
        account[name] = volume(inside - taken)
        taken = taken + inside
    keys = closing.bumps.trim_by_plane((0.0, 0.0, 1.0), 0.0)
    sockets = closing.sockets.trim_by_plane((0.0, 0.0, 1.0), 0.0)
    return account | {"keys": volume((sockets ^ block.solid) - taken) - volume(keys)}


def volume(solid: Manifold) -> float:
    """Of a solid [mm^3]."""
    return float(solid.volume())


def _inside(body: Manifold, dents: Manifold, pockets: tuple[Pocket, ...]) -> tuple[float, float]:
    """What dents take of the body [mm^3], and what pockets take of the rest."""
    cores = joined(pocket.core for pocket in pockets)
    return volume(body ^ dents), volume(cores ^ body) - volume(cores ^ body ^ dents)


def _upper_side(pockets: tuple[Pocket, ...]) -> Manifold:
    """All that belongs to the upper half: what is above the parting plane, less cores of the lower half, and so on."""
    side = Manifold.cube((2 * _FAR, 2 * _FAR, _FAR)).translate((-_FAR, -_FAR, 0.0))
    for pocket in pockets:
        side = side + pocket.reach if pocket.upper else side - pocket.reach
    return side
