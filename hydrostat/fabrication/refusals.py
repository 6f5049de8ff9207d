"""`find_refusals`, `find_material_problems`: problems that reject a kit and are known before anything is made."""

from hydrostat.errors import InputError
from hydrostat.fabrication.body_work import channel_problems, stuffing_problems
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.inserts import rod_problems
from hydrostat.fabrication.kit_options import KitOptions, Method, MoldKind
from hydrostat.fabrication.lists.line import check_line, line_for
from hydrostat.fabrication.motor_choice import find_motor, fit_motor
from hydrostat.fabrication.moulds.casting import casting_problems
from hydrostat.fabrication.patterns.pattern import pattern_problems
from hydrostat.fabrication.print_work import print_problems
from hydrostat.fabrication.weak_lines import share_tensions
from hydrostat.robot import Robot, sewn_robot


def find_material_problems(robot: Robot, *, options: KitOptions | None = None) -> tuple[str, ...]:
    """Return the problems of a body's material, which no network changes: robot.toml states all that they need.

    `find_refusals` leaves those of casting out, so that designs of such a body rank their networks by the others.
    """
    options = options or KitOptions()
    method, material = options.method_for(robot.body), robot.body.material
    if method is Method.FOAM:
        return casting_problems(material, silicone=options.mould.kind is MoldKind.SILICONE)
    return stuffing_problems(robot) if method is Method.PLUSH else ()


def find_refusals(robot: Robot, demand: Demand | None = None, *, options: KitOptions | None = None) -> tuple[str, ...]:
    """Return the problems for which `build_kit` rejects a robot.

    They cover units and pockets that do not fit, holes that cannot be cut, sheaths too near the skin, and lines that
    break. Without a demand the motor is the cheapest that fits and no line breaks: these problems then hold for all
    poses. The demand is that of the robot as it is drawn, or as its cables are sewn in pairs. `Sewing.find` judges the
    skin of bodies in space. Molds, pieces too large for the printer and the checks of finished files are judged only
    as the kit is made. Raises InputError: an unknown motor, a demand of another robot.
    """
    options = options or KitOptions()
    sewn = sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot
    motor = find_motor(robot, () if demand is None else demand.torques.tolist(), options)
    found = [*fit_motor(robot, options, motor)[0], *_of_body(robot, options), *rod_problems(robot)]
    if demand is not None:
        found += check_line(sewn, share_tensions(demand.tensions, sewn), line_for(options.parts.cable)).problems
    return tuple(found)


def _of_body(robot: Robot, options: KitOptions) -> tuple[str, ...]:
    method = options.method_for(robot.body)
    if method is Method.PRINT:
        return print_problems(robot, options.parts)
    if method is Method.FOAM:
        return channel_problems(robot, options.parts)
    if robot.body.mesh.dim == 3:
        return stuffing_problems(robot)
    try:
        return (*pattern_problems(robot, options.pattern), *stuffing_problems(robot))
    except InputError as error:  # a body in several pieces
        return (str(error),)
