"""`WinchSizing`, `PowerPlan`: strength and speed of the motor of each winch, and the supply of all motors."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from hydrostat.errors import InputError
from hydrostat.fabrication.board_kind import BOARDS, board_for
from hydrostat.fabrication.demand import Demand
from hydrostat.fabrication.lists.table import Table, number_column, text_column
from hydrostat.fabrication.parts.motor import MARGIN, MOTORS, Motor
from hydrostat.robot import Robot, Winch
from hydrostat.units import list_words

SLOW_TRAVEL_TIME = 10.0  # a winch that takes longer than this for its full travel [s] is called slow


@dataclass(frozen=True, kw_only=True)
class WinchSizing:
    """Demand of one winch on its motor, and what it gets."""

    winch: str  # its name
    cables: int  # number of its cables
    tension: float  # largest of one of its cables [N]
    torque: float  # largest on its shaft [N mm]
    radius: float  # radius of its spool, where its travel is measured [mm]
    turns: float  # turns of the spool over its full travel
    travel: float  # the most cable it takes in from rest [mm]
    motor: Motor  # motor that turns it

    @property
    def torque_with_margin(self) -> float:
        """Largest torque with the margin [N mm]."""
        return MARGIN * self.torque

    @property
    def loaded_speed(self) -> float:
        """Speed of the motor at the largest torque [rpm]: speed falls evenly with torque, to none at stall."""
        return self.motor.speed * max(0.0, 1 - self.torque / self.motor.stall_torque)

    @property
    def pull(self) -> float:
        """Speed of the cable at the largest torque [mm/s]."""
        return 2 * math.pi * self.radius * self.loaded_speed / 60

    @property
    def time(self) -> float | None:
        """Time for the full travel [s], as `travel_time`."""
        return travel_time(self.motor, self.torque, 1e-3 * self.travel, 1e-3 * self.radius)

    @property
    def verdict(self) -> str:
        """Verdict on the motor, in words."""
        if self.torque >= self.motor.stall_torque:
            return "too weak"
        if self.torque_with_margin > self.motor.stall_torque:
            return "no margin"
        return "holds for seconds" if self.torque_with_margin > self.motor.rated_torque else "good"


def travel_time(motor: Motor, torque: float, travel: float, radius: float) -> float | None:
    """Time for a travel on a spool of a radius [m] as torque rises evenly to the largest [N mm]; None: it stalls [s].

    With q the largest torque over that of stall, speed falls along the travel as 1 - q x; the integral of 1/speed gives
    - ln(1 - q) / q times the time without load.
    """
    share = torque / motor.stall_torque
    if share >= 1:
        return None
    slower = -math.log1p(-share) / share if share > 1e-9 else 1.0
    return slower * travel / (2 * math.pi * radius * motor.speed / 60)


def turns_of(winch: Winch) -> float:
    """Turns of the spool of a winch from its maximum payout to its full travel."""
    return (winch.travel + winch.release) / (2 * math.pi * winch.spool_radius)


_MINDS = {
    "too weak": "above the motor's stall torque ({0.stall_torque:.0f} N mm). It cannot reach the poses. Choose a "
    "stronger motor or a smaller spool",
    "no margin": "above the motor's stall torque ({0.stall_torque:.0f} N mm). It may stall before it reaches a pose",
    "holds for seconds": "above the motor's continuous rating ({0.rated_torque:.0f} N mm). Hold such poses for "
    "seconds only",
}
"""Warning on a winch, by its verdict."""


def motor_warnings(sizings: tuple[WinchSizing, ...]) -> tuple[str, ...]:
    """Warn of what the motor cannot do: a sentence for all winches of one verdict, and for each that is slow."""
    found = []
    for verdict, mind in _MINDS.items():
        alike = [sizing for sizing in sizings if sizing.verdict == verdict]
        if alike:
            worst = max(alike, key=lambda sizing: sizing.torque)
            names = ", ".join(f'"{sizing.winch}"' for sizing in alike)
            who = f"winch {names} needs" if len(alike) == 1 else f"winches {names} need up to"
            enough = f", {worst.torque_with_margin:.0f} N mm with the margin of {MARGIN:g}"
            margin = "" if verdict == "too weak" else enough
            found.append(f"{who} {worst.torque:.0f} N mm{margin}, {mind.format(worst.motor)}")
    slow = (sizing for sizing in sizings if sizing.time is not None and sizing.time > SLOW_TRAVEL_TIME)
    return (
        *found,
        *(
            f'winch "{sizing.winch}" needs {sizing.time:.0f} s for its travel of {sizing.travel:.0f} mm'
            for sizing in slow
        ),
    )


def size_winches(robot: Robot, demand: Demand, motor: Motor) -> tuple[WinchSizing, ...]:
    """Compute each winch's load on a motor (InputError: demand of another robot, a motor without torque or speed)."""
    if len(demand.torques) != len(robot.winches) or len(demand.tensions) != len(robot.cables):
        raise InputError(
            f"the demand is of {len(demand.torques)} winches and {len(demand.tensions)} cables, the robot has "
            f"{len(robot.winches)} and {len(robot.cables)}"
        )
    for name in ("stall_torque", "rated_torque", "speed"):
        if not getattr(motor, name) > 0:
            raise InputError(f"{name} of {motor.title} must be above 0, not {getattr(motor, name):g}")
    return tuple(
        _sizing(robot, demand, motor, winch, float(torque))
        for winch, torque in zip(robot.winches, demand.torques, strict=True)
    )


