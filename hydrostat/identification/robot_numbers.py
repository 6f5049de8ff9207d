"""`robot_numbers`: numbers of a robot that a pose depends on, by their names in `Sensitivity`."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import Sensitivity


def robot_numbers(robot: Robot, gravity: tuple[float, ...] | None) -> dict[str, Vector]:
    """Numbers of a robot whose slopes `Sensitivity` knows, each as a flat vector in SI units.

    Hung masses count by their weight under `gravity` [m/s^2], as the slope by gravity has them already.
    """
    body = robot.body
    materials = [part.material for part in body.parts]
    dim = body.mesh.dim
    return {
        "slack": np.array([cable.slack for cable in robot.cables]),
        "routes": np.array([number for cable in robot.cables for point in cable.points for number in point]),
        "cable_stiffness": np.array([cable.stiffness for cable in robot.cables]),
        "friction": np.array([cable.friction for cable in robot.cables]),
        "pin_stiffness": np.array([pin.stiffness for pin in robot.pins]),
        "young": np.array([body.material.young]),
        "poisson": np.array([body.material.poisson]),
        "density": np.array([body.material.density]),
        "part_young": np.array([0.0 if material is None else material.young for material in materials]),
        "part_poisson": np.array([0.0 if material is None else material.poisson for material in materials]),
        "part_density": np.array(
            [(part.density or 0.0) if part.material is None else part.material.density for part in body.parts]
        ),
        "thickness": np.array([body.thickness or 0.0]),
        "loads": np.array([load.force_under(gravity, dim) for load in robot.loads]).ravel(),
        "moments": np.array([float(np.linalg.norm(load.moment or ())) for load in robot.loads]),
        "gravity": np.zeros(dim) if robot.gravity is None else np.array(robot.gravity),
        "rod_axial": np.array([rod.stiffnesses[0] for rod in robot.rods]),
        "rod_bending": np.array([rod.stiffnesses[1] for rod in robot.rods]),
    }


def flat_slopes(slopes: Sensitivity) -> dict[str, Vector]:
    """Slopes by `robot_numbers`, by the same names and as flat."""
    found = {}
    for name in SLOPES:
        value = getattr(slopes, name)
        if name == "routes":
            found[name] = np.concatenate([np.ravel(part) for part in value]) if value else np.zeros(0)
        else:
            found[name] = np.atleast_1d(np.ravel(0.0 if value is None else value)).astype(float)
    return found


SLOPES = (
    "slack",
    "routes",
    "cable_stiffness",
    "friction",
    "pin_stiffness",
    "young",
    "poisson",
    "density",
    "part_young",
    "part_poisson",
    "part_density",
    "thickness",
    "loads",
    "moments",
    "gravity",
    "rod_axial",
    "rod_bending",
)
