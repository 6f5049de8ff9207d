"""`require_cables`: commands that move cables alone."""

from pathlib import Path
from typing import TYPE_CHECKING

from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.robot import Robot


def require_cables(robot: "Robot", place: Path, what: str) -> None:
    """Reject a robot without cables (InputError: it has none; of one that drives move it states that reason)."""
    if robot.cables:
        return
    if robot.drives:
        raise InputError(
            f'{place}: drives, such as "{robot.drives[0].name}", are not available in {what}, and it has no cables. '
            "Use hydrostat simulate --move."
        )
    raise InputError(f"{place}: no cables. Add winches and cables, or run `hydrostat design`.")
