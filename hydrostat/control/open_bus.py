"""`open_bus`, `open_line`: motors by words such as dynamixel:/dev/ttyUSB0."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, Port
from hydrostat.control.calibration import Calibration
from hydrostat.control.dynamixel_bus import MODELS, DynamixelBus
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedScs, EmulatedSts
from hydrostat.control.emulated_servos import EmulatedServo, LiveChain
from hydrostat.control.feetech_bus import MODELS as FEETECH_MODELS
from hydrostat.control.feetech_bus import STALL, FeetechBus
from hydrostat.control.firmware_build import robot_word
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.control.joined_bus import JoinedBus
from hydrostat.control.scs_bus import SCS_STALL, ScsBus
from hydrostat.control.servo_bus import ServoBus
from hydrostat.errors import HydrostatError, InputError
from hydrostat.fabrication import Motor
from hydrostat.robot import Robot
from hydrostat.units import plural
from hydrostat.version import install_command

EMULATED = "emulated"
"""Port name that selects emulated servos instead of hardware."""


HELD_UP = 0.03
"""Time that passes at most for emulated servos while this computer is busy with others [s]."""


class EmulatedBus(DynamixelBus):
    """Servos that are not there, in real time, or slower on a busy computer; every line says so."""

    kind = EMULATED


class EmulatedFeetechBus(FeetechBus):
    """The same with servos of the STS series."""

    kind = EMULATED


class EmulatedScsBus(ScsBus):
    """The same with servos of the SCS series."""

    kind = EMULATED


class LiveFeetechChain(LiveChain, EmulatedFeetechChain):
    """Servos of the STS and SCS series in real time."""


def add_cable_layers(calibration: Calibration) -> Calibration:
    """Return a calibration with slightly larger spools, on which cable winds in layers after the first turn.

    Emulated motors have such spools during calibration; only the ruler readings reveal it.
    """
    turn, cable = 2 * np.pi, 4e-4  # [rad], [m]
    spools = []
    for motor in calibration.motors:
        radius, taken, curve = 1.01 * motor.radius, 0.0, []
        for layer in range(1, 5):
            taken += turn * radius
            curve.append((layer * turn, taken))
            radius += cable
        spools.append(replace(motor, radius=1.01 * motor.radius, curve=tuple(curve)))
    return Calibration(tuple(spools))


def open_bus(text: str, robot: Robot, calibration: Calibration, tensions: Callable[[Vector], Vector]) -> Bus:
    """Open a bus to the motors of a calibration.

    Args:
        text: KIND:PORT or KIND:PORT@BAUD, with commas between the ports of several boards; or "emulated".
        robot: robot with the winches.
        calibration: motor calibration.
        tensions: total cable tension of each winch [N] at contractions [m], as load of emulated motors.

    Raises:
        InputError: an unknown kind, or a wrong number of ports for the boards of the calibration.
        HydrostatError: a port cannot be opened, or pyserial is missing.
    """
    check_port(text)
    if text == EMULATED:
        return _make_emulated_bus(robot, calibration, tensions)
    kind, _, rest = text.partition(":")
    make, usual = _KINDS[kind]
    ports, buses = rest.split(","), list[Bus]()
    if len(ports) != calibration.boards:
        boards = plural(calibration.boards, "board")
        raise InputError(f"--motors {text}: has {plural(len(ports), 'port')}, and motors.toml has motors on {boards}")
    try:
        for board, port in enumerate(ports, 1):
            name, _, baud = port.partition("@")
            buses.append(make(open_line(name, int(baud or usual)), robot, calibration, board))
    except BaseException:
        for bus in buses:
            bus.close()
        raise
    parts = [(bus, calibration.places(board)) for board, bus in enumerate(buses, 1)]
    return buses[0] if len(buses) == 1 else JoinedBus(parts)


def check_port(text: str) -> None:
    """Check the text of a motor connection, as in `open_bus` (InputError: unknown kind, no port, or no baud rate)."""
    kind, _, rest = text.partition(":")
    ports = rest.split(",")
    if text != EMULATED and (kind not in _KINDS or not all(ports) or len(set(ports)) < len(ports)):
        shown = ", ".join(f"{each}:/dev/ttyUSB0" for each in _KINDS)
        raise InputError(
            f"--motors {text}: write {EMULATED}, or one such as {shown}; separate those of several boards by commas"
        )
    for port in ports:
        _, at, baud = port.partition("@")
        if at and not baud.isdecimal():
            raise InputError(f"--motors {text}: the baud rate after @ must be a number, such as 57600")


def servo_ratings() -> dict[str, Any]:
    """Return ratings of servos that a page drives: model numbers, stall current [A], torque constant [N m/A]."""
    return {
        "feetech": {"models": list(FEETECH_MODELS), "stall": STALL},
        "dynamixel": {
            number: {"measures": model.measures, "stall": model.stall, "constant": model.torque / model.stall}
            for number, model in MODELS.items()
        },
    }


def _make_emulated_bus(robot: Robot, calibration: Calibration, tensions: Callable[[Vector], Vector]) -> Bus:
    """Servos of the robot's motor that stand where nothing is taken in, each with the load of its cables."""
    motor, calibration = robot.motor, calibration.assume_zeros(robot)
    angles = [each.angle(0.0) for each in calibration.motors]
    servos: list[EmulatedServo]
    make: type[ServoBus] = EmulatedBus
    if motor == "scs0009":
        make, servos = EmulatedScsBus, [EmulatedScs(n, angle=each) for n, each in enumerate(angles, 1)]
        ratio = Motor.choose(motor).stall_torque * 1e-3 / SCS_STALL
    elif motor in _LIKE_STS:
        make, facts = EmulatedFeetechBus, _LIKE_STS[motor]
        servos = [EmulatedSts(n, angle=each, **facts) for n, each in enumerate(angles, 1)]
        ratio = Motor.choose(motor).stall_torque * 1e-3 / STALL
    else:
        model = _LIKE_X.get(motor, _LIKE_X["xl330"])
        servos = [EmulatedServo(n, angle=each, model=model) for n, each in enumerate(angles, 1)]
        ratio = MODELS[model].torque / MODELS[model].stall
    chain = (LiveChain if make is EmulatedBus else LiveFeetechChain)(servos, longest=HELD_UP)
    known, torques = -1.0, np.zeros(len(servos))

    def load(index: int) -> Callable[[float], float]:
        def torque(_: float) -> float:
            nonlocal known, torques
            if known != chain.now:  # all again at each step
                taken = np.array([m.contraction(s.angle) for m, s in zip(calibration.motors, servos, strict=True)])
                known, torques = chain.now, calibration.radii(taken) * tensions(taken)
            return float(torques[index])

        return torque

    for index, servo in enumerate(servos):
        servo.load, servo.constant = load(index), ratio
    return make(chain, [servo.number for servo in servos], clock=chain.clock, wait=chain.sleep)


