"""`BusLink`: motors on a bus as a link in contractions, which turn only when armed, and stand when in doubt."""

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, MotorFacts, Reading, steady
from hydrostat.control.calibration import Calibration
from hydrostat.control.guard import TensionGuard, not_judged
from hydrostat.control.link import Link
from hydrostat.control.restart_motors import fault_words
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Winch

DEADLINE = 0.2
"""Told nothing for so long [s], motors are stopped by the watch on this side; their own watchdogs stop them sooner."""
MAX_READING_GAP = 0.08
"""Time between two readings that counts at most while a motor does not follow [s]: beyond, this computer is late."""
MAX_LEAD_TIME = 0.12
"""A goal is never further ahead of a motor than it turns in this time [s]: a dead host leaves it no further."""
MAX_READING_AGE = 0.2
"""A reading so old is a fault [s]."""
MAX_SPEED = 0.5
"""No limit of speed is greater [m/s]."""
RANGE_TOLERANCE = 5e-4
"""Motors may be so far beyond the limits of their winch, by what the motor rounds and the cable gives [m]."""
MAX_TEMPERATURE = 75.0
"""Warmest that a motor may be [degree C]."""
STALL_DISTANCE, STALL_TIME = 1e-3, 0.5
"""A motor that is further from its goal than this [m] and stands for so long [s] does not follow."""


class LinkState(StrEnum):
    """State of a link, from closed to armed."""

    CLOSED = "closed"
    IDENTIFIED = "identified: every motor answered"
    CALIBRATED = "calibrated: all zeros are known"
    ARMED = "armed: motors follow commands"
    HOLD = "hold: motors locked, re-arm to move"
    STOPPED = "stopped"
    FAULT = "fault"


@dataclass(frozen=True, kw_only=True)
class LinkLimits:
    """Speed and acceleration limits of the motors.

    Attributes:
        speed: maximum cable speed [m/s].
        rise: maximum cable acceleration [m/s^2].
    """

    speed: float = 0.06
    rise: float = 1.0

    def __post_init__(self) -> None:
        for name, value, most in (("speed", self.speed, MAX_SPEED), ("rise", self.rise, 100.0)):
            if not 0 < value <= most:
                raise InputError(f"limits of motors: {name} must be above 0 and at most {most:g}, not {value:g}")