def _sizing(robot: Robot, demand: Demand, motor: Motor, winch: Winch, torque: float) -> WinchSizing:
    mine = [
        float(tension)
        for cable, tension in zip(robot.cables, demand.tensions, strict=True)
        if cable.winch == winch.name
    ]
    return WinchSizing(
        winch=winch.name,
        cables=len(mine),
        tension=max(mine, default=0.0),
        torque=1e3 * torque,
        radius=1e3 * winch.spool_radius,
        turns=turns_of(winch),
        travel=1e3 * winch.travel,
        motor=motor,
    )


@dataclass(frozen=True, kw_only=True)
class MotorRow:
    """Demand of one winch on its motor against what the motor gives; torques in N mm."""

    winch: Annotated[str, text_column("winch")]
    cables: Annotated[int, number_column("cables", decimals=0)]
    tension: Annotated[float, number_column("largest tension", "N")]
    radius: Annotated[float, number_column("spool radius", "mm")]
    torque: Annotated[float, number_column("largest torque", "N mm")]
    needed: Annotated[float, number_column("with margin", "N mm")]
    stall_torque: Annotated[float, number_column("motor stalls at", "N mm", decimals=0)]
    rated_torque: Annotated[float, number_column("bears for long", "N mm", decimals=0)]
    turns: Annotated[float, number_column("spool turns", decimals=2)]
    free_speed: Annotated[float, number_column("free speed", "rpm", decimals=0)]
    loaded_speed: Annotated[float, number_column("loaded speed", "rpm", decimals=0)]
    cable_speed: Annotated[float, number_column("cable speed", "mm/s")]
    time: Annotated[float | None, number_column("full travel in", "s")]
    verdict: Annotated[str, text_column("verdict")]


def motor_table(sizings: tuple[WinchSizing, ...], demand: Demand, motor: Motor) -> Table[MotorRow]:
    """Table of what each winch asks of the motor and what it gets."""
    poses = ", ".join(demand.poses) or "no pose"
    return Table(
        name="motor_sizing",
        title=f"Motors: {motor.title}",
        row=MotorRow,
        rows=tuple(
            MotorRow(
                winch=sizing.winch,
                cables=sizing.cables,
                tension=sizing.tension,
                radius=sizing.radius,
                torque=sizing.torque,
                needed=sizing.torque_with_margin,
                stall_torque=motor.stall_torque,
                rated_torque=motor.rated_torque,
                turns=sizing.turns,
                free_speed=motor.speed,
                loaded_speed=sizing.loaded_speed,
                cable_speed=sizing.pull,
                time=sizing.time,
                verdict=sizing.verdict,
            )
            for sizing in sizings
        ),
        notes=(
            f"Largest in: {poses}. Margin {MARGIN:g}: for friction at the pinholes and bodies stiffer than assumed.",
            "Speed falls evenly with torque, from the free speed to none at stall.",
            *(f"Not solved: {missed}." for missed in demand.missed),
        ),
    )


