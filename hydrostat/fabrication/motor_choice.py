"""`find_motor`: the cheapest motor that does for a robot; `MotorOffer`: price of each, and why it does not do."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from hydrostat.fabrication.kit_options import KitOptions, Method
from hydrostat.fabrication.lists.bill import PRICES
from hydrostat.fabrication.lists.motors import SLOW_TRAVEL_TIME, power_plan, travel_time, turns_of
from hydrostat.fabrication.lists.needs import control_needs
from hydrostat.fabrication.moulds.pocket import WinchRoom, clashes, make_pockets
from hydrostat.fabrication.moulds.setting import mold_setting
from hydrostat.fabrication.parts.motor import ALL_MOTORS, AUTO_MOTORS, MARGIN, Motor
from hydrostat.fabrication.parts.winch_unit import unit_problems, unit_rooms
from hydrostat.robot import Mount, Robot, Winch, sewn_robot


@dataclass(frozen=True, kw_only=True)
class MotorOffer:
    """A motor for all winches of a robot, at the largest torques of its poses.

    Attributes:
        motor: the motor.
        price: price of the motors with boards, drivers, supply and their cables, as used up [USD].
        seconds: time of the slowest winch for its full travel [s]; None: it stalls before.
        problem: the first reason why it does not do; empty if it does.
        better: key of another that does and is cheaper, and not slower, weaker or larger; empty if there is none.
    """

    motor: Motor
    price: float
    seconds: float | None
    problem: str = ""
    better: str = ""

    @property
    def remark(self) -> str:
        """Reason why "auto" does not choose it; empty if only its price can be one."""
        if self.problem:
            return self.problem
        words = () if self.motor in AUTO_MOTORS else ("only by --motor",)
        return ", ".join((*words, *((f"no better than {self.better}",) if self.better else ())))

    def beats(self, other: "MotorOffer") -> bool:
        """Return True if it is cheaper than another, and not slower, weaker or larger."""
        mine, theirs = self.motor, other.motor
        return (
            self.price < other.price
            and (self.seconds or math.inf) <= (other.seconds or math.inf)
            and mine.rated_torque >= theirs.rated_torque
            and mine.volume <= theirs.volume
        )


def motor_offers(robot: Robot, torques: Sequence[float], options: KitOptions) -> tuple[MotorOffer, ...]:
    """All motors of the table for a robot and the largest torque of each winch [N m], the cheapest first."""
    found = []
    for motor in _by_price(robot, torques):
        problem = _weakness(robot, torques, motor)
        if not problem:
            problems, is_piled = fit_motor(robot, options, motor)
            problem = "has no room in the body" if problems else "lies above another in the body" if is_piled else ""
        found.append(
            MotorOffer(
                motor=motor,
                price=motors_price(pulled_torques(robot, torques), motor),
                seconds=_seconds(robot, torques, motor),
                problem=problem,
            )
        )
    able = [offer for offer in found if not offer.problem]
    return tuple(_compare_offer(offer, able) for offer in found)


def _compare_offer(offer: MotorOffer, able: Sequence[MotorOffer]) -> MotorOffer:
    better = next((other.motor.key for other in able if other.beats(offer)), "")
    return MotorOffer(**{**vars(offer), "better": "" if offer.problem else better})


def find_motor(robot: Robot, torques: Sequence[float], options: KitOptions) -> Motor:
    """Choose the motor of a kit for the largest torque of each winch [N m] (InputError: an unknown key).

    For "auto" it is that of the robot. For a robot without one it is the cheapest, with its boards and supply, that
    holds the poses for long, is not slow, turns far enough and fits, none above another. If there is none in the body,
    it is the strongest that holds the poses for seconds. Else units may lie above each other. Where none fits it is the
    smallest, and where none is strong enough the strongest.
    """
    if (key := options.motor_for(robot)) != "auto":
        return Motor.choose(key)
    inside = any(winch.mount is Mount.BODY for winch in robot.winches)
    most = max(map(float, torques), default=0.0) - 1e-12
    auto = [motor for motor in _by_price(robot, torques) if motor in AUTO_MOTORS]
    ordered = [motor for motor in auto if _turns_of(robot) <= motor.turns + 1e-9]
    steady = [motor for motor in ordered if motor.largest_torque() >= most]
    quick = [motor for motor in steady if (_seconds(robot, torques, motor) or math.inf) <= SLOW_TRAVEL_TIME]
    by_torque = sorted(ordered, key=lambda motor: -motor.stall_torque)
    brief = [motor for motor in by_torque if inside and motor.largest_torque(inside=True) >= most]
    piled: list[Motor] = []
    for motor in dict.fromkeys((*quick, *steady, *brief)):
        problems, is_piled = fit_motor(robot, options, motor)
        if not problems and not is_piled:
            return motor
        if not problems:
            piled.append(motor)
    smallest = sorted(brief, key=lambda motor: motor.volume)
    return (*piled, *smallest, *steady, *by_torque)[0]


def motors_price(torques: Sequence[float], motor: Motor) -> float:
    """Price of a motor for each torque [N m], with boards, drivers, supply and their cables, as used up [USD]."""
    plan = power_plan({str(number): 1e3 * torque for number, torque in enumerate(torques)}, motor)
    return len(torques) * motor.price + sum(item.cost for item in control_needs(plan))


def drive_price(robot: Robot, torques: Sequence[float], motor: Motor, *, options: KitOptions) -> float:
    """Price of the motors of a network, with boards, drivers and supply, and of its line and tube, as used up [USD].

    Args:
        robot: robot as it is drawn, at least one of whose winches has cables.
        torques: largest torque of each winch [N m].
        motor: motor of each winch.
        options: choices of the kit.
    """
    cables = (sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot).cables
    length = float(sum(cable.length for cable in cables))
    tube = float(sum(cable.segments[~cable.bare].sum() for cable in cables))
    line = PRICES["line"].amount * length + PRICES["tube"].amount * tube
    return line + motors_price(pulled_torques(robot, torques), motor)


def pulled_torques(robot: Robot, torques: Sequence[float]) -> list[float]:
    """Torques of the winches that have cables [N m], 0 where none is known yet: only these get a motor."""
    used = {cable.winch for cable in robot.cables}
    pairs = zip(robot.winches, _in_order(robot, torques), strict=True)
    return [torque for winch, torque in pairs if winch.name in used]


def fit_motor(robot: Robot, options: KitOptions, motor: Motor) -> tuple[tuple[str, ...], bool]:
    """Reasons why the winches of a robot cannot be built in with a motor; and True if units lie above each other."""
    sewn = sewn_robot(robot) if options.method_for(robot.body) is Method.PLUSH else robot
    problems, is_piled = unit_problems(sewn, options.parts, motor)
    return (*find_turn_problems(robot.winches, motor), *problems, *_pocket_problems(robot, options, motor)), is_piled


def _by_price(robot: Robot, torques: Sequence[float]) -> list[Motor]:
    pulled = pulled_torques(robot, torques)
    return sorted(ALL_MOTORS, key=lambda motor: motors_price(pulled, motor))


def _in_order(robot: Robot, torques: Sequence[float]) -> list[float]:
    """Torque of each winch [N m]; 0 where none is known yet."""
    return [float(torque) for torque in torques] if len(torques) else [0.0] * len(robot.winches)


def _turns_of(robot: Robot) -> float:
    """The most turns of a spool of a robot."""
    return max(map(turns_of, robot.winches), default=0.0)


def _weakness(robot: Robot, torques: Sequence[float], motor: Motor) -> str:
    """Reason why a motor is too weak, too slow or does not turn far enough; empty if it is none of these."""
    most, turns = 1e3 * max(map(float, torques), default=0.0), _turns_of(robot)
    if turns > motor.turns + 1e-9:
        return f"turns {360 * motor.turns:.0f} of {360 * turns:.0f} degrees"
    if MARGIN * most > motor.rated_torque + 1e-9:
        return f"holds {motor.rated_torque:.0f} of {MARGIN * most:.0f} N mm for long"
    seconds = _seconds(robot, torques, motor)
    return "is slow" if seconds is None or seconds > SLOW_TRAVEL_TIME else ""


def _seconds(robot: Robot, torques: Sequence[float], motor: Motor) -> float | None:
    """Time of the slowest winch for its full travel [s]; None where one stalls."""
    pairs = zip(robot.winches, _in_order(robot, torques), strict=True)
    times = [travel_time(motor, 1e3 * torque, winch.travel, winch.spool_radius) for winch, torque in pairs]
    return None if None in times else max((each for each in times if each is not None), default=0.0)


def find_turn_problems(winches: Sequence[Winch], motor: Motor) -> tuple[str, ...]:
    """A line for each winch that asks for more turns than a motor has."""
    return tuple(
        f'winch "{winch.name}" needs {360 * turns_of(winch):.0f} degrees for its travel, {motor.key} turns by '
        f"{360 * motor.turns:.0f}. Choose another motor, or a spool radius of at least "
        f"{math.ceil(1e4 * (winch.travel + winch.release) / (2 * math.pi * motor.turns)) / 10:.1f} mm, which takes "
        f"{turns_of(winch) / motor.turns:.1f} times the torque"
        for winch in winches
        if turns_of(winch) > motor.turns + 1e-9
    )


def _pocket_problems(robot: Robot, options: KitOptions, motor: Motor) -> tuple[str, ...]:
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
