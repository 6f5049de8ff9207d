"""A board with our firmware that is not there: its lines and states in Python, with motors that pull at springs.

`test_several_boards` compares what it answers with the firmware itself in simavr.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import copysign, pi, sqrt

from hydrostat.control.emulated_servos import EmulatedChain, InjectedFaults
from hydrostat.control.firmware_bus import line_of

DEADLINE, HOT, STALLED = 0.2, 0.05, 0.1  # what stops its motors [s]
WORDS = {"R", "G", "A", "S", "O", "M"}


@dataclass
class BoardMotor:
    """A geared motor; angles of its spool [rad], torques [N m]."""

    angle: float = 0.0
    speed: float = 0.0
    load: Callable[[float], float] = lambda _: 0.0
    constant: float = 0.35
    low: int = -1000
    high: int = 10000
    most: float = 10.0  # speed [rad/s]
    rise: float = 125.0  # [rad/s^2]
    counts: float = 1000.0  # in a turn
    ails: InjectedFaults = field(default_factory=InjectedFaults)

    def __post_init__(self) -> None:
        self.switch_on()

    def switch_on(self) -> None:
        """Count from 0 here."""
        self.origin = self.aim = self.angle
        self.pace = self.hot = self.stuck = self.speed = 0.0
        self.bound = 0

    @property
    def torque(self) -> float:
        """What it holds against [N m]."""
        return self.load(self.angle)

    @property
    def count(self) -> int:
        """Of its encoder."""
        return round(self.counts * (self.angle - self.origin) / (2 * pi))

    @property
    def milliamps(self) -> int:
        """What it draws, as a gear holds without."""
        return round(1e3 * self.torque / self.constant) if self.speed > 0 else 0

    def stand(self) -> None:
        """Go no further."""
        self.aim, self.pace, self.hot, self.stuck = self.angle, 0.0, 0.0, 0.0

    def step(self, dt: float) -> str:
        """Go on with its aim; what went wrong, empty for nothing."""
        left = self.aim - self.angle
        limit = min(self.pace, sqrt(2 * self.rise * abs(left)))
        wanted = min(abs(left) / dt, limit, abs(self.speed) + self.rise * dt)
        self.speed = 0.0 if self.ails.stuck else copysign(wanted, left)
        self.angle += self.speed * dt
        self.hot = self.hot + dt if self.milliamps > self.bound else 0.0
        self.stuck = self.stuck + dt if self.ails.stuck and abs(left) > 0.02 and self.pace else 0.0
        return "current" if self.hot > HOT else "stall" if self.stuck > STALLED else ""


class EmulatedBoard(EmulatedChain):
    """A board on a port; `deaf`: its line is broken both ways, while it has its power."""

    def __init__(self, motors: Sequence[BoardMotor], robot: str = "trial") -> None:
        """A board that was switched on just now."""
        super().__init__(())
        self.servos, self.robot, self.deaf = tuple(motors), robot, False  # type: ignore[assignment]
        self.begin_anew()

    def begin_anew(self) -> None:
        """Be reset: all counts are 0, wherever motors are."""
        self.state, self.culprit, self.heard, self.silent, self.marked = "off", 0, -1, 0.0, False
        self._line = b""
        for motor in self.motors:
            motor.switch_on()

    @property
    def motors(self) -> tuple[BoardMotor, ...]:
        """Its motors, the first is number 1."""
        return self.servos  # type: ignore[return-value]

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        end = self.now + seconds
        while self.now < end - 1e-12:
            dt = min(self.STEP, end - self.now)
            self.now += dt
            self._tick(dt)
            self.watch()

    def write(self, data: bytes, /) -> int:
        """Send bytes to it."""
        if self.gone:
            raise OSError("the device is not there")
        came = self.towards(data)
        if not self.deaf:
            self._line += came
            while b"\n" in self._line:
                line, _, self._line = self._line.partition(b"\n")
                said = self.back(line_of(self._obey(line))) if line else b""
                self._told += said
        return len(data)

    def read(self, size: int, /) -> bytes:
        """Bytes of its answers."""
        if self.deaf:
            self._told = b""
        return super().read(size)

    def _tick(self, dt: float) -> None:
        self.silent += dt
        if self.state == "armed" and self.silent > DEADLINE:
            self._fault("silent", 0)
        for number, motor in enumerate(self.motors, 1):
            if self.state not in ("armed", "silent"):
                motor.speed = 0.0
            elif why := motor.step(dt):
                self._fault(why, number)

    def _fault(self, why: str, culprit: int) -> None:
        self.state, self.culprit = why, culprit
        for motor in self.motors:
            motor.stand()

    def _obey(self, line: bytes) -> str:
        text = line.decode("ascii", "replace")
        told, star, _ = text.rpartition("*")
        if not star or line_of(told) != line + b"\n":
            return "? no checksum"
        number, _, rest = told.partition(" ")
        if not number.isdecimal() or not rest:
            return "? no number"
        ahead = (int(number) - self.heard) % 256
        if self.heard >= 0 and rest[0] != "I" and not 0 < ahead <= 127:
            if rest[0] == "S":
                self._fault(self.state, self.culprit)
            return f"{number} no old"
        self.heard, self.silent = int(number), 0.0
        return f"{number} {self._answer(rest[0], rest[1:].split())}"

    def _answer(self, word: str, numbers: list[str]) -> str:
        if word == "I":
            marked = "marked" if self.marked else "new"
            return f"ok hydrostat 1 uno {self.robot} {len(self.motors)} 200 started {marked}"
        if word == "R":
            told = " ".join(f"{motor.count} {motor.milliamps}" for motor in self.motors)
            return f"ok {self.state} {self.culprit if self.state in ('current', 'stall') else 0} {told}"
        if word not in WORDS:
            return "no word"
        if word in ("G", "A"):
            return (self._go if word == "G" else self._arm)([int(each) for each in numbers])
        self.marked |= word == "M"
        if word != "M":
            self._fault("off" if word == "O" else self.state, self.culprit)
        return "ok"

    def _go(self, told: list[int]) -> str:
        if self.state != "armed":
            return f"no {self.state}"
        if any(not motor.low <= goal <= motor.high for motor, goal in zip(self.motors, told[::2], strict=True)):
            return "no limit"
        for motor, goal, rate in zip(self.motors, told[::2], told[1::2], strict=True):
            motor.aim = motor.origin + 2 * pi * goal / motor.counts
            motor.pace = min(2 * pi * abs(rate) / motor.counts, motor.most)
        return "ok"

    def _arm(self, bounds: list[int]) -> str:
        if not all(0 < bound <= 1500 for bound in bounds):
            return "no current"
        self._fault("armed", 0)
        for motor, bound in zip(self.motors, bounds, strict=True):
            motor.bound = bound
        return "ok"
