"""`motor_facts`: what a page must know to drive the motors of a robot."""

from typing import Any

from hydrostat.control import Calibration, LinkLimits, robot_word
from hydrostat.fabrication import winch_marks_of
from hydrostat.robot import Robot


def motor_facts(robot: Robot, calibration: Calibration | None) -> dict[str, Any] | None:
    """Return facts for the page in SI units; None without motors on exactly one board with our firmware."""
    if calibration is None or calibration.boards != 1 or any(motor.counts is None for motor in calibration.motors):
        return None
    marks = winch_marks_of(robot)
    return {
        "robot": robot_word(robot, calibration),
        "speed": LinkLimits().speed,
        "motors": [
            {
                "mark": marks[winch.name],
                "number": motor.number,
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