_LIKE_X = {"xl330": 1200, "xc330": 1240}
"""Numbers of the models of Dynamixel servos, by the motor of robot.toml; any other motor is emulated as the first."""

_LIKE_STS: dict[str, dict[str, Any]] = {
    "sts3215": {"supply": 7.4, "allowed": (4.0, 8.0)},
    "sts3215-12v": {"supply": 12.0, "allowed": (8.0, 14.0)},
    "st3020": {"model": 1289, "supply": 12.0, "allowed": (6.0, 14.0)},
}
"""Emulated servos of the STS series: number of the model, supply, and least and greatest supply in the memory [V]."""


def open_line(name: str, baud: int) -> Port:
    """Open a serial line (HydrostatError: it cannot be opened, or pyserial is missing)."""
    try:
        import serial
    except ModuleNotFoundError:
        raise InputError(f"serial lines need pyserial; install it: {install_command('motors')}") from None
    try:
        return cast(Port, serial.Serial(name, baud, timeout=0.02, write_timeout=0.1, exclusive=True))
    except (OSError, ValueError) as error:
        raise HydrostatError(
            f"cannot open {name} ({error}). Check the cable, the port name and your permissions (dialout group)."
        ) from None


def _dynamixel(line: Port, _robot: Robot, calibration: Calibration, board: int) -> Bus:
    return DynamixelBus(line, _numbers(calibration, board))


def _feetech(line: Port, _robot: Robot, calibration: Calibration, board: int) -> Bus:
    return FeetechBus(line, _numbers(calibration, board))


def _scs(line: Port, _robot: Robot, calibration: Calibration, board: int) -> Bus:
    return ScsBus(line, _numbers(calibration, board))


def _firmware(line: Port, robot: Robot, calibration: Calibration, board: int) -> Bus:
    """Motors of one board, whose settings are those of the robot now."""
    counts = [calibration.motors[place].counts for place in calibration.places(board)]
    if None in counts:
        line.close()
        raise InputError("motors.toml has no counts of the motors' encoders; `hydrostat firmware` adds them")
    word = robot_word(robot, calibration, board)
    return FirmwareBus(line, [count or 0.0 for count in counts], _numbers(calibration, board), robot=word)


def _numbers(calibration: Calibration, board: int) -> list[int]:
    return [calibration.motors[place].number for place in calibration.places(board)]


_KINDS: dict[str, tuple[Callable[[Port, Robot, Calibration, int], Bus], int]] = {
    "dynamixel": (_dynamixel, 57600),
    "feetech": (_feetech, 1_000_000),
    "scs": (_scs, 1_000_000),
    "firmware": (_firmware, 250_000),
}
"""Factory of each kind of bus, called with a line and its board number, and the usual baud rate [bit/s]."""