class BusLink(Link):
    """Link to real motors, with limits, deadline, guard, state and log; every motion goes through it.

    `identify` reads every motor, and only `arm` lets them turn. Contractions are clipped to the limits of the winches,
    speeds ramp up to their limits, and goals stay close to the present positions. A silent, hot or faulty motor, a
    missed deadline or a fault from the guard stops all motors; `why` gives the reason.

    Attributes:
        state: state of the link.
        facts: data of the motors, after `identify`.
        why: reason of the last stop, as text.
        reading: latest reading.
        limits: speed limits.
        near: position tolerance for motor steps and friction [m].
        guard: tension guard, if any.
    """

    near = 3e-4

    def __init__(
        self,
        bus: Bus,
        winches: Sequence[Winch],
        calibration: Calibration,
        *,
        limits: LinkLimits | None = None,
        guard: TensionGuard | None = None,
        log: Callable[[str], None] = lambda _: None,
        clock: Callable[[], float] | None = None,
    ) -> None:
        """A closed link (InputError: the calibration is of other winches)."""
        if [spool.winch for spool in calibration.motors] != [winch.name for winch in winches]:
            raise InputError("the calibration is of other winches than these")
        self.state, self.why = LinkState.CLOSED, ""
        self.facts: tuple[MotorFacts, ...] = ()
        self.reading: Reading | None = None
        self._bus, self._calibration, self.guard, self._log = bus, calibration, guard, log
        self._clock = clock or bus.clock
        self.limits, self._names = limits or LinkLimits(), calibration.labels
        self._low = np.array([-winch.release for winch in winches], dtype=float)
        self._high = np.array([winch.travel for winch in winches], dtype=float)
        self._places = self._goal = np.zeros(len(winches))
        self._speed, self._sent = 0.0, -np.inf
        self._written = -np.inf  # when the writing of the last goals began [s]
        self._mark, self._waits = np.zeros(len(winches)), np.zeros(len(winches))  # a place [m], time spent there [s]
        self._judged = -np.inf  # time of the last reading while armed [s]
        self._began = self._clock()
        self._lock, self._over = threading.RLock(), threading.Event()
        self._watch: threading.Thread | None = None
        self._stops = 0  # how often it was told to stop

    @property
    def currents(self) -> Vector | None:
        """Latest motor currents, positive when reeling in [A]; None before the first reading."""
        return None if self.reading is None else self._taking(self.reading)

    def identify(self) -> tuple[MotorFacts, ...]:
        """Identify every motor (HydrostatError: a silent motor, or another model)."""
        with self._lock:
            self.facts = ()
            with self._stopping():
                self.facts = self._bus.identify()
            done = self._calibration.is_complete and not self._bus.lost_position
            self._to(LinkState.CALIBRATED if done else LinkState.IDENTIFIED)
            for fact, name in zip(self.facts, self._names, strict=True):
                stops = "stops by itself" if fact.watchdog else "does not stop by itself: its goals stay close ahead"
                self._say(f"{name}: motor {fact.number}, {fact.model}, firmware {fact.firmware}, {stops}")
            if words := not_judged(np.array([fact.constant for fact in self.facts]), self._names):
                self._say(words)
            return self.facts

    def arm(self) -> None:
        """Arm the motors (HydrostatError: not calibrated, outside the limits, or no answer from a motor)."""
        with self._lock:
            stops = self._stops
            self._must_be_known()
            with self._stopping():
                self.reading = self._bus.read()
                self._judge(self._clock(), armed=False)
                self._bus.arm(np.array([spool.current for spool in self._calibration.motors]))
            self._goal, self._speed, self._sent, self.why = self._places.copy(), 0.0, self._clock(), ""
            self._waits, self._judged = np.zeros_like(self._waits), self._sent
            if self.guard is not None:
                self.guard.begin()
            self._to(LinkState.ARMED)
            # A clock of its own, as emulated motors and tests have, runs on when it is looked at: a watch would make
            # it run while this program waits for its turn, and a busy computer late. There, `send` keeps the deadline.
            if self._clock is steady:
                self.watch()
            if self._stops != stops:  # by another thread, which did not wait for this one
                raise self._stop_with_error(LinkState.STOPPED, "stopped while they were armed")

    def send(self, contractions: Vector, now: float, *, speed: float) -> None:
        """Command contractions [m], within limits."""
        with self._lock:
            self._must_be_armed()
            if np.shape(contractions) != self._low.shape or not np.isfinite(contractions).all() or not speed >= 0:
                words = f"told {len(self._names)} finite contractions at a speed, not {contractions} at {speed:g} m/s"
                raise self._stop_with_error(LinkState.HOLD, f"motors must be {words}; re-arm them")
            since = self._clock() - self._sent
            if since > DEADLINE:
                raise self._stop_with_error(LinkState.HOLD, _late(since))
            self._goal = np.clip(contractions, self._low, self._high)
            self._speed = min(speed, self.limits.speed, self._speed + self.limits.rise * max(since, 1e-3))
            ahead = self._speed * MAX_LEAD_TIME
            near = np.clip(self._goal, self._places - ahead, self._places + ahead)
            if (np.abs(near - self._goal) == 0).all() and np.abs(self._goal - self._places).max(initial=0.0) < 1e-4:
                self._speed = 0.0
            rates = max(self._speed, 1e-3) / self._calibration.radii(near)
            with self._stopping():
                self._write(self._calibration.angles(near), rates)
            self._sent = self._clock()
            if self.state is not LinkState.ARMED:  # stopped by another thread, maybe before this was written
                self._bus.stop()
                self._must_be_armed()

    def read(self, now: float) -> Vector:
        """Return the contractions of the latest reading [m]."""
        with self._lock:
            if self.state is LinkState.FAULT:
                raise HydrostatError(self.why)
            with self._stopping():
                self.reading = self._bus.read()
                self._judge(self._clock(), armed=self.state is LinkState.ARMED)
            return self._places.copy()

    def stop(self) -> None:
        """Stop the motors. A thread that is about to command or arm them detects the stop and stops them, too."""
        self._stops += 1
        if self.state is LinkState.ARMED:
            self._stop_with_error(LinkState.STOPPED, "stopped")
        else:
            with suppress(Exception):
                self._bus.stop()

    def close(self) -> None:
        """Stop the motors and close the link."""
        self._over.set()
        self.stop()
        with suppress(Exception):
            self._bus.close()
        self._to(LinkState.CLOSED)

    def check_deadline(self) -> None:
        """Stop motors that got no command for too long; `watch` calls this continuously."""
        if self.state is LinkState.ARMED and self._clock() - self._sent > DEADLINE:
            with self._lock:
                if self.state is LinkState.ARMED and (since := self._clock() - self._sent) > DEADLINE:
                    self._stop_with_error(LinkState.HOLD, _late(since))

    def watch(self) -> None:
        """Monitor the deadline in a separate thread, independent of other work of the program; starts with arming."""
        if self._watch is None or not self._watch.is_alive():
            self._watch = threading.Thread(target=self._watching, name="deadline of the motors", daemon=True)
            self._watch.start()

    def _watching(self) -> None:
        while not self._over.wait(0.02):
            with suppress(Exception):
                self.check_deadline()

    def _judge(self, now: float, *, armed: bool) -> None:
        """Raise what is wrong with the newest reading; else take it as where the motors are."""
        reading = self.reading
        assert reading is not None
        ages = now - reading.stamps
        if (worst := float(ages.max(initial=0.0))) > MAX_READING_AGE:
            name = self._names[int(ages.argmax())]
            told = f"for {worst:.2f} s" if np.isfinite(worst) else "at all"
            raise HydrostatError(f"the motor of {name} has not answered {told}; look at its power and cable")
        for index, fault in enumerate(reading.faults):
            if fault:
                raise HydrostatError(fault_words(self._names[index], reading, index))
        if (hot := float(np.nanmax(np.append(reading.temperatures, -np.inf)))) > MAX_TEMPERATURE:
            name = self._names[int(np.nanargmax(reading.temperatures))]
            raise HydrostatError(
                f"the motor of {name} is {hot:.0f} degrees warm, {MAX_TEMPERATURE:g} at most; let it cool"
            )
        if not self._calibration.is_complete:
            return
        self._places = self._calibration.contractions(reading.angles)
        beyond = np.maximum(self._low - self._places, self._places - self._high)
        if not (beyond <= RANGE_TOLERANCE).all():
            index = int(np.nan_to_num(beyond, nan=np.inf).argmax())
            raise HydrostatError(
                f"{self._names[index]} stands at {1e3 * self._places[index]:.1f} mm, beyond its limits of "
                f"{1e3 * self._low[index]:.1f} to {1e3 * self._high[index]:.1f} mm; calibrate it again"
            )
        if not armed:
            return
        words = self._judge_following(now)
        if not words and self.guard is not None:
            radii = self._calibration.radii(self._places)
            words = self.guard.fault(self._places, self._taking(reading), radii, now)
        if words:
            self._bus.halt()  # first: to ask takes longer where one is silent
            lost = next((self._names[index] for index in self._bus.find_restarted()), None)
            restarted = f"the motor of {lost} lost power and restarted: its torque is off. Check its plug and cable"
            raise HydrostatError(words if lost is None else restarted)

    def _judge_following(self, now: float) -> str:
        """Say that a motor stands away from its goal, such as a stuck one; "" for none.

        Time in which this computer was late does not count, as motors then stand at goals close ahead.
        """
        follows = np.abs(self._goal - self._places) < STALL_DISTANCE
        follows |= np.abs(self._places - self._mark) > 1e-4
        self._mark = np.where(follows, self._places, self._mark)
        self._waits = np.where(follows, 0.0, self._waits + min(now - self._judged, MAX_READING_GAP))
        self._judged = now
        if self._waits.max(initial=0.0) <= STALL_TIME:
            return ""
        index = int(self._waits.argmax())
        return (
            f"{self._names[index]} does not follow: it stands at {1e3 * self._places[index]:.1f} mm and was told "
            f"{1e3 * self._goal[index]:.1f} mm; its cable is held, it has lost power, or its current is too low"
        )

    def _taking(self, reading: Reading) -> Vector:
        """Currents, positive as cable is taken in [A]."""
        return reading.currents * [spool.turns for spool in self._calibration.motors]

    def _write(self, angles: Vector, speeds: Vector) -> None:
        """Write goals, and again where watchdogs may have fired before: those refuse goals until they are reset.

        Time counts until the goals are written, as a late computer may be held up on the way.
        """
        before, self._written = self._written, self._clock()
        self._bus.write(angles, speeds)
        if self._clock() - before > self._bus.silence:
            with suppress(HydrostatError):  # a silent motor is named by the age of its reading
                self._bus.restart_watchdog()
            self._written = self._clock()
            self._bus.write(angles, speeds)

    def _must_be_known(self) -> None:
        """Raise what is missing before motors may be armed, whatever went wrong since."""
        needed = ""
        if self._over.is_set() or not self.facts:
            needed = "identify the motors"
        elif self._bus.lost_position:
            needed = "calibrate them again, as a motor or its board was switched off or reset since (docs/motors.md)"
        elif not self._calibration.is_complete:
            needed = "calibrate them"
        if needed:
            raise HydrostatError(f"motors cannot be armed: first {needed}")

    def _must_be_armed(self) -> None:
        if self.state is not LinkState.ARMED:
            raise HydrostatError(f"the motors do not turn: {self.why or self.state}")

    def _fault(self, why: str) -> HydrostatError:
        return self._stop_with_error(LinkState.FAULT, why)

    def _stop_with_error(self, state: LinkState, why: str) -> HydrostatError:
        """Stop the motors, go to a state, and give the error that says why.

        The state is another one before they are told, so that whoever tells them meanwhile sees it.
        """
        self.why, before, self.state = why, self.state, state
        with suppress(Exception):
            self._bus.stop()
        if state is not before:
            self._tell_state()
        return HydrostatError(why)

    @contextmanager
    def _stopping(self) -> Iterator[None]:
        """Stop the motors on whatever goes wrong within, with its words."""
        try:
            yield
        except HydrostatError as error:
            raise self._fault(str(error)) from None
        except BaseException as error:
            self._fault(f"{type(error).__name__} {error}".strip())
            raise

    def _to(self, state: LinkState) -> None:
        if state is not self.state:
            self.state = state
            self._tell_state()

    def _tell_state(self) -> None:
        told = self.state in (LinkState.ARMED, LinkState.CLOSED) or self.why == self.state
        self._say(f"{self.state}{f': {self.why}' if self.why and not told else ''}")

    def _say(self, words: str) -> None:
        with suppress(Exception):
            self._log(f"{self._bus.kind}: {self._clock() - self._began:.3f} s: {words}")


def _late(since: float) -> str:
    return f"this computer is late: no command for {since:.2f} s; re-arm the motors"
