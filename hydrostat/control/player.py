"""`Player`: the playhead, and how it runs contractions in time on motors, in real time."""

import time
from collections.abc import Callable
from math import floor, inf, isfinite

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.marker_feedback import MarkerFeedback
from hydrostat.control.motors import Motors
from hydrostat.errors import HydrostatError, InputError
from hydrostat.simulation import ContractionProfile

SPEEDS = (0.1, 4.0)  # slowest and fastest, as times the timeline's own
TICK = 1 / 60  # motors that play are told and read once in this time [s]
ARRIVAL_TIMEOUT = 2.0  # extra time for motors to arrive, beyond the time at their largest speed [s]


class Player:
    """Playhead that follows a clock: slow callers skip frames, so playback is never late."""

    def __init__(self) -> None:
        self.time = 0.0  # of the playhead [s]
        self.playing = False  # whether it runs
        self.rounds = inf  # how often it runs from start to end before it stops; infinite: until it is stopped
        self.done = 0  # how often it has come to the end since it was last let run
        self.speed = 1.0  # seconds of the timeline in a second
        self._seen: float | None = None

    @property
    def loop(self) -> bool:
        """True if it repeats until it is stopped."""
        return self.rounds == inf

    def play(self, seconds: float) -> None:
        """Play a timeline of this duration [s], from the start if the playhead is at its end."""
        if self.time >= seconds - 1e-9:
            self.time = 0.0
        self.playing, self.done, self._seen = True, 0, None

    def stop(self) -> None:
        """Pause."""
        self.playing, self._seen = False, None

    def set_speed(self, speed: float) -> None:
        """Set the playback speed (InputError: too slow or too fast)."""
        if not (isfinite(speed) and SPEEDS[0] <= speed <= SPEEDS[1]):
            raise InputError(f"the speed must be from {SPEEDS[0]:g} to {SPEEDS[1]:g} times, not {speed:g}")
        self.speed = speed

    def advance(self, now: float, seconds: float) -> None:
        """Advance by a clock [s], from its first call; repeat or stop at the end of the timeline."""
        if not self.playing:
            return
        passed = 0.0 if self._seen is None else max(0.0, now - self._seen)
        self._seen = now
        self.time += self.speed * passed
        if self.time < seconds:
            return
        self.done += floor(self.time / seconds) if seconds > 0 else 1
        if self.done >= self.rounds:
            self.time = seconds
            self.stop()
        else:
            self.time = self.time % seconds if seconds > 0 else 0.0

    def run(
        self,
        motors: Motors,
        profile: ContractionProfile,
        *,
        feedback: MarkerFeedback | None = None,
        tell: Callable[[], None] = lambda: None,
        clock: Callable[[], float] | None = None,
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        """Play contractions on motors in real time; they hold at the end, on any error and on interruption.

        First the motors move to the position of the playhead, in a profile from 0 s to its last time. Changes to the
        player take effect immediately: its speed, its number of repetitions, a stop. `tell` is called after each
        command. `clock` is monotonic [s], that of the motors if left out. `wait` sleeps for a duration [s]. With
        feedback, markers in sight correct the commands; while feedback waits for a marker, the playhead pauses.

        Raises:
            InputError: a contraction is outside the limits of its winch.
            HydrostatError: an error of the link, or motors that do not reach their positions.
        """
        seconds, now = float(profile.times[-1]), clock or motors.clock

        def drive(contractions: Vector) -> None:
            if beyond := motors.ask(contractions):
                raise InputError(beyond)
            motors.drive(now())
            tell()

        def arrive(contractions: Vector) -> None:
            latest = (
                now() + float(np.abs(contractions - motors.places).max(initial=0.0)) / motors.fastest + ARRIVAL_TIMEOUT
            )
            drive(contractions)
            while motors.is_moving:
                if now() > latest:
                    raise HydrostatError(f"{_slowest(motors)}; see what holds it")
                wait(TICK)
                drive(contractions)

        def next_command() -> Vector:
            planned = profile.at(self.time)
            return planned if feedback is None else feedback.correct(planned, self.time, now())

        try:
            self.play(seconds)
            arrive(profile.at(self.time))
            while self.playing:
                if feedback is not None and feedback.is_waiting:
                    self._seen = now()
                self.advance(now(), seconds)
                drive(next_command())
                wait(TICK)
            has_ended = self.time >= seconds  # not where it was stopped on the way
            until = now() + (feedback.settle if feedback is not None and has_ended else 0.0)
            while now() < until:
                drive(next_command())
                wait(TICK)
            arrive(next_command())
        finally:
            self.stop()
            motors.hold()


def _slowest(motors: Motors) -> str:
    """The motor that is farthest from where it should be, in words."""
    index = int(np.abs(motors.command - motors.places).argmax())
    there, wanted = 1e3 * motors.places[index], 1e3 * motors.command[index]
    unit = motors.units[index]
    return f"{motors.names[index]} stays at {there:.1f} {unit} and should be at {wanted:.1f} {unit}"
