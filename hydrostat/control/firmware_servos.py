"""Settings of firmware for Feetech servos: registers and rules of our drivers, as constants of C."""

from collections.abc import Iterable, Mapping, Sequence
from math import ceil, floor, pi

from hydrostat.control import feetech_bus, scs_bus
from hydrostat.control.bus_link import (
    MAX_LEAD_TIME,
    MAX_READING_AGE,
    MAX_TEMPERATURE,
    STALL_DISTANCE,
    STALL_TIME,
)
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.dynamixel_packets import ALL, READ, SYNC_WRITE, WRITE
from hydrostat.control.feetech_bus import FAULTS, FeetechBus
from hydrostat.control.scs_bus import ScsBus
from hydrostat.control.servo_bus import TURNED
from hydrostat.robot import Robot
from hydrostat.units import list_words

SERVO_STEPS = {bus.kind: 2 * pi / bus.tick for bus in (FeetechBus, ScsBus)}
"""Steps per turn of a servo, by kind of bus."""

GUIDED_SPARE, ALONE_SPARE = 0.045, 0.002
"""Cable length beyond travel and release that a board allows to a computer, which searches slack within 40 mm; and to
moves whose zeros must hold after the power was off [m]."""


def servo_settings(robot: Robot, motors: list[WinchMotor], bus: str) -> str:
    """Constants for servos of one kind of bus, on the motors of a board in their order.

    Zeros are stored if servos find them again after their power was off: those that turn less than a turn, and those
    whose winch does, by the turn (`TURN`) that it must be.
    """
    scales = [SERVO_STEPS[bus] / (2 * pi * motor.radius) for motor in motors]
    lasting = not find_zero_loss(robot, motors, bus)
    known = Calibration(tuple(motors)).is_complete
    alone = ALONE_SPARE if lasting and known and bus != ScsBus.kind else GUIDED_SPARE
    constants = _list_constants(bus) | {
        "MILLIMETERS": _join_braced(f"{1e-3 * scale:.4f}f" for scale in scales),
        "GUIDED_SPARE": _as_float(1e3 * GUIDED_SPARE),
        "ALONE_SPARE": _as_float(1e3 * alone),
    }
    if lasting and known:
        steps = [round((motor.zero or 0.0) * SERVO_STEPS[bus] / (2 * pi)) for motor in motors]
        if bus == FeetechBus.kind:
            constants["TURN"] = round(SERVO_STEPS[bus])
        constants["ZEROS"] = _join_braced(map(str, steps))
    lines = "".join(f"#define {name} {value}\n" for name, value in constants.items())
    return f"/* registers and rules of the servos, from hydrostat/control/{bus}_bus.py */\n{lines}"


def find_zero_loss(robot: Robot, motors: Sequence[WinchMotor], bus: str, taken: Sequence[float] = ()) -> str:
    """Return the reason why servos lose their zeros without power, with the fix; empty if they keep them.

    Args:
        robot: robot with the winches.
        motors: motor of each winch.
        bus: kind of the servos.
        taken: largest contraction of each winch over the poses, in winch order [m]; empty if unknown.
    """
    ranges = {winch.name: winch.travel + winch.release for winch in robot.winches}
    lost = [motor for motor in motors if ranges[motor.winch] + 2 * ALONE_SPARE >= 2 * pi * motor.radius]
    if bus == ScsBus.kind or not lost:
        return ""
    needed = {winch.name: winch.release + most for winch, most in zip(robot.winches, taken, strict=False)}
    turns = max(ranges[each.winch] / (2 * pi * each.radius) for each in lost)
    much = f"{'turns' if len(lost) == 1 else 'turn up to'} {turns:.2f} times"
    return (
        f"{list_words(motor.winch for motor in lost)} {much}. Zeros last for less than one turn, with "
        f"{1e3 * ALONE_SPARE:g} mm to spare at each end. {_zero_remedies(lost, ranges, needed)}"
    )


def _zero_remedies(lost: Sequence[WinchMotor], ranges: Mapping[str, float], needed: Mapping[str, float]) -> str:
    """Remedies for winches that turn too far, one for those of the same spool.

    Args:
        lost: motors of these winches.
        ranges: travel and release in all, by winch [m].
        needed: release and largest contraction over the poses in all, by winch [m]; empty if unknown.
    """
    groups: dict[float, list[str]] = {}
    for motor in lost:
        groups.setdefault(motor.radius, []).append(motor.winch)
    remedies = []
    for radius, names in groups.items():
        most = max(ranges[name] for name in names) + 2 * ALONE_SPARE
        spool = f"a spool radius of at least {ceil(1e4 * most / (2 * pi) + 1e-9) / 10:.1f} mm"
        whose = f" for {list_words(names)}" if len(groups) > 1 else ""
        use = max(needed.get(name, 0.0) for name in names)
        used = f" (poses and release use {1e3 * use:.3g} mm)" if needed else ""
        total = f"{1e3 * _lasting_range(radius):.0f} mm"
        remedy = f"Write travel and release of {total} in all into robot.toml{whose}{used}, or use {spool}"
        remedies.append(remedy if use < _lasting_range(radius) else f"Use {spool}{whose}")
    return ". ".join(remedies)


