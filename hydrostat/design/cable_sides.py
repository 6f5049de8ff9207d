"""`assign_cable_sides`: a robot that says where the cables of a new network run."""

from dataclasses import replace

from hydrostat.fabrication import STUFFINGS
from hydrostat.robot import CableSide, Robot


def assign_cable_sides(robot: Robot) -> Robot:
    """The robot itself; if it is flat and does not say where its cables run, with what a builder would want.

    That is in pairs: on one face alone they would curl a stuffed body out of its plane by centimeters (decision 0029).
    A flat body of foam is cast, with its cables in the middle.
    """
    if robot.body.mesh.dim != 2 or robot.face is not None:
        return robot
    material = robot.body.material.name
    return replace(robot, face=CableSide.PAIRS if not material or material in STUFFINGS else CableSide.MIDDLE)