CURRENT_RESERVE = 1.5
"""Ratio of a supply's current to the current of all motors at their largest torque at once: bodies are stiffer than
assumed, and supplies sag at their limit."""

FUSES = (1.0, 2.0, 3.0, 5.0, 7.5, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0)  # blade fuses, ISO 8820-3 [A]
WIRES = ((3.0, 0.5, 20), (7.5, 0.75, 18), (10.0, 1.0, 17), (15.0, 1.5, 16), (25.0, 2.5, 14), (40.0, 6.0, 10))
"""Fuse [A] at most, copper [mm^2], gauge (AWG) at least: short leads in free air. Our own table, thicker than what
single wires are rated at; of no standard."""

PLUG = 3.0
"""Current that one plug of a chain of servos withstands [A]: JST EH, 3 A with wire of AWG 22. Told from memory."""

CELL, CELLS, USED = 1.2, 2.0, 0.8
"""A NiMH cell of size AA: volts, ampere hours, and the share of them that is used."""

FRESH = 1.45
"""Volts of such a cell fresh from its charger, assumed: servos that refuse more than their range get fewer cells."""

RESTING = 1 / 3
"""Share of the largest currents that motors draw on average while a robot is shown. Assumed, measured on none."""


@dataclass(frozen=True, kw_only=True)
class PowerRow:
    """Part of the power supply, or a setting of it."""

    what: Annotated[str, text_column("what")]
    amount: Annotated[str, text_column("how much")]


