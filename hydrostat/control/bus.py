"""`Bus`: the contract of a chain of motors on one cable to this computer."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import ClassVar, Protocol, runtime_checkable

from hydrostat.arrays import Vector

_AWAKE = getattr(time, "CLOCK_BOOTTIME", getattr(time, "CLOCK_MONOTONIC", None))
"""Runs on while the computer sleeps, on Linux and macOS, where `time.monotonic` stands still meanwhile."""


def steady() -> float:
    """Time of a clock that only runs forward, and runs on while the computer sleeps [s]."""
    return time.monotonic() if _AWAKE is None else time.clock_gettime(_AWAKE)


@dataclass(frozen=True, kw_only=True)
class MotorFacts:
    """Identification answer of one motor.

    Attributes:
        number: motor number on its bus.
        model: in words.
        firmware: its version.
        watchdog: True if the motor passed the watchdog trial at this connection.
        constant: torque by current, of its stall [N m/A]; NaN where that is not known.
    """

    number: int
    model: str
    firmware: int
    watchdog: bool
    constant: float = float("nan")


@dataclass(frozen=True, kw_only=True, eq=False)
class Reading:
    """Latest state of each motor; quantities that a motor never reported are NaN.

    Attributes:
        angles: spool angles, rising with contraction [rad].
        currents: positive as they take cable in [A].
        temperatures: [degree C].
        volts: supply voltage [V].
        stamps: when each was heard, by the clock of the bus [s].
        faults: fault of each motor in words; empty for none.
    """

    angles: Vector
    currents: Vector
    temperatures: Vector
    volts: Vector
    stamps: Vector
    faults: tuple[str, ...]


@runtime_checkable
class Port(Protocol):
    """A serial line, as pyserial has it."""

    timeout: float | None

    def write(self, data: bytes, /) -> int | None:
        """Send bytes."""
        ...

    def read(self, size: int, /) -> bytes:
        """Read this number of bytes, or fewer after the timeout."""
        ...

    def close(self) -> None:
        """Let it go."""
        ...


class Bus(ABC):
    """Contract of a chain of motors, each with one spool: a new kind of motor is one class.

    Only a `BusLink` uses a bus, which keeps to one thread at a time. A bus never stands in for another: what cannot be
    reached is an error. Angles count from where the motor itself counts; contractions are made of them by a
    `Calibration`. Motors turn to bounded positions only: they are never told a speed or a current to keep for ever.

    Attributes:
        kind: words that begin every line about it.
        lost_position: True if motors are known to have lost their count since calibration.
        silence: time without commands after which watchdogs may have fired that `restart_watchdog` begins again [s].
    """

    kind: ClassVar[str]
    lost_position: bool = False
    silence: float = inf

    @property
    def clock(self) -> Callable[[], float]:
        """Monotonic clock of its readings, by which motors are watched [s]."""
        return steady

    def mark(self, zeros: Vector | None = None) -> None:  # noqa: B027 - most motors know their angle by themselves
        """Remember that the motors are calibrated, where that can be lost (HydrostatError: it cannot be remembered).

        Angles of the zeros [rad] are for boards that play moves alone.
        """

    @abstractmethod
    def identify(self) -> tuple[MotorFacts, ...]:
        """Facts of the motors asked for, in their order, torque off (HydrostatError: who is silent, or another model).

        Each motor's own watchdog is armed and then tried: told nothing for a moment, does it stop?
        """

    @abstractmethod
    def arm(self, currents: Vector) -> None:
        """Switch torque on where they stand, each bounded to a current [A] (HydrostatError: one did not take it)."""

    def restart_watchdog(self) -> None:  # noqa: B027 - where nothing watches by itself there is nothing to do
        """Let the own watchdogs of armed motors begin again: they may have fired while others were armed.

        Raises:
            HydrostatError: one does not.
        """

    def find_restarted(self) -> tuple[int, ...]:
        """Return the places of armed motors whose torque is off: they lost power since. It never raises.

        It is asked only where a motor does not pull or follow. Empty where the bus reports it with its readings.
        """
        return ()

    def restart(self, place: int) -> None:  # noqa: B027 - where faults end by themselves there is nothing to do
        """Restart a motor that switched itself off; its torque is off then, and its count of turns may be lost.

        Raises:
            HydrostatError: it does not answer.
        """

    @abstractmethod
    def read(self) -> Reading:
        """Return the latest reading; a silent motor keeps its old stamp (HydrostatError: the line itself is gone)."""

    @abstractmethod
    def write(self, angles: Vector, speeds: Vector) -> None:
        """Let them go to angles [rad] at speeds of at most [rad/s]; return immediately (HydrostatError: line gone)."""

    def halt(self) -> None:  # noqa: B027 - where `stop` waits for nobody there is nothing to do
        """Command a stop at the last read positions, without waiting for an answer; `stop` follows. It never raises.

        For the other lines this is the time in which `stop` asks one that does not answer.
        """

    @abstractmethod
    def stop(self) -> None:
        """Let them stand where they are, torque on. It may be called at any time, twice, and never raises."""

    @abstractmethod
    def close(self) -> None:
        """Stop them and let the line go. It may be called twice and never raises."""
