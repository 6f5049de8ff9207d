"""`MarkerFeedback`: contractions corrected by the markers that a camera sees while a robot plays."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.guard import GuardLimits
from hydrostat.control.marker_path import MarkerPath
from hydrostat.errors import HydrostatError
from hydrostat.ik import CORRECTION_DAMPING
from hydrostat.robot import Robot
from hydrostat.units import plural


@dataclass(frozen=True)
class FeedbackRules:
    """Rules of the correction by markers, the same for all robots."""

    gain: float = 3.0
    """Share of the remaining marker error that is taken back in a second, at first [1/s]."""

    bound: float = 0.2
    """Largest correction of a winch, as a share of its travel."""

    max_correction_speed: float = 0.02
    """Largest speed of a correction [m/s]."""

    misread: float = 0.2
    """Distance from the simulated marker, as a share of the body's size, beyond which a marker counts as misread."""

    lost: float = 0.5
    given_up: float = 10.0
    """Time without a marker in sight after which the camera counts as lost, and after which a held robot stops [s]."""

    fade: float = 1.0
    """Time in which a correction fades out when the motors go on without a camera [s]."""

    settle: float = 1.0
    """Time for which the last pose is still corrected [s]."""


RULES = FeedbackRules()


class LostAction(StrEnum):
    """Reaction if the camera sees no marker."""

    HOLD = "hold"
    CONTINUE = "continue"


@dataclass(frozen=True, eq=False)
class MarkerSight:
    """Markers in one frame of a camera.

    Attributes:
        time: time at which the frame arrived, by the clock of the motors [s].
        places: positions of the visible markers, in the frame of the robot [m].
    """

    time: float
    places: Mapping[str, Vector]


@runtime_checkable
class MarkerSource(Protocol):
    """Camera that sees markers."""

    def look(self) -> MarkerSight | None:
        """Return the newest sight at once; None before the first."""
        ...


@dataclass(frozen=True)
class _Past:
    """Correction at an earlier time."""

    now: float
    time: float
    correction: Vector


