"""`EmulatedFeetechChain`: servos of the STS and SCS series that are not there, which behave as badly as real ones."""

import os
import select
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf, sqrt
from typing import Self

from hydrostat.control.dynamixel_packets import ALL, PING, READ, SYNC_READ, SYNC_WRITE, WRITE
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo
from hydrostat.control.feetech_bus import (
    AMPERE,
    BOUND,
    FULL_TORQUE,
    GOAL,
    LOW,
    RISE,
    STALL,
    STATE,
    TICK,
    TORQUE,
    VOLTS,
    SumReader,
    pack,
)
from hydrostat.control.scs_bus import BOUND as SCS_BOUND
from hydrostat.control.scs_bus import NUMBER, SCS_STALL, SCS_TICK


class EmulatedLine:
    """Serial line with emulated servos for a separate program; no hardware is involved.

    Attributes:
        chain: chain of the servos.
        path: pseudo-terminal to open in place of a serial port.
        moved: last time at which each servo moved, by the clock of the chain [s].
    """

    def __init__(self, chain: EmulatedChain) -> None:
        """A line that is open until it is closed (OSError: no pseudo-terminals here)."""
        import tty

        self.chain, self._over = chain, threading.Event()
        self._inner, self._outer = os.openpty()
        tty.setraw(self._outer)
        self.path = os.ttyname(self._outer)
        self.moved = [0.0] * len(chain.servos)
        self._angles = [servo.angle for servo in chain.servos]
        chain.watch = self._look
        self._thread = threading.Thread(target=self._run, name="emulated servos", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        """Give the line itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()

    def unplug(self) -> None:
        """Unplug the serial line; the servos keep their power."""
        for end in (self._outer, self._inner):
            with suppress(OSError):
                os.close(end)

    def close(self) -> None:
        """Close the line."""
        self._over.set()
        self._thread.join(5.0)
        self.unplug()

    def _look(self) -> None:
        for index, servo in enumerate(self.chain.servos):
            if servo.angle != self._angles[index]:
                self._angles[index], self.moved[index] = servo.angle, self.chain.now

    def _run(self) -> None:
        begin, plugged = time.monotonic() - self.chain.now, True
        while not self._over.is_set():
            try:
                if plugged and select.select([self._inner], [], [], 0.002)[0]:
                    self.chain.write(os.read(self._inner, 4096))
                    while waiting := self.chain.in_waiting:
                        os.write(self._inner, self.chain.read(waiting))
            except (OSError, ValueError):
                plugged = False
            if not plugged:
                self._over.wait(0.002)
            self.chain.wait(max(0.0, time.monotonic() - begin - self.chain.now))


class _EmulatedFeetech(EmulatedServo, ABC):
    """Registers and torque switch of servos of both series."""

    def take(self, place: int, data: bytes) -> int:
        """Write registers as commanded over the bus; returns the error of the answer."""
        if place + len(data) <= STATE:
            self.table[place : place + len(data)] = data
            if place == TORQUE and data[0] == 0:
                self.ails.overloaded = False
            if place == TORQUE and data[0] == 1:
                self._hold_place()
        return 0

    @abstractmethod
    def _hold_place(self) -> None:
        """Take the present place as the goal, as the servo does when its torque is switched on."""


@dataclass
class EmulatedSts(_EmulatedFeetech):
    """Emulated STS servo; it has no watchdog."""

    model: int = 777
    supply: float = 7.4  # voltage that it measures [V]
    allowed: tuple[float, float] = (4.0, 8.0)  # least and greatest supply in its memory [V]

    def __post_init__(self) -> None:
        self.table = bytearray(80)
        self.table[0:6] = bytes([3, 10, 0, *self.model.to_bytes(2, "little"), self.number])
        self.table[VOLTS : VOLTS + 2] = bytes([round(10 * self.allowed[1]), round(10 * self.allowed[0])])
        self.table[BOUND : BOUND + 2] = FULL_TORQUE.to_bytes(2, "little")
        self.heard, self.moved = -inf, 0.0
        self.step(0.0, 1e-3)

    @property
    def most(self) -> float:
        """Largest torque that its limit allows [N m]."""
        return self.constant * STALL * int.from_bytes(self.table[BOUND : BOUND + 2], "little") / FULL_TORQUE

    def _hold_place(self) -> None:
        self._write_register(GOAL, round(self.counted_angle / TICK))

    def step(self, now: float, dt: float) -> None:
        """Advance to a time [s]."""
        on = bool(self.table[TORQUE]) and not self.ails.is_off
        goal, rise = self.origin + self._number(GOAL) * TICK, (self.table[RISE] or 1000) * 100 * TICK
        limit = int.from_bytes(self.table[GOAL + 4 : GOAL + 6], "little") * TICK or 6.0
        limit = min(limit, 6.0, sqrt(2 * rise * abs(goal - self.angle)))
        wanted = min(max((goal - self.angle) / dt, -limit), limit)
        speed = min(max(wanted, self.speed - rise * dt), self.speed + rise * dt)
        if self.ails.stuck or not on or (speed > 0 and self.load(self.angle + speed * dt) > self.most):
            speed = 0.0
        self.speed = speed
        self.angle += speed * dt
        current = min(self.load(self.angle) / self.constant, STALL) if on else 0.0
        self._write_register(STATE, round(self.counted_angle / TICK))
        self.table[STATE + 6 : STATE + 8] = bytes(
            [round(10 * (3.5 if self.ails.sags else self.supply)), 85 if self.ails.hot else 35]
        )
        self._write_register(STATE + 13, round(current / AMPERE))

    def _number(self, place: int) -> int:
        value = int.from_bytes(self.table[place : place + 2], "little")
        return -(value & 0x7FFF) if value & 0x8000 else value

    def _write_register(self, place: int, value: int) -> None:
        self.table[place : place + 2] = (abs(value) | (0x8000 if value < 0 else 0)).to_bytes(2, "little")


@dataclass
class EmulatedScs(_EmulatedFeetech):
    """Emulated SCS servo: high byte first, 300 degrees, load in place of current."""

    model: int = NUMBER
    supply: float = 6.0  # voltage that it measures [V]

    def __post_init__(self) -> None:
        self.table = bytearray(80)
        self.table[0:6] = bytes([3, 10, 0, *self.model.to_bytes(2, "big"), self.number])
        self.table[LOW : LOW + 4] = bytes([0, 0, 0x03, 0xFF])
        self.table[VOLTS : VOLTS + 2] = bytes([84, 45])
        self.table[SCS_BOUND : SCS_BOUND + 2] = FULL_TORQUE.to_bytes(2, "big")
        self.heard, self.moved = -inf, 0.0
        self.step(0.0, 1e-3)

    def begin_anew(self) -> None:
        """Cycle the power: its potentiometer keeps the position."""
        self.speed = 0.0
        self.__post_init__()

    @property
    def most(self) -> float:
        """Largest torque that its limit allows [N m]."""
        return self.constant * SCS_STALL * self._word(SCS_BOUND) / FULL_TORQUE

    def _hold_place(self) -> None:
        self._write_word(GOAL, round(self.angle / SCS_TICK))

    def step(self, now: float, dt: float) -> None:
        """Advance to a time [s]."""
        on = bool(self.table[TORQUE]) and not self.ails.is_off
        limit = min(self._word(GOAL + 4) * SCS_TICK or 10.0, 10.0)
        way = self._word(GOAL) * SCS_TICK - self.angle
        speed = min(max(way / dt, -limit), limit)
        if self.ails.stuck or not on or (speed > 0 and self.load(self.angle + speed * dt) > self.most):
            speed = 0.0
        self.speed = speed
        self.angle = min(max(self.angle + speed * dt, 0.0), 1023 * SCS_TICK)
        share = min(self.load(self.angle) / (self.constant * SCS_STALL), 1.0) if on else 0.0
        self._write_word(STATE, round(self.angle / SCS_TICK))
        self._write_word(STATE + 4, round(FULL_TORQUE * abs(share)) | (0x400 if share < 0 else 0))
        volts = 3.5 if self.ails.sags else self.supply
        self.table[STATE + 6 : STATE + 8] = bytes([round(10 * volts), 85 if self.ails.hot else 35])

    def _word(self, place: int) -> int:
        return int.from_bytes(self.table[place : place + 2], "big")

    def _write_word(self, place: int, value: int) -> None:
        self.table[place : place + 2] = value.to_bytes(2, "big")


class EmulatedFeetechChain(EmulatedChain):
    """Port with emulated Feetech servos."""

    def __init__(self, servos: Sequence[EmulatedSts | EmulatedScs]) -> None:
        """Servos that all hear the same line."""
        super().__init__(servos)
        self._reader = SumReader()

    def _answers(self, number: int, instruction: int, content: bytes) -> bytes:
        heard = [servo for servo in self.servos if not servo.ails.deaf]
        if instruction == SYNC_READ:
            heard = [servo for servo in heard if not isinstance(servo, EmulatedScs)]  # these do not know it
            place, size, *numbers = content
            by_number = {servo.number: servo for servo in heard}
            asked = [by_number[each] for each in numbers if each in by_number]
            return b"".join(_status(servo, bytes(servo.table[place : place + size])) for servo in asked)
        if instruction == SYNC_WRITE:
            place, size, rest = content[0], content[1], content[2:]
            for start in range(0, len(rest) - size, size + 1):
                for servo in heard:
                    if servo.number == rest[start]:
                        servo.take(place, rest[start + 1 : start + 1 + size])
            return b""
        told = b""
        for servo in heard:
            if number in (servo.number, ALL):
                if instruction == WRITE:
                    servo.take(content[0], content[1:])
                if number != ALL and instruction in (PING, READ, WRITE):
                    read = servo.table[content[0] : content[0] + content[1]] if instruction == READ else b""
                    told += _status(servo, bytes(read))
        return told


def _status(servo: EmulatedServo, content: bytes) -> bytes:
    return pack(servo.number, servo.ails.bits, content)
