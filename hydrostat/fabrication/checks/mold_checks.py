"""Checks whether a mold leaves room for just the body that was simulated."""

import math

from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import MoldKind
from hydrostat.fabrication.moulds.mould import Mold
from hydrostat.robot import Robot

MESH = 0.05  # share of its volume by which the body that is cast may differ from the mesh that was simulated
_VOIDS = ("sprue", "vents", "bolts", "slots", "keys")  # openings in a printed block: neither plastic nor body

_POURS = ("silicone_lower", "silicone_upper")


def mold_checks(robot: Robot, mould: Mold) -> tuple[Check, ...]:
    """The account of the block, the way that the foam takes, and the body against the simulated mesh."""
    return (_account(mould), _check_connected(mould), _as_simulated(robot, mould))


def _account(mould: Mold) -> Check:
    """Pieces as they are printed, and all that is no piece, each measured on its own solid, against the block."""
    volumes = mould.volumes
    if mould.kind is MoldKind.PRINTED:
        what = "pieces, cavity, sprue, vents, key gaps and holes of the mold add up to its block"
        parts = _pieces(mould, "mould") + _body(mould) + sum(volumes[void] for void in _VOIDS)
    else:
        what = "pieces of the positive and silicone of both pours add up to the room in the frames"
        parts = _pieces(mould, "positive") + sum(volumes[pour] for pour in _POURS)
    lost = abs((parts + volumes["cutting"]) / math.prod(mould.box) - 1)
    left_over = 1e-6  # share of the block whose whereabouts may be unknown: what booleans round
    rounding = 1e-9  # less than this share is the rounding of sums
    return Check(
        what=what,
        measured=f"{lost:.0e} of it left over" if lost > rounding else "nothing left over",
        allowed=f"{left_over:.0e}",
        passed=lost <= left_over,
    )


def _pieces(mould: Mold, name: str) -> float:
    """Volume of all that is printed under a name [mm^3]."""
    return sum(part.count * part.volume for part in mould.printed if part.name.startswith(name))


def _body(mould: Mold) -> float:
    """Volume of the body as it lies in the assembly [mm^3]."""
    return sum(float(piece.solid.volume()) for piece in mould.assembly.pieces if piece.name == "body")


def _check_connected(mould: Mold) -> Check:
    """Check that sprue, cavity and vents form one connected volume."""
    rooms = sum(room.volume() > 0 for room in mould.poured.decompose())
    sprue = mould.volumes["sprue"]
    measured = "no sprue" if sprue <= 0 else "one room" if rooms == 1 else f"{rooms} rooms"
    return Check(
        what="sprue, cavity and vents of the mold are one room, which the foam fills",
        measured=f"{measured}, {1e-3 * float(mould.poured.volume()):.0f} cm^3",
        allowed="one room with a sprue",
        passed=rooms == 1 and sprue > 0,
    )


def _as_simulated(robot: Robot, mould: Mold) -> Check:
    mesh, volume = robot.body.mesh, mould.volumes["body"]
    simulated = 1e9 * float(mesh.volumes.sum()) * (robot.body.thickness or 1.0)
    off = volume / simulated - 1
    return Check(
        what="the body that is cast is as large as the one that was simulated",
        measured=f"{1e-3 * volume:.0f} cm^3, {abs(100 * off):.1f} % {'more' if off > 0 else 'less'}",
        allowed=f"{100 * MESH:g} %",
        passed=abs(off) <= MESH,
    )
