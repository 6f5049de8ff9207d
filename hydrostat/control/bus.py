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
    """Return the time of a monotonic clock that continues while the computer sleeps [s]."""
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
    """Interface of a serial port, as in pyserial."""

    timeout: float | None

    def write(self, data: bytes, /) -> int | None:
        """Send bytes."""
        ...

    def read(self, size: int, /) -> bytes:
        """Read this number of bytes, or fewer after the timeout."""
        ...

    def close(self) -> None:
        """Close the port."""
        ...


class Bus(ABC):
    """Interface for a chain of motors, each with one spool; a new kind of motor is one class.

    Only a `BusLink` uses a bus, from one thread at a time. A bus has no fallback: if a motor cannot be reached, it
    raises an error. Angles are in the motor's own count; a `Calibration` converts them to contractions. Motors get
    bounded positions only: they never get a speed or a current without an end.

    Attributes:
        kind: prefix of every message about it.
        lost_position: True if motors are known to have lost their count since calibration.
        silence: time without commands after which the motors' watchdogs may have fired; `restart_watchdog` resets them
            [s].
    """

    kind: ClassVar[str]
    lost_position: bool = False
    silence: float = inf

    @property
    def clock(self) -> Callable[[], float]:
        """Monotonic clock of its readings, also used to monitor motors [s]."""
        return steady

    def mark(self, zeros: Vector | None = None) -> None:  # noqa: B027 - most motors know their angle by themselves
        """Record that the motors are calibrated, if they can lose that (HydrostatError: it cannot be recorded).

        The zero angles [rad] are for boards that play moves without a computer.
        """

    @abstractmethod
    def identify(self) -> tuple[MotorFacts, ...]:
        """Read the data of the requested motors, torque off (HydrostatError: a silent motor, or another model).

        Arms the watchdog of each motor, then tests that the motor stops after a moment without commands.
        """

    @abstractmethod
    def arm(self, currents: Vector) -> None:
        """Switch torque on at present positions, with current limits [A] (HydrostatError: a limit was not set)."""

    def restart_watchdog(self) -> None:  # noqa: B027 - where nothing watches by itself there is nothing to do
        """Restart the watchdogs of armed motors, because they may have fired while other motors were armed.

        Raises:
            HydrostatError: a watchdog does not restart.
        """

    def find_restarted(self) -> tuple[int, ...]:
        """Return the indices of armed motors whose torque is off because they lost power. It never raises.

        Called only if a motor does not pull or follow. Empty if the bus reports this with its readings.
        """
        return ()

    def restart(self, place: int) -> None:  # noqa: B027 - where faults end by themselves there is nothing to do
        """Restart a motor that switched itself off; its torque stays off, and it may lose its count of turns.

        Raises:
            HydrostatError: the motor does not answer.
        """

    @abstractmethod
    def read(self) -> Reading:
        """Return the latest reading; a silent motor keeps its old time stamp (HydrostatError: the port is gone)."""

    @abstractmethod
    def write(self, angles: Vector, speeds: Vector) -> None:
        """Command angles [rad] at maximum speeds [rad/s]; return immediately (HydrostatError: the port is gone)."""

    def halt(self) -> None:  # noqa: B027 - where `stop` waits for nobody there is nothing to do
        """Command a stop at the last read positions, without waiting for an answer; `stop` follows. It never raises.

        This stops the other lines immediately, while `stop` may wait for a line that does not answer.
        """

    @abstractmethod
    def stop(self) -> None:
        """Stop the motors at their positions, torque on. You can call this at any time, twice; it never raises."""

    @abstractmethod
    def close(self) -> None:
        """Stop the motors and close the port. You can call this twice, and it never raises."""
