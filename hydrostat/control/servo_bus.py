"""`ServoBus`: what servos on one serial line share, whatever their packets are."""

import threading
import time
from abc import abstractmethod
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, Port, Reading, steady
from hydrostat.control.dynamixel_packets import Packet, PacketReader
from hydrostat.errors import HydrostatError

TURNED = 0.75 * 2 * np.pi
"""No servo turns so far between two answers [rad]: who says so has begun to count again."""
LATELY = 0.1
"""Maximum age of a reading [s] by which a motor may be told to hold without asking for its position first."""
BLOCKED = 0.1  # share of its told speed below which a motor does not get on
ANEW = "lost power for a moment, and its turn count. Run hydrostat calibrate again"


class ServoBus(Bus):
    """Servos on a serial line that answer when they are asked."""

    packets: ClassVar[type[PacketReader]] = PacketReader
    braking: ClassVar[float] = 150.0  # least deceleration, of emulated STS and SCS [rad/s^2]

    def __init__(
        self,
        port: Port,
        numbers: Sequence[int],
        *,
        clock: Callable[[], float] = steady,
        wait: Callable[[float], None] = time.sleep,
        answer: float = 0.02,
    ) -> None:
        """Servos on a port, by their numbers.

        Args:
            port: an open serial line.
            numbers: servo numbers.
            clock: monotonic clock [s].
            wait: lets so much time pass [s].
            answer: longest time for answers [s].
        """
        self._port, self._numbers, self._clock, self._wait, self._answer = port, tuple(numbers), clock, wait, answer
        self._lock, self._reader = threading.RLock(), self.packets()
        self._known = self._closed = False  # whether it is known who they are, and whether the line is let go
        self._holding = False  # whether torque is on since they were heard last
        self.lost_position = False
        nothing = np.full(len(self._numbers), np.nan)
        self._goals = nothing.copy()  # told last [rad]
        self._speeds = np.zeros(len(self._numbers))  # with those goals [rad/s]
        self._asked = -np.inf  # when they were asked last [s]
        self._last = self._before = Reading(
            angles=nothing,
            currents=nothing,
            temperatures=nothing,
            volts=nothing,
            stamps=np.full(len(self._numbers), -np.inf),
            faults=("",) * len(self._numbers),
        )

    @property
    def clock(self) -> Callable[[], float]:
        """Monotonic clock of its readings, by which motors are watched [s]."""
        return self._clock

    def read(self) -> Reading:
        """Return the latest reading of each servo."""
        with self._lock:
            self._asked = self._clock()
            reading = self._ask_state()
            if jumped := self._find_jumped(reading):  # noise passes a sum now and then, but not twice
                reading = self._join_readings(reading, self._ask_state(), jumped)
            return self._keep_reading(reading)

    def halt(self) -> None:
        """Goals where they can stand soonest, as they have gone on since they were read; none if the line is in use."""
        if not self._lock.acquire(blocking=False):
            return
        try:
            near = np.flatnonzero(self._clock() - self._last.stamps < LATELY).tolist()
            if near and self._known and not self._closed:
                with suppress(Exception):
                    self._goals[near] = self._find_stops()[near]
                    self._hold({self._numbers[index]: float(self._goals[index]) for index in near})
        finally:
            self._lock.release()

    def stop(self) -> None:
        """Stop them; one that does not answer keeps its last goal."""
        with suppress(Exception), self._lock:
            if not self._closed and self._known:
                self._stand()

    def close(self) -> None:
        """Stop; torque stays on, so that no load falls, and a watchdog armed."""
        with self._lock:  # nobody tells them anything between the two
            self.stop()
            self._closed = True
            with suppress(Exception):
                self._port.close()

    def mark(self, zeros: Vector | None = None) -> None:
        """Their zeros are known."""
        self.lost_position = False

    def find_restarted(self) -> tuple[int, ...]:
        """Return the places of servos that were armed and whose torque is off now."""
        found = list[int]()
        with suppress(Exception), self._lock:
            if self._holding:
                found += [index for index, number in enumerate(self._numbers) if self._has_torque(number) is False]
        return tuple(found)

    @abstractmethod
    def _has_torque(self, number: int) -> bool | None:
        """Return the state of a servo's torque switch; None where it does not answer."""

    @abstractmethod
    def _ask_state(self) -> Reading:
        """Ask all once; who does not answer stays as it was heard last."""

    def _find_jumped(self, reading: Reading) -> list[int]:
        """Motors that hold and have jumped by a turn or so."""
        jumped = np.abs(reading.angles - self._last.angles) > TURNED  # NaN: not heard yet
        return np.flatnonzero(jumped & self._holding).tolist()

    def _join_readings(self, first: Reading, second: Reading, jumped: list[int]) -> Reading:
        """Return the second reading; motors silent or jumped in it keep their first one, unless they jumped in that."""
        silent = second.stamps == self._last.stamps
        silent[self._find_jumped(second)] = True
        silent[jumped] = False
        names = ("angles", "currents", "temperatures", "volts", "stamps")
        joined = {name: np.where(silent, getattr(first, name), getattr(second, name)) for name in names}
        faults = zip(first.faults, second.faults, silent.tolist(), strict=True)
        return Reading(**joined, faults=tuple(one if kept else other for one, other, kept in faults))

    def _keep_reading(self, reading: Reading) -> Reading:
        """Keep a reading as the last; a motor that holds and has jumped by a turn or so is at fault from then on.

        A servo that is switched on counts from within one turn, whatever it had counted before.
        """
        faults = list(reading.faults)
        for index in self._find_jumped(reading):
            faults[index], self.lost_position = ANEW, True
        self._before, self._last = self._last, replace(reading, faults=tuple(faults))
        return self._last

    def _stand(self, *, all_heard: bool = False) -> None:
        """Goals where each was heard first, told at once and again: questions, answers and goals may be lost."""
        before, goals, heard = self._clock(), np.full(len(self._numbers), np.nan), list[int]()
        for attempt in range(3):
            reading = self.read()
            goals = np.where(np.isnan(goals) & (reading.stamps >= before), reading.angles, goals)
            heard = np.flatnonzero(~np.isnan(goals)).tolist()
            if heard:
                self._goals = np.where(np.isnan(goals), self._goals, goals)
                self._hold({self._numbers[index]: float(goals[index]) for index in heard})
            if attempt and len(heard) == len(goals):
                return
        if all_heard and len(heard) < len(goals):
            lost = next(number for index, number in enumerate(self._numbers) if index not in heard)
            raise self._silent(lost)

    @abstractmethod
    def _hold(self, angles: dict[int, float]) -> None:
        """Tell servos, by their numbers, to stand at angles [rad]; none answers."""

    def _find_stops(self) -> Vector:
        """Angles where they stand soonest: so far on their way to the last goal as they turn since, and brake [rad].

        One that hardly turned between its last two readings is blocked, or at its goal: it stands where it is.
        """
        since = self._clock() - np.minimum(self._last.stamps, self._asked)  # one that is silent delays the stamps
        way = self._speeds * since + self._speeds**2 / (2 * self.braking)
        turned, time = np.abs(self._last.angles - self._before.angles), self._last.stamps - self._before.stamps
        way[(time > 0) & (turned <= BLOCKED * self._speeds * time)] = 0.0
        return self._last.angles + np.clip(np.nan_to_num(self._goals - self._last.angles), -way, way)

    def _silent(self, number: int) -> HydrostatError:
        """Error that says who does not answer."""
        return HydrostatError(
            f"motor {number} does not answer; look at its power, its cable, its number and the baud rate"
        )

    def _send_packet(self, packet: bytes) -> None:
        """Send bytes, and forget answers that came too late for what was asked before."""
        try:
            if waiting := getattr(self._port, "in_waiting", 0):
                self._port.read(waiting)
            self._reader.clear()
            self._port.write(packet)
        except (OSError, ValueError, TypeError) as error:
            raise HydrostatError(f"the line to the motors is gone ({error}); plug it in and begin again") from None

    def _receive(self, count: int, wanted: Callable[[Packet], bool]) -> list[Packet]:
        """So many answers that are wanted, or fewer after the time, by the clock that only runs forward."""
        until, found = self._clock() + self._answer, list[Packet]()
        left = self._answer
        while len(found) < count and left > 0:
            self._port.timeout = max(left := until - self._clock(), 0.0)  # 0: a late computer reads what has come
            try:
                data = self._port.read(1) + self._port.read(getattr(self._port, "in_waiting", 0))
            except (OSError, ValueError, TypeError) as error:
                raise HydrostatError(f"the line to the motors is gone ({error}); plug it in and begin again") from None
            found += [packet for packet in self._reader.feed(data) if wanted(packet)]
        return found
