"""`simplify_robot`, `restore_drives`: a robot as a search of cables takes it, and the network with its drives back."""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from hydrostat.design.network import Alternative, Network
from hydrostat.robot import Robot, fit_winch_bodies, with_fixed_drives

_One = TypeVar("_One", Network, Alternative)


def simplify_robot(robot: Robot) -> Robot:
    """Return the robot with its drives at rest and without the units of winches in its body."""
    still = with_fixed_drives(robot)
    return fit_winch_bodies(replace(still, winches=tuple(replace(winch, body=False) for winch in still.winches)))


def restore_drives(found: _One, robot: Robot) -> _One:
    """Return a network and its alternatives with the drives, at rest, of the robot that it was designed for."""
    if not robot.drives:
        return found
    restored = _restore(found, robot)
    if isinstance(restored, Network):
        others = tuple(_restore(one, robot) for one in restored.alternatives)
        return replace(restored, alternatives=others)
    return restored


def _restore(one: _One, robot: Robot) -> _One:
    driven = replace(one.robot, pins=robot.pins, loads=robot.loads, drives=robot.drives)
    still = {"robot": driven, "drives": np.zeros(len(robot.drives))}
    results = tuple(replace(each, pose=replace(each.pose, **still)) for each in one.ik_results)
    return replace(one, robot=driven, ik_results=results)
