"""`find_refusals`: problems that reject a kit and are known before anything is made."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.fabrication.body_work import channel_problems, stuffing_problems
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.line import check_line, line_for
from hydrostat.fabrication.parts.motor import choose_motor
from hydrostat.fabrication.parts.winch_unit import unit_problems
from hydrostat.fabrication.patterns.pattern import pattern_problems
from hydrostat.robot import Mount, Robot, sewn_robot


def find_refusals(robot: Robot, demand: Demand | None = None, *, options: KitOptions | None = None) -> tuple[str, ...]:
    """Return the problems for which `build_kit` rejects a robot.

    They cover units that do not fit, holes that cannot be cut, sheaths too near the skin, and lines that break.
    Without a demand the motor is the weakest of the table and no line breaks: these problems then hold for all
    poses. The demand is that of the robot as it is drawn, or as its cables are sewn in pairs. `find_sewing` judges
    the skin of bodies in space. Moulds, pieces too large for the printer and the checks of finished files are judged
    only as the kit is made. Raises InputError: an unknown motor, a demand of another robot.
    """
    options = options or KitOptions()
    sewn = sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot
    inside = any(winch.mount is Mount.BODY for winch in robot.winches)
    torques = () if demand is None else demand.torques
    motor = choose_motor(options.motor, torques, inside=inside, winches=len(robot.winches))
    found = [*unit_problems(sewn, options.parts, motor), *_of_body(robot, options)]
    if demand is not None:
        found += check_line(sewn, _share_tensions(demand.tensions, sewn), line_for(options.parts.cable)).problems
    return tuple(found)


def _share_tensions(tensions: Vector, sewn: Robot) -> Vector:
    """Tensions of all cables that are sewn [N]: those of a drawn one are shared evenly by its pair."""
    times = max(len(sewn.cables) // max(len(tensions), 1), 1)
    return np.tile(tensions / times, times)


def _of_body(robot: Robot, options: KitOptions) -> tuple[str, ...]:
    if options.method_for(robot.body) is Method.FOAM:
        return channel_problems(robot, options.parts)
    if robot.body.mesh.dim == 3:
        return stuffing_problems(robot)
    try:
        return (*pattern_problems(robot, options.pattern), *stuffing_problems(robot))
    except InputError as error:  # a body in several pieces
        return (str(error),)