class MarkerFeedback:
    """Correct contractions so that markers follow the simulated ones (integral control with a known lag).

    Each frame measures the error at the time when it was taken. A damped least-squares step with the exact derivatives
    of the model gives the correction that would have removed this error, and the present correction approaches it.
    Errors do not accumulate over the lag, because the correction of that time is stored. Corrections stay within 20 %
    of the travel of each winch, and commands within its limits. They raise no simulated pull beyond the limit of
    `TensionGuard`, even if motors do not report their torque.

    Attributes:
        is_waiting: True while motors hold because no marker is in sight.
        errors: mean distance of measured from simulated markers in each frame [m].
        open_errors: the same distance without the correction, to first order [m].
    """

    settle = RULES.settle

    def __init__(
        self,
        robot: Robot,
        path: MarkerPath,
        source: MarkerSource,
        *,
        lag: float = 0.1,
        lost: LostAction = LostAction.HOLD,
        log: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Feedback along a path.

        Args:
            robot: robot that plays.
            path: simulated markers of the profile.
            source: camera that sees the markers.
            lag: time from a command until a frame with its effect arrives [s].
            lost: reaction to a camera that sees no marker.
            log: receives a line when markers are lost, found again, or at the bound of the correction.
        """
        self._names = [marker.name for marker in robot.markers]
        self._path, self._source, self._lag, self._lost, self._log = path, source, lag, lost, log
        self._low = np.array([-winch.release for winch in robot.winches])
        self._high = np.array([winch.travel for winch in robot.winches])
        self._bound, self._misread = RULES.bound * self._high, RULES.misread * robot.body.mesh.size
        self._winches = [winch.name for winch in robot.winches]
        self._correction = np.zeros(len(robot.winches))
        self._aim = self._correction
        self._past = deque[_Past]()
        self._seen: float | None = None  # time of the last sight with markers [s]
        self._told: set[str] = set()
        self.is_waiting = self._is_lost = False
        self.errors, self.open_errors = list[float](), list[float]()
        self._began: float | None = None
        self._start: float | None = None

    @property
    def rate(self) -> float:
        """Frames with markers per second; 0 before the second one."""
        seconds = (self._seen or 0.0) - (self._began or 0.0)
        return (len(self.errors) - 1) / seconds if len(self.errors) > 1 and seconds > 0 else 0.0

    def correct(self, contractions: Vector, time: float, now: float) -> Vector:
        """Return the contractions to command [m], within the limits of the winches.

        Args:
            contractions: contractions of the profile [m].
            time: time in the profile [s].
            now: time of a monotonic clock [s].

        Raises:
            HydrostatError: motors held for too long because no marker was in sight.
        """
        self._start = now if self._start is None else self._start
        step = now - self._past[-1].now if self._past else 0.0
        sight = self._source.look()
        if sight is not None and (self._seen is None or sight.time > self._seen):
            self._take(sight)
        self._watch(now)
        if not self.is_waiting:
            self._advance(step)
        self._correction = self._correction * self._allowed_share(time)
        command = np.clip(contractions + self._correction, self._low, self._high)
        self._correction = command - contractions  # no windup at a limit
        self._past.append(_Past(now, time, self._correction))
        while len(self._past) > 2 and self._past[1].now < now - RULES.lost - self._lag:
            self._past.popleft()
        return command

    def _advance(self, step: float) -> None:
        """Move the correction towards its aim; out, if motors go on without a camera."""
        if self._is_lost:
            move = -self._correction * min(step / RULES.fade, 1.0)
        else:
            move = (self._aim - self._correction) * (1.0 - np.exp(-RULES.gain * step))
        move = np.clip(move, -RULES.max_correction_speed * step, RULES.max_correction_speed * step)
        self._correction = np.clip(self._correction + move, -self._bound, self._bound)

    def _allowed_share(self, time: float) -> float:
        """Share of the correction that keeps all simulated pulls within the limits of the guard, to first order."""
        pulls, rates = self._path.pulls_at(time)
        ways, limits = np.where(pulls < 0, -1.0, 1.0), GuardLimits()
        more = ways * (rates @ self._correction)
        room = (limits.times - 1.0) * np.abs(pulls) + limits.more
        shares = np.where(more > room, room / np.maximum(more, room), 1.0)
        worst = int(np.argmin(shares))
        if shares[worst] < 1.0:
            self._tell_once(
                f"warning: the correction of {self._winches[worst]} is bounded by its simulated tension. Fit the model "
                "first: hydrostat identify"
            )
        return float(shares[worst])

    def _take(self, sight: MarkerSight) -> None:
        """Aim at the correction that would have removed the errors of a frame."""
        before = next((past for past in reversed(self._past) if past.now <= sight.time - self._lag), None)
        if before is None:
            return
        places, derivatives = self._path.at(before.time)
        errors, rows = [], []
        for index, name in enumerate(self._names):
            if name in sight.places:
                error = np.asarray(sight.places[name]) - places[index]
                if np.isfinite(error).all() and np.linalg.norm(error) < self._misread:
                    errors.append(error)
                    rows.append(derivatives[index])
        if not errors:
            return
        self._began = sight.time if self._began is None else self._began
        self._seen = sight.time
        error, jacobian = np.array(errors), np.array(rows)
        flat = jacobian.reshape(-1, jacobian.shape[2])
        damping = CORRECTION_DAMPING**2 * len(errors) * np.eye(flat.shape[1])
        aim = before.correction - np.linalg.solve(flat.T @ flat + damping, flat.T @ error.ravel())
        self._aim = np.clip(aim, -self._bound, self._bound)
        self.errors.append(float(np.linalg.norm(error, axis=1).mean()))
        opened = error - jacobian @ before.correction
        self.open_errors.append(float(np.linalg.norm(opened, axis=1).mean()))
        for winch in np.flatnonzero(np.abs(aim) > self._bound).tolist():
            self._tell_once(
                f"warning: the correction of {self._winches[winch]} is at its bound of "
                f"{1e3 * self._bound[winch]:.0f} mm. Fit the model first: hydrostat identify"
            )

    def _watch(self, now: float) -> None:
        """Notice a camera that sees nothing, or sees again."""
        seen = self._start if self._seen is None else self._seen
        since = 0.0 if seen is None else now - seen
        if since > RULES.lost and not self._is_lost:
            self._is_lost, self.is_waiting = True, self._lost is LostAction.HOLD
            does = "motors hold until one is" if self.is_waiting else "going on without correction"
            self._log(f"warning: no marker in sight for {since:.1f} s; {does}")
        elif since <= RULES.lost and self._is_lost:
            self._is_lost = self.is_waiting = False
            self._log("note: markers in sight again; correcting")
        if self.is_waiting and since > RULES.given_up:
            raise HydrostatError(
                f"no marker in sight for {since:.0f} s. Check camera, light and tags, then play again."
            )

    def _tell_once(self, text: str) -> None:
        if text not in self._told:
            self._told.add(text)
            self._log(text)

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<MarkerFeedback of {plural(len(self._names), 'marker')}>"
