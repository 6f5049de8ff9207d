"""`EmulatedChain`: servos of the X series that are not there, which behave as badly as real ones."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf, pi, sqrt
from struct import Struct

from hydrostat.control.dynamixel_bus import (
    CURRENT,
    GOAL,
    HARDWARE,
    MODE,
    MODELS,
    PROFILE,
    PWM,
    SPEEDING,
    STATE,
    TICK,
    TORQUE,
    TURNING,
    WATCHDOG,
)
from hydrostat.control.dynamixel_packets import (
    ALL,
    PING,
    READ,
    REBOOT,
    STATUS,
    SYNC_READ,
    SYNC_WRITE,
    WRITE,
    PacketReader,
    pack,
)

_SIGNED = {1: Struct("<b"), 2: Struct("<h"), 4: Struct("<i")}
_UNSIGNED = {1: Struct("<B"), 2: Struct("<H"), 4: Struct("<I")}
"""Registers by their size [bytes]."""


def _pick(formats: dict[int, Struct], size: int) -> Struct:
    """Format of a register by its number of bytes."""
    try:
        return formats[size]
    except KeyError:
        raise ValueError(f"a register has 1, 2 or 4 bytes, not {size}") from None


@dataclass
class InjectedFaults:
    """Faults injected into an emulated servo.

    Attributes:
        deaf: it hears nothing and says nothing, and goes on with what it was told.
        stuck: it does not turn.
        deaf_watchdog: its watchdog does not stop it (the 330 series).
        hot: it reports that it is too hot, and its torque is off.
        overloaded: it reports an overload, and its torque is off, until it is restarted.
        sags: its supply is below what it allows.
    """

    deaf: bool = False
    stuck: bool = False
    deaf_watchdog: bool = False
    hot: bool = False
    overloaded: bool = False
    sags: bool = False

    @property
    def is_off(self) -> bool:
        """True if the torque is off."""
        return self.hot or self.overloaded

    @property
    def bits(self) -> int:
        """Errors as both makers report them."""
        return 0x01 * self.sags | 0x04 * self.hot | 0x20 * self.overloaded


@dataclass
class EmulatedServo:
    """Emulated servo with its control table, gear and load.

    Attributes:
        number: servo number on its bus.
        model: model number.
        angle: spool angle [rad].
        speed: spool speed [rad/s].
        origin: angle from which it counts: 0, or start of the turn in which it was last switched on [rad].
        load: cable torque by angle [N m], which pulls the spool back.
        constant: torque constant [N m/A].
        ails: injected faults.
    """

    number: int
    model: int = 1200
    angle: float = 0.0
    speed: float = 0.0
    origin: float = 0.0
    load: Callable[[float], float] = lambda _: 0.0
    constant: float = 0.35
    ails: InjectedFaults = field(default_factory=InjectedFaults)

    def __post_init__(self) -> None:
        self.table = bytearray(256)
        self.set(0, self.model, 2)
        self.set(6, 52, 1)
        self.set(144, 50, 2)
        self.table[146] = 30
        self.heard, self.moved = -inf, 0.0

    def begin_anew(self) -> None:
        """Cycle the power: volatile registers are reset, torque is off, and turns are lost."""
        mode = self.table[MODE]
        self.speed, self.origin = 0.0, 2 * pi * (self.angle // (2 * pi))
        self.__post_init__()
        self.table[MODE] = mode
        self.step(0.0, 1e-3)

    @property
    def counted_angle(self) -> float:
        """Angle in its own count [rad]."""
        return self.angle - self.origin

    def get(self, place: int, size: int) -> int:
        """A register of 1, 2 or 4 bytes (ValueError: another size)."""
        return _pick(_SIGNED, size).unpack_from(self.table, place)[0]

    def set(self, place: int, value: int, size: int) -> None:
        """Set a register of 1, 2 or 4 bytes (ValueError: another size; struct.error: a value that does not fit)."""
        _pick(_SIGNED if value < 0 else _UNSIGNED, size).pack_into(self.table, place, int(value))

    @property
    def torque(self) -> float:
        """Load torque at the present angle [N m]."""
        return self.load(self.angle)

    @property
    def most(self) -> float:
        """Largest torque that its limits allow [N m]."""
        model = MODELS[self.model]
        bound = 1e-3 * self.get(CURRENT, 2) if model.measures else model.stall * self.get(PWM, 2) / 885
        return self.constant * min(bound, model.stall)

    def take(self, place: int, data: bytes) -> int:
        """Write registers as commanded over the bus; return the error of the answer."""
        fired = self.get(WATCHDOG, 1) == -1
        if fired and place + len(data) > PWM and place < STATE:
            return 0x07  # goals are read-only
        if place in (MODE,) and self.table[TORQUE]:
            return 0x07
        self.table[place : place + len(data)] = data
        if place == TORQUE:
            self.set(GOAL, round(self.counted_angle / TICK), 4)
        return 0

    def step(self, now: float, dt: float) -> None:
        """Advance to a time [s]."""
        watch = self.get(WATCHDOG, 1)
        on = bool(self.table[TORQUE]) and not self.ails.is_off
        if watch > 0 and now - self.heard > 0.02 * watch:
            watch = -1
            self.set(WATCHDOG, watch, 1)
        stopped = watch == -1 and not self.ails.deaf_watchdog
        goal = self.angle if stopped or not on else self.origin + TICK * self.get(GOAL, 4)
        rise = SPEEDING * self.get(PROFILE, 4) or 1e3
        limit = min(TURNING * self.get(PROFILE + 4, 4) or 6.0, sqrt(2 * rise * abs(goal - self.angle)))
        wanted = max(-limit, min(limit, (goal - self.angle) / dt))
        speed = max(self.speed - rise * dt, min(self.speed + rise * dt, wanted))
        if self.ails.stuck or not on or stopped:
            speed = 0.0
        if speed > 0 and self.load(self.angle + speed * dt) > self.most:
            speed = 0.0  # the bound of the current holds it
        self.speed = speed
        self.angle += speed * dt
        if on and self.load(self.angle) > 1.0 * MODELS[self.model].stall * self.constant:
            self.angle -= min(5.0, abs(self.angle)) * dt  # it gives way
        self._show()

    def _show(self) -> None:
        model = MODELS[self.model]
        current = min(self.torque / self.constant, model.stall) if self.table[TORQUE] and not self.ails.is_off else 0.0
        self.set(STATE, round(1e3 * current / (1.0 if model.measures else model.stall)), 2)
        self.set(STATE + 6, round(self.counted_angle / TICK), 4)
        self.table[HARDWARE] = self.ails.bits
        self.set(144, 35 if self.ails.sags else 50, 2)
        self.table[146] = 85 if self.ails.hot else 35


class EmulatedChain:
    """Port with emulated servos, with its own clock, which advances while a program waits or reads.

    `towards` and `back` transform bytes on the line; they may drop, flip or double them.

    Attributes:
        servos: servos on the line.
        now: time of the chain [s].
        gone: True if the line is unplugged.
    """

    timeout: float | None = 0.0
    STEP = 1e-3

    def __init__(self, servos: Sequence[EmulatedServo]) -> None:
        """Servos that all hear the same line."""
        self.servos, self.now, self.gone = tuple(servos), 0.0, False
        self.towards: Callable[[bytes], bytes] = lambda data: data
        self.back: Callable[[bytes], bytes] = lambda data: data
        self.watch: Callable[[], None] = lambda: None
        self._reader, self._told = PacketReader(), b""

    def clock(self) -> float:
        """Return the time of the chain [s]."""
        return self.now

    def wait(self, seconds: float) -> None:
        """Advance the time."""
        end = self.now + seconds
        while self.now < end - 1e-12:
            dt = min(self.STEP, end - self.now)
            self.now += dt
            for servo in self.servos:
                servo.step(self.now, dt)
            self.watch()

    @property
    def in_waiting(self) -> int:
        """Number of bytes that can be read immediately."""
        return len(self._told)

    def write(self, data: bytes, /) -> int:
        """Send bytes to all servos."""
        if self.gone:
            raise OSError("the device is not there")
        for packet in self._reader.feed(self.towards(data)):
            for servo in self.servos:
                if not servo.ails.deaf and packet.number in (servo.number, ALL):
                    servo.heard = self.now
            self._told += self.back(self._answers(packet.number, packet.instruction, packet.content))
        return len(data)

    def read(self, size: int, /) -> bytes:
        """Read bytes of their answers."""
        if self.gone:
            raise OSError("the device is not there")
        self.wait(self.STEP if self._told or not self.timeout else min(max(self.timeout, 1e-4), 0.005))
        taken, self._told = self._told[:size], self._told[size:]
        return taken

    def close(self) -> None:
        """Unplug the line."""
        self.gone = True

    def _answers(self, number: int, instruction: int, content: bytes) -> bytes:
        if instruction in (SYNC_READ, SYNC_WRITE):
            return self._all(instruction, content)
        told = b""
        for servo in self.servos:
            if servo.number == number and not servo.ails.deaf:
                told += self._one(servo, instruction, content)
        return told

    def _all(self, instruction: int, content: bytes) -> bytes:
        place, size, told = int.from_bytes(content[:2], "little"), int.from_bytes(content[2:4], "little"), b""
        rest = content[4:]
        if instruction == SYNC_READ:
            for number in rest:
                for servo in self.servos:
                    if servo.number == number and not servo.ails.deaf:
                        told += _status(servo, 0, bytes(servo.table[place : place + size]))
            return told
        for start in range(0, len(rest) - size, size + 1):
            for servo in self.servos:
                if servo.number == rest[start] and not servo.ails.deaf:
                    servo.take(place, rest[start + 1 : start + 1 + size])
        return told

    def _one(self, servo: EmulatedServo, instruction: int, content: bytes) -> bytes:
        if instruction == PING:
            return _status(servo, 0, bytes([*servo.table[0:2], servo.table[6]]))
        if instruction == READ:
            place, size = int.from_bytes(content[:2], "little"), int.from_bytes(content[2:4], "little")
            return _status(servo, 0, bytes(servo.table[place : place + size]))
        if instruction == WRITE:
            return _status(servo, servo.take(int.from_bytes(content[:2], "little"), content[2:]), b"")
        if instruction == REBOOT:
            servo.ails.overloaded = False
            servo.begin_anew()
            return _status(servo, 0, b"")
        return _status(servo, 0x02, b"")


class LiveChain(EmulatedChain):
    """Emulated chain in real time, for programs that run as with motors."""

    def __init__(self, servos: Sequence[EmulatedServo], *, longest: float = 5.0) -> None:
        """Servos from now on, for which so much time passes at most between two looks at their clock [s].

        Where that is short, and all go by this clock, nothing is late for them on a busy computer.
        """
        super().__init__(servos)
        self.now = self._time = self._looked = time.monotonic()
        self._longest = longest

    def clock(self) -> float:
        """Return the time of the chain [s]."""
        looked = time.monotonic()
        self._time += min(looked - self._looked, self._longest)
        self._looked = looked
        return self._time

    def sleep(self, seconds: float) -> None:
        """Wait for a duration of the chain's time [s]."""
        end = self.clock() + seconds
        while (left := end - self.clock()) > 0:
            time.sleep(min(left, self._longest))

    def write(self, data: bytes, /) -> int:
        """Send bytes to all servos at their present state."""
        self._catch_up()
        return super().write(data)

    def read(self, size: int, /) -> bytes:
        """Read bytes of their answers."""
        if not self._told and self.timeout:
            time.sleep(min(self.timeout, self.STEP))
        self._catch_up()
        taken, self._told = self._told[:size], self._told[size:]
        return taken

    def _catch_up(self) -> None:
        self.wait(self.clock() - self.now)


def _status(servo: EmulatedServo, error: int, content: bytes) -> bytes:
    alert = 0x80 if servo.ails.bits else 0
    return pack(servo.number, STATUS, bytes([error | alert]) + content)