@dataclass(frozen=True, kw_only=True)
class PowerPlan:
    """Power supply of the motors of a robot.

    Attributes:
        motor: motor of all winches.
        winches: names of the winches, in the order of the motors' numbers.
        largest: current of all motors at their largest torque at once [A].
        board: kind of board that is asked for, None for the smallest that fit.
    """

    motor: Motor
    winches: tuple[str, ...]
    largest: float
    board: str | None = None

    @property
    def servos(self) -> bool:
        """True if the motors are servos on a bus; else they are DC motors on boards."""
        return self.motor.horn is not None

    @property
    def supply(self) -> float:
        """Current of the supply [A]: with what is spare, and never below two motors that stall."""
        needed = max(CURRENT_RESERVE * self.largest, min(2, len(self.winches)) * self.motor.stall_current)
        supplies = (2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0)  # currents of available supplies [A]
        return next((size for size in supplies if size >= needed), supplies[-1])

    @property
    def fuse(self) -> float:
        """The largest fuse [A] that the supply can still blow."""
        return max(size for size in FUSES if size <= max(0.9 * self.supply, FUSES[0]))

    @property
    def wire(self) -> tuple[float, int]:
        """Copper [mm^2] and gauge (AWG) of the leads from the supply."""
        return next((area, gauge) for most, area, gauge in WIRES if self.fuse <= most)

    @property
    def feeds(self) -> int:
        """Number of feeds of a chain of servos that keeps each plug within its rated current."""
        return max(1, math.ceil(min(self.fuse, len(self.winches) * self.motor.stall_current) / PLUG))

    @property
    def feed_ids(self) -> tuple[int, ...]:
        """Numbers of the servos, from 1, at which the chain is fed, with as many servos after each."""
        count = min(self.feeds, len(self.winches))
        return tuple(1 + group * len(self.winches) // count for group in range(count))

    @property
    def boards(self) -> tuple[str, ...]:
        """Boards for DC motors."""
        rest, found = len(self.winches), list[str]()
        while rest > 0:
            found.append(self.board or board_for(rest))
            rest -= BOARDS[found[-1]].motors
        return tuple(found)

    @property
    def has_relay(self) -> bool:
        """True if a board drives the servos through their bus adapter, also without a computer."""
        return self.servos and self.board is not None

    @property
    def resets(self) -> bool:
        """True if a program that opens the port of a board resets it, as those of Arduino."""
        return any(BOARDS[board].loader for board in self.boards)

    @property
    def cells(self) -> int:
        """NiMH cells in a row that come nearest to the motors' volts without going beyond."""
        return int(self.motor.volts / (FRESH if self.motor.is_feetech else CELL) + 1e-9)

    @property
    def hours(self) -> float:
        """About how long a set of cells lasts [h]."""
        return USED * CELLS / max(RESTING * self.largest, 1e-9)

    @property
    def table(self) -> Table[PowerRow]:
        """Parts and settings of the supply, as a list."""
        area, gauge = self.wire
        hours = f"{self.hours:.0f}" if self.hours >= 10 else f"{self.hours:.1f}"
        rows: list[tuple[str, str]] = [
            ("supply", f"{self.motor.volts:g} V, {self.supply:g} A or more"),
            ("all motors at their largest at once", f"{self.largest:.1f} A"),
            ("fuse, in the plus lead at the supply", f"{self.fuse:g} A"),
            ("leads from the supply", f"{area:g} mm^2 (AWG {gauge}) or thicker"),
            ("switch for the motors, in reach", f"in the plus lead, for {self.fuse:g} A"),
            (
                "without a wall socket",
                f"{self.cells} NiMH cells AA in a row, about {hours} h",
            ),
        ]
        if self.servos:
            rows.append(("feed the chain at", list_words(f"ID {number}" for number in self.feed_ids)))
        if self.has_relay:
            sender, receiver = BOARDS[self.board or ""].servo_pins
            rows.append(("bus adapter to ESP32-S3", f"TX to pin {sender}, RX to pin {receiver}, GND to GND"))
            rows.append(("ports of the ESP32-S3", "UART: computer. USB: power bank, to play alone"))
        return Table(
            name="power",
            title="Power",
            row=PowerRow,
            rows=tuple(PowerRow(what=what, amount=amount) for what, amount in rows),
            notes=(
                f"Current rises evenly with torque, from {self.motor.free_current:g} A to "
                f"{self.motor.stall_current:g} A at stall. Spare: {CURRENT_RESERVE:g} times. Battery: motors draw a "
                "third of their largest on average, which is assumed.",
            ),
        )


def check_motor_and_board(key: str, board: str | None, winches: int = 0) -> None:
    """Check a motor by its key and the board that drives it on each winch.

    Raises:
        InputError: an unknown motor, or a board that does not drive it, or drives fewer.
    """
    if key != "auto":
        _check_board(Motor.choose(key), board, winches)


def _check_board(motor: Motor, board: str | None, winches: int) -> None:
    if board is None:
        return
    if motor.is_feetech:
        most = BOARDS[board].servos
        if not most:
            raise InputError(f"--board {board}: drives no bus servos. Use --board esp32s3, or remove it.")
        if winches > most:
            raise InputError(f"--board {board}: drives {most} servos, the robot has {winches}. Remove --board.")
    elif motor.bus:
        known = " or ".join(each.key for each in MOTORS if not each.bus)
        raise InputError(f"--board {board}: motor {motor.key} needs no board. Remove --board, or add --motor {known}.")


def power_plan(torques: Mapping[str, float], motor: Motor, board: str | None = None) -> PowerPlan | None:
    """Plan the supply of a motor on each winch, by its name and largest torque [N mm]; None where there are none.

    Raises:
        InputError: a board that does not drive motors on a bus, or drives fewer.
    """
    _check_board(motor, board, len(torques))
    if not torques:
        return None
    spread = motor.stall_current - motor.free_current
    loads = (motor.free_current + spread * min(1.0, torque / motor.stall_torque) for torque in torques.values())
    return PowerPlan(motor=motor, winches=tuple(torques), largest=sum(loads), board=board)