def _lasting_range(radius: float) -> float:
    """Travel and release in all that keep the zero of a servo on a spool [m], in whole millimeters."""
    return 1e-3 * floor(1e3 * (2 * pi * radius - 2 * ALONE_SPARE) - 1e-9)


def _list_constants(bus: str) -> dict[str, object]:
    """Constants of one series by their names in `feetech.h`; supplies are in 0.1 V, 255 for no bound."""
    bits = {word: bit for bit, word in FAULTS.items()}
    common = {
        "FEETECH": 1,
        "ALL_SERVOS": ALL,
        "TO_READ": READ,
        "TO_WRITE": WRITE,
        "TO_SYNC_WRITE": SYNC_WRITE,
        "VOLTS_AT": feetech_bus.VOLTS,
        "TORQUE_AT": feetech_bus.TORQUE,
        "FULL_TORQUE": feetech_bus.FULL_TORQUE,
        "FAULT_SUPPLY": bits["supply voltage out of range"],
        "FAULT_ENCODER": bits["encoder fault"],
        "FAULT_HEAT": bits["too hot"],
        "MAX_HEAT": round(MAX_TEMPERATURE),
        "HEARD_MS": round(1e3 * MAX_READING_AGE),
        "LEAD_MS": round(1e3 * MAX_LEAD_TIME),
        "STALL_MS": round(1e3 * STALL_TIME),
        "STALL_MM": _as_float(1e3 * STALL_DISTANCE),
        "JUMP": ceil(TURNED * SERVO_STEPS[bus] / (2 * pi)),
    }
    return common | (_list_sts() if bus == FeetechBus.kind else _list_scs())


def _list_sts() -> dict[str, object]:
    bus = feetech_bus
    return {
        "BIG_WORDS": 0,
        "MODELS": _join_braced(map(str, bus.MODELS)),
        "MODEL_AT": bus.MODEL,
        "LOW_AT": bus.LOW,
        "MODE_AT": bus.MODE,
        "HEAD_BYTES": bus.MODE + 1,
        "GOAL_AT": bus.RISE,
        "GOAL_BYTES": 7,
        "BOUND_AT": bus.BOUND,
        "LOCK_AT": 0,
        "STATE_AT": bus.STATE,
        "READ_AT": bus.TORQUE,
        "READ_BYTES": bus.STATE + bus.STATE_BYTES - bus.TORQUE,
        "CURRENT_AT": 13,
        "CURRENT_SIGN": 15,
        "MILLIAMPERES": _as_float(1e3 * bus.AMPERE),
        "STALL_MA": round(1e3 * bus.STALL),
        "ENDLESS": 1,
        "MAX_POSITION": bus.MAX_POSITION,
        "MAX_RATE": 32767,
        "SMALL_LIMIT": round(10 * bus.SMALL_LIMIT),
        "SMALL_MOST": round(10 * bus.LITHIUM),
        "LARGE_MOST": round(10 * bus.MAX_VOLTAGE_12V),
        "LARGE_LEAST": round(10 * bus.LARGE_LEAST),
    }


def _list_scs() -> dict[str, object]:
    bus = scs_bus
    return {
        "BIG_WORDS": 1,
        "MODELS": _join_braced([str(bus.NUMBER)]),
        "MODEL_AT": bus.MODEL,
        "LOW_AT": bus.LOW,
        "MODE_AT": 0,
        "HEAD_BYTES": feetech_bus.VOLTS + 2,
        "GOAL_AT": feetech_bus.GOAL,
        "GOAL_BYTES": 6,
        "BOUND_AT": bus.BOUND,
        "LOCK_AT": bus.LOCK,
        "STATE_AT": bus.STATE,
        "READ_AT": bus.BOUND,
        "READ_BYTES": bus.STATE + bus.STATE_BYTES - bus.BOUND,
        "CURRENT_AT": 4,
        "CURRENT_SIGN": 10,
        "MILLIAMPERES": _as_float(1e3 * bus.SCS_STALL / feetech_bus.FULL_TORQUE),
        "STALL_MA": round(1e3 * bus.SCS_STALL),
        "ENDLESS": 0,
        "MAX_POSITION": bus.SCS_STEPS - 1,
        "MAX_RATE": 1023,
        "SMALL_LIMIT": 255,
        "SMALL_MOST": 255,
        "LARGE_MOST": 255,
        "LARGE_LEAST": 0,
    }


def _as_float(value: float) -> str:
    return f"{value:.4f}f"


def _join_braced(values: Iterable[str]) -> str:
    return "{" + ", ".join(values) + "}"
