"""`find_weak_lines`: lines of a kit that break at a pose; apart from kits, as every pose asks for it."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.line import check_line, line_for
from hydrostat.robot import Robot, sewn_robot


def find_weak_lines(robot: Robot, tensions: Vector) -> tuple[str, ...]:
    """Return a line for each cable whose line breaks at such tensions [N], for the line of a kit."""
    options = KitOptions()
    sewn = sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot
    problems = check_line(sewn, share_tensions(tensions, sewn), line_for(options.parts.cable)).problems
    return problems[: len(tensions)]


def share_tensions(tensions: Vector, sewn: Robot) -> Vector:
    """Tensions of all cables that are sewn [N]: those of a drawn one are shared evenly by its pair."""
    times = max(len(sewn.cables) // max(len(tensions), 1), 1)
    return np.tile(tensions / times, times)
