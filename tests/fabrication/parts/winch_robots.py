"""Robots and demands for tests of winches."""

from dataclasses import replace

from hydrostat.robot import Robot


def with_winches(robot: Robot, **changed: float) -> Robot:
    """The same robot with changed winches."""
    return replace(robot, winches=tuple(replace(winch, **changed) for winch in robot.winches))
