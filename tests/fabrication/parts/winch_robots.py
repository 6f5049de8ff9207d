"""Robots and demands for tests of winches."""

from dataclasses import replace

import numpy as np

from hydrostat.fabrication.demand import Demand
from hydrostat.robot import Robot


def given_demand(robot: Robot, torque: float = 0.03) -> Demand:
    """The same torque [N m] on each winch, without solving anything."""
    return Demand(
        poses=(),
        tensions=np.full(len(robot.cables), 5.0),
        torques=np.full(len(robot.winches), torque),
        taken=np.zeros((len(robot.winches), 2)),
    )


def with_winches(robot: Robot, **changed: float) -> Robot:
    """The same robot with changed winches."""
    return replace(robot, winches=tuple(replace(winch, **changed) for winch in robot.winches))
