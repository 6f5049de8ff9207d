"""`restore_drives`: a network of a robot whose drives stayed at rest while its cables were designed."""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from hydrostat.design.network import Alternative, Network
from hydrostat.robot import Robot

_One = TypeVar("_One", Network, Alternative)


def restore_drives(found: Network, robot: Robot) -> Network:
    """Return a network and its alternatives with the drives, at rest, of the robot that it was designed for."""
    if not robot.drives:
        return found
    others = tuple(_restore(one, robot) for one in found.alternatives)
    return replace(_restore(found, robot), alternatives=others)


def _restore(one: _One, robot: Robot) -> _One:
    driven = replace(one.robot, pins=robot.pins, loads=robot.loads, drives=robot.drives)
    still = {"robot": driven, "drives": np.zeros(len(robot.drives))}
    results = tuple(replace(each, pose=replace(each.pose, **still)) for each in one.ik_results)
    return replace(one, robot=driven, ik_results=results)
