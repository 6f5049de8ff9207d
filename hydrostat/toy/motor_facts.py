"""`motor_facts`: what a page must know to drive the motors of a robot."""

from typing import Any

from hydrostat.control import Calibration, LinkLimits, robot_word, servo_ratings
from hydrostat.fabrication import winch_marks_of
from hydrostat.robot import Robot


def motor_facts(robot: Robot, calibration: Calibration | None) -> dict[str, Any] | None:
    """Return facts for the page in SI units; None without motors on exactly one board or adapter.

    Motors with encoder counts are on a board with our firmware, others are servos. A zero only tells the page whether
    taut cables are where they were when the robot was calibrated.
    """
    if calibration is None or calibration.boards != 1:
        return None
    counted = [motor.counts is not None for motor in calibration.motors]
    if any(counted) and not all(counted):
        return None
    marks = winch_marks_of(robot)
    if all(counted):
        kind: dict[str, Any] = {"kind": "firmware", "robot": robot_word(robot, calibration)}
    else:
        kind = {"kind": "servos", **servo_ratings()}
    return {
        **kind,
        "speed": LinkLimits().speed,
        "motors": [
            {
                "mark": marks[winch.name],
                "number": motor.number,
                "zero": motor.zero,
                "turns": motor.turns,
                "radius": motor.radius,
                "curve": [list(point) for point in motor.curve],
                "current": motor.current,
                "counts": motor.counts,
                "low": -winch.release,
                "high": winch.travel,
            }
            for winch, motor in zip(robot.winches, calibration.motors, strict=True)
        ],
    }
