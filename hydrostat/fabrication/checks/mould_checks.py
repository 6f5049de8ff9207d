"""Whether a mould leaves room for just the body that was simulated."""

from hydrostat.fabrication.moulds.mould import Mould
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Robot

LEFT_OVER = 1e-6
"""Share of the block whose whereabouts may be unknown: what booleans round."""

_ROUNDING = 1e-9
"""Less than this share is the rounding of sums."""

MESH = 0.05
"""Share of its volume by which the body that is cast may differ from the mesh that was simulated."""

_PARTS = ("upper", "lower", "cavity", "sprue", "vents", "bolts", "slots", "keys")
"""What a block becomes."""


def mould_checks(robot: Robot, mould: Mould) -> tuple[Check, ...]:
    """The account of the block, and the volume of the body against that of the simulated mesh."""
    volumes, mesh = mould.volumes, robot.body.mesh
    lost = abs(sum(volumes[part] for part in _PARTS) / volumes["box"] - 1)
    simulated = 1e9 * float(mesh.volumes.sum()) * (robot.body.thickness or 1.0)
    off = volumes["body"] / simulated - 1
    return (
        Check(
            what="halves, cavity, sprue, vents, keys and holes of the mould add up to its block",
            measured=f"{lost:.0e} of it left over" if lost > _ROUNDING else "nothing left over",
            allowed=f"{LEFT_OVER:.0e}",
            passed=lost <= LEFT_OVER,
        ),
        Check(
            what="the body that is cast is as large as the one that was simulated",
            measured=f"{1e-3 * volumes['body']:.0f} cm^3, {abs(100 * off):.1f} % {'more' if off > 0 else 'less'}",
            allowed=f"{100 * MESH:g} %",
            passed=abs(off) <= MESH,
        ),
    )
