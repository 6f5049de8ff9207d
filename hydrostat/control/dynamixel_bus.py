"""`DynamixelBus`: servos of ROBOTIS' X series (XL330, XC330, XL430) by protocol 2.0.

Source: ROBOTIS e-Manual, control tables of XL330-M288, XC330-T288, XL430-W250.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, ClassVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import MotorFacts, Port, Reading
from hydrostat.control.dynamixel_packets import (
    ALL,
    PING,
    READ,
    REBOOT,
    STATUS,
    SYNC_READ,
    SYNC_WRITE,
    WRITE,
    Packet,
    pack,
)
from hydrostat.control.servo_bus import ServoBus
from hydrostat.errors import HydrostatError


@dataclass(frozen=True)
class DynamixelModel:
    """Ratings and capabilities of a servo model.

    Attributes:
        title: product name.
        measures: True if it measures and limits its current; else it reports load as a share of the stall current.
        stall: current at stall [A].
        torque: at stall [N m].
    """

    title: str
    measures: bool
    stall: float
    torque: float


MODELS = {
    1190: DynamixelModel("XL330-M077", True, 1.47, 0.215),
    1200: DynamixelModel("XL330-M288", True, 1.47, 0.52),
    1210: DynamixelModel("XC330-T181", True, 0.8, 0.76),
    1220: DynamixelModel("XC330-T288", True, 0.8, 0.92),
    1230: DynamixelModel("XC330-M181", True, 1.8, 0.6),
    1240: DynamixelModel("XC330-M288", True, 1.8, 0.93),
    1060: DynamixelModel("XL430-W250", False, 1.4, 1.5),
}
"""By the number that they answer a ping with; stall at 5 V, of the T types at 11.1 V: to be checked on yours."""

MODE, TORQUE, HARDWARE, WATCHDOG, PWM, CURRENT, PROFILE, GOAL, STATE = 11, 64, 70, 98, 100, 102, 108, 116, 126
"""Places in the control table: operating mode, torque on, hardware error, watchdog, goal PWM and current, profile
acceleration (and velocity, goal position after it), goal position, present current (to temperature after it)."""
STATE_BYTES = 21
TICK = 2 * pi / 4096  # angle of a step [rad]
TURNING = 0.229 * 2 * pi / 60  # speed of a step [rad/s]
SPEEDING = 214.577 * 2 * pi / 3600  # acceleration of a step [rad/s^2]
FULL_PWM = 885
WATCH = 5  # of the watchdog [20 ms]: 100 ms
ACCELERATION = 200.0  # at which they begin and end to turn [rad/s^2]
FAULTS = {
    0x01: "supply voltage out of range",
    0x04: "too hot",
    0x08: "encoder fault",
    0x10: "electrical shock or too little power",
    0x20: "overloaded",
}
PROOF, SOON = 5.0 * pi / 180.0, 0.115
"""Angle that each is asked to turn while its watchdog is tried [rad], and the time that this takes [s]: whoever tries
may die just then, and a motor whose watchdog is deaf goes on to its goal."""
BOOT = 0.5  # time until a servo that was rebooted answers [s], assumed
TRIED = 2
"""Watchdog time while the watchdog is tested [20 ms]: it should let a motor turn by a third of that angle."""


class DynamixelBus(ServoBus):
    """Dynamixel servos in extended position mode, with a current limit where supported (modes 5 and 4)."""

    kind: ClassVar[str] = "dynamixel"
    braking: ClassVar[float] = ACCELERATION
    silence = 0.08  # watchdogs fire after 0.1 s

    def __init__(self, port: Port, numbers: Sequence[int], **rest: Any) -> None:
        """Servos on a port, by their numbers; the rest is as a `ServoBus` has it."""
        super().__init__(port, numbers, **rest)
        self._models: dict[int, DynamixelModel] = {}
        self._proved = set[int]()  # whose watchdog was seen to stop them

    def identify(self) -> tuple[MotorFacts, ...]:
        """Read the data of the servos; arm and test each watchdog."""
        with self._lock:
            firmware = {number: self._ping(number) for number in self._numbers}
            self._known, self._holding = True, False
            for number in self._numbers:
                self._set(number, TORQUE, 0, 1)
                self._set(number, MODE, 5 if self._models[number].measures else 4, 1)
            self._proved = set()
            self._proved = self._prove()
            return tuple(
                MotorFacts(
                    number=number,
                    model=self._models[number].title,
                    firmware=firmware[number],
                    watchdog=number in self._proved,
                    constant=self._models[number].torque / self._models[number].stall,
                )
                for number in self._numbers
            )

    def arm(self, currents: Vector) -> None:
        """Switch torque on at present positions."""
        with self._lock:
            self._stand()
            for number, most in zip(self._numbers, currents.tolist(), strict=True):
                self._set(number, WATCHDOG, 0, 1)  # one that has fired refuses goals until it is reset,
                self._set(number, GOAL, self._steps(number), 4)  # and then goes on to the last
                self._limit_current(number, most)
                self._set(number, TORQUE, 1, 1)
            self._holding = True
            self.restart_watchdog()  # at last: who waits for others to be armed would be told nothing

    def restart_watchdog(self) -> None:
        """Arm all watchdogs at once; a servo whose watchdog has fired rejects goals until its reset."""
        with self._lock:
            self._tell_all(WATCHDOG, dict.fromkeys(self._numbers, bytes(1)))
            armed = set[int]()
            for _ in range(5):
                self._tell_all(WATCHDOG, {number: bytes([WATCH]) for number in self._numbers})
                armed = {packet.number for packet in self._ask_all(WATCHDOG, 1) if packet.content[1] == WATCH}
                if armed.issuperset(self._numbers):
                    return
            raise self._refusal_error(min(set(self._numbers) - armed), WATCHDOG)

    def _ask_state(self) -> Reading:
        last = {name: getattr(self._last, name).copy() for name in ("angles", "currents", "temperatures", "volts")}
        stamps, faults = self._last.stamps.copy(), list(self._last.faults)
        for packet in self._ask_all(STATE, STATE_BYTES):
            index, told = self._numbers.index(packet.number), packet.content[1:]
            model = self._models.get(packet.number, _UNKNOWN)
            raw = _to_signed(told[0:2])
            last["currents"][index] = 1e-3 * raw * (1.0 if model.measures else model.stall)
            last["angles"][index] = TICK * _to_signed(told[6:10])
            last["volts"][index], last["temperatures"][index] = 0.1 * _to_signed(told[18:20]), told[20]
            stamps[index] = self._clock()
            faults[index] = self._fault(packet)
        return Reading(**last, stamps=stamps, faults=tuple(faults))

    def write(self, angles: Vector, speeds: Vector) -> None:
        """Send goals and speeds to all servos at once, without answers."""
        steps = np.rint(angles / TICK).astype(int).tolist()
        rates = np.clip(np.rint(np.abs(speeds) / TURNING), 1, 32767).astype(int).tolist()
        rise = max(1, min(32767, round(ACCELERATION / SPEEDING)))
        values = {
            number: b"".join(value.to_bytes(4, "little", signed=True) for value in (rise, rate, step))
            for number, rate, step in zip(self._numbers, rates, steps, strict=True)
        }
        with self._lock:
            self._goals, self._speeds = angles.copy(), np.abs(speeds)
            self._tell_all(PROFILE, values)

    def restart(self, place: int) -> None:
        """Reboot a servo, the only way to clear a hardware error; it then counts from within one turn."""
        with self._lock:
            self._send(self._numbers[place], REBOOT)
            self._answers(1)
            self._wait(BOOT)
            self.lost_position = True

    def _limit_current(self, number: int, current: float) -> None:
        """Bound the current of a servo [A]; its share of power where it does not measure that."""
        model = self._models[number]
        if model.measures:
            self._set(number, CURRENT, max(1, round(1e3 * min(current, model.stall))), 2)
        else:
            self._set(number, PWM, max(1, round(FULL_PWM * min(current / model.stall, 1.0))), 2)

    def _has_torque(self, number: int) -> bool | None:
        told = next((told for told in (self._get(number, TORQUE, 1) for _ in range(3)) if told is not None), None)
        return None if told is None else told == 1

    def _steps(self, number: int) -> int:
        """Latest reported position of a servo [ticks]."""
        return round(float(self._last.angles[self._numbers.index(number)]) / TICK)

    def _hold(self, angles: dict[int, float]) -> None:
        # A watchdog that has fired refuses goals, whether it has stopped its motor or not. Where it has, it is let be:
        # without it the motor would go on to its last goal until the new one comes.
        if doubtful := {number: bytes(1) for number in self._numbers if number not in self._proved}:
            self._tell_all(WATCHDOG, doubtful)
        steps = {number: round(angle / TICK).to_bytes(4, "little", signed=True) for number, angle in angles.items()}
        self._tell_all(GOAL, steps)

    def _tell_all(self, place: int, values: Mapping[int, bytes]) -> None:
        """Write a register of several servos at once; none answers."""
        size = len(next(iter(values.values()), b""))
        content = b"".join(bytes([number]) + value for number, value in values.items())
        self._send(ALL, SYNC_WRITE, place.to_bytes(2, "little") + size.to_bytes(2, "little") + content)

    def _prove(self) -> set[int]:
        """Servos that stop by themselves: told nothing they stand on the way to a goal, and told it again they go on.

        The goal is never further ahead than they turn in `SOON`; a spool of 8 mm takes in 0.7 mm of cable. Who is not
        heard, or does not go on (held by its cable, say), has proved nothing.
        """
        begin = self._read_again()
        if (lost := np.flatnonzero(np.isnan(begin)).tolist()) != []:
            raise self._silent(self._numbers[lost[0]])
        for number in self._numbers:
            self._set(number, WATCHDOG, 0, 1)
            self._set(number, GOAL, self._steps(number), 4)
            self._limit_current(number, 0.3 * self._models[number].stall)
            self._set(number, TORQUE, 1, 1)
        speeds = np.full(len(begin), PROOF / SOON)
        self._tell_all(WATCHDOG, dict.fromkeys(self._numbers, bytes([TRIED])))  # all at once, as they wait so short
        self.write(begin + PROOF, speeds)
        self._wait(0.15)
        first = self._read_again()
        self._wait(0.03)
        second = self._read_again()
        for number in self._numbers:
            self._set(number, WATCHDOG, 0, 1)
        self.write(begin + PROOF, speeds)
        self._wait(0.2)
        on = self._read_again()
        still = (np.abs(second - first) <= 1.5 * TICK) & (first - begin > 1.5 * TICK) & (first - begin < 0.7 * PROOF)
        self.write(begin, speeds)
        self._wait(0.2)
        for number in self._numbers:
            self._set(number, TORQUE, 0, 1)
        proved = still & (on - second > 0.2 * PROOF)  # NaN, not heard: not proved
        return {number for number, each in zip(self._numbers, proved.tolist(), strict=True) if each}

    def _read_again(self) -> Vector:
        """Positions by answers to a fresh query [rad]; NaN where five queries brought none."""
        asked, reading = self._clock(), self.read()
        for _ in range(4):
            if (reading.stamps > asked).all():
                break
            reading = self.read()
        return np.where(reading.stamps > asked, reading.angles, np.nan)

    def _ping(self, number: int) -> int:
        """Version of the firmware of a servo, after its model is known to be one of ours."""
        for _ in range(3):
            self._send(number, PING)
            for packet in self._answers(1):
                if packet.number == number and len(packet.content) == 4:
                    model = int.from_bytes(packet.content[1:3], "little")
                    if model not in MODELS:
                        known = ", ".join(each.title for each in MODELS.values())
                        raise HydrostatError(f"motor {number} is a servo of number {model}; known are {known}")
                    self._models[number] = MODELS[model]
                    return packet.content[3]
        raise self._silent(number)

    def _fault(self, packet: Packet) -> str:
        """Fault that a servo reports with its answer, in words; empty for none."""
        if not packet.content[0] & 0x80:
            return ""
        told = self._get(packet.number, HARDWARE, 1)
        words = [word for bit, word in FAULTS.items() if told is not None and told & bit]
        return ", ".join(words) or "it reports an error of its hardware"

    def _set(self, number: int, place: int, value: int, size: int) -> None:
        """Write a register, and read that it was taken: an answer does not tell which question it is to."""
        for _ in range(5):
            self._send(number, WRITE, place.to_bytes(2, "little") + value.to_bytes(size, "little", signed=value < 0))
            self._answers(1)
            if self._get(number, place, size) == value % (1 << 8 * size):
                return
        raise self._refusal_error(number, place)

    def _refusal_error(self, number: int, place: int) -> HydrostatError:
        return HydrostatError(f"motor {number} did not take {_NAMES.get(place, place)}; look at its power and cable")

    def _ask_all(self, place: int, size: int) -> list[Packet]:
        """Answers of all that answer to one question for a register."""
        self._send(ALL, SYNC_READ, place.to_bytes(2, "little") + size.to_bytes(2, "little") + bytes(self._numbers))
        return self._receive(
            len(self._numbers),
            lambda packet: (
                packet.instruction == STATUS and packet.number in self._numbers and len(packet.content) == 1 + size
            ),
        )

    def _get(self, number: int, place: int, size: int) -> int | None:
        self._send(number, READ, place.to_bytes(2, "little") + size.to_bytes(2, "little"))
        for packet in self._answers(1):
            if packet.number == number and len(packet.content) == 1 + size:
                return int.from_bytes(packet.content[1:], "little")
        return None

    def _send(self, number: int, instruction: int, content: bytes = b"") -> None:
        self._send_packet(pack(number, instruction, content))

    def _answers(self, count: int) -> list[Packet]:
        return self._receive(count, lambda packet: packet.instruction == STATUS)


_UNKNOWN = DynamixelModel("", True, 1.0, 1.0)
_NAMES = {
    MODE: "its mode",
    TORQUE: "its torque switch",
    WATCHDOG: "its watchdog",
    GOAL: "its goal",
    PWM: "its bound of power",
    CURRENT: "its bound of current",
}


def _to_signed(data: bytes) -> int:
    return int.from_bytes(data, "little", signed=True)
