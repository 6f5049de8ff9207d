"""`find_refusals`: problems that reject a kit and are known before anything is made."""

from collections.abc import Iterable

from hydrostat.errors import InputError
from hydrostat.fabrication.body_work import channel_problems, stuffing_problems
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.inserts import rod_problems
from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.line import check_line, line_for
from hydrostat.fabrication.moulds.pocket import WinchRoom, clashes, make_pockets
from hydrostat.fabrication.moulds.setting import mold_setting
from hydrostat.fabrication.parts.motor import MOTORS, Motor
from hydrostat.fabrication.parts.winch_unit import unit_problems, unit_rooms
from hydrostat.fabrication.patterns.pattern import pattern_problems
from hydrostat.fabrication.print_work import print_problems
from hydrostat.fabrication.weak_lines import share_tensions
from hydrostat.robot import Mount, Robot, sewn_robot


def find_refusals(robot: Robot, demand: Demand | None = None, *, options: KitOptions | None = None) -> tuple[str, ...]:
    """Return the problems for which `build_kit` rejects a robot.

    They cover units and pockets that do not fit, holes that cannot be cut, sheaths too near the skin, and lines that
    break. Without a demand the motor is the weakest that fits and no line breaks: these problems then hold for all
    poses. The demand is that of the robot as it is drawn, or as its cables are sewn in pairs. `Sewing.find` judges the
    skin of bodies in space. Moulds, pieces too large for the printer and the checks of finished files are judged only
    as the kit is made. Raises InputError: an unknown motor, a demand of another robot.
    """
    options = options or KitOptions()
    sewn = sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot
    motor = find_motor(robot, () if demand is None else demand.torques, options)
    found = [*_fit(robot, options, motor)[0], *_of_body(robot, options), *rod_problems(robot)]
    if demand is not None:
        found += check_line(sewn, share_tensions(demand.tensions, sewn), line_for(options.parts.cable)).problems
    return tuple(found)


def find_motor(robot: Robot, torques: Iterable[float], options: KitOptions) -> Motor:
    """Choose the motor of a kit for the torques of its poses [N m] (InputError: an unknown key).

    For "auto" it is that of the robot. For a robot without one it is the weakest that holds the poses for long and
    whose units fit into the body, none above another. If there is none, it is the strongest that does so for seconds.
    Else units may lie above each other. If no motor fits, the choice is that of `choose_motor`.
    """
    inside = any(winch.mount is Mount.BODY for winch in robot.winches)
    needed = [float(torque) for torque in torques]
    key = options.motor_for(robot)
    chosen = Motor.choose(key, needed, inside=inside, winches=len(robot.winches))
    if key != "auto" or not inside:
        return chosen
    most = max(needed, default=0.0) - 1e-12
    steady = [motor for motor in MOTORS if motor.largest_torque() >= most]
    brief = [motor for motor in reversed(MOTORS) if motor.largest_torque(inside=True) >= most and motor not in steady]
    piled = []
    for motor in (*steady, *brief):
        problems, is_piled = _fit(robot, options, motor)
        if not problems and not is_piled:
            return motor
        if not problems:
            piled.append(motor)
    return piled[0] if piled else chosen


def _fit(robot: Robot, options: KitOptions, motor: Motor) -> tuple[tuple[str, ...], bool]:
    """Reasons why the winches of a robot cannot be built in with a motor; and True if units lie above each other."""
    sewn = sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot
    problems, is_piled = unit_problems(sewn, options.parts, motor)
    return (*problems, *pocket_problems(robot, options, motor)), is_piled


def pocket_problems(robot: Robot, options: KitOptions, motor: Motor) -> tuple[str, ...]:
    """Return a line for each winch in a body of foam whose pocket does not fit, or overlaps another."""
    if options.method_for(robot.body) is not Method.FOAM:
        return ()
    rooms = unit_rooms(robot, options.parts, motor)
    if not rooms:
        return ()
    setting = mold_setting(robot)
    pockets = make_pockets(
        robot,
        setting.stance.enter(setting.solid),
        setting.stance,
        {name: WinchRoom(low=room.low, high=room.high) for name, room in rooms.items()},
        clearance=options.mould.pocket_clearance,
    )
    return (*(pocket.problem for pocket in pockets if pocket.problem), *clashes(pockets))


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
