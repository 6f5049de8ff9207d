"""`tell_zero_loss`: winches whose Feetech servos lose their zeros without power, for what commands print."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.robot import Robot

SERVO_BOARD = "esp32s3"
"""Board that drives Feetech servos."""


def tell_zero_loss(robot: "Robot", key: str, taken: Sequence[float] = ()) -> str:
    """Why Feetech servos on a board lose their zeros without power, in one line; empty for other motors.

    Args:
        robot: robot with the winches.
        key: key of the motor.
        taken: the most that poses take in with each winch [m]; empty: not known.
    """
    from hydrostat.control import Calibration, find_zero_loss
    from hydrostat.fabrication import Motor

    if key == "auto" or not robot.winches or not Motor.choose(key).is_feetech:
        return ""
    lost = find_zero_loss(robot, Calibration.usual(robot).motors, Motor.choose(key).bus, taken)
    return lost and f"on an {SERVO_BOARD} servos lose their zeros without power: {lost}"
