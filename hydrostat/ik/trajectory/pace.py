"""`Pace`: how fast winches may turn, and the earliest course that keeps to it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik.limits import limit_by_winch
from hydrostat.ik.trajectory.course import ACCELERATION_OF_REST, SPEED_OF_REST, Course, Keys, Peaks
from hydrostat.robot import Robot

ByWinch = float | Mapping[str, float]  # one number for all winches, or numbers by name


@dataclass(frozen=True, kw_only=True, eq=False)
class Pace:
    """The most that each winch may do."""

    speed: Vector  # of its contraction [m/s]; infinite without a limit
    acceleration: Vector  # of its contraction [m/s^2]; infinite without a limit

    @classmethod
    def of(cls, robot: Robot, speed: ByWinch | None, acceleration: ByWinch | None) -> Self:
        """Limits on the winches of a robot (InputError: a winch that it does not have, or a limit not above 0)."""
        return cls(
            speed=limit_by_winch(robot, speed, "speed", "m/s"),
            acceleration=limit_by_winch(robot, acceleration, "acceleration", "m/s^2"),
        )

    def share(self, speeds: Peaks, accelerations: Peaks) -> Vector:
        """What each leg uses of the limits: it would keep to them if it took so many times as long."""
        used = np.maximum(speeds / self.speed, np.sqrt(accelerations / self.acceleration))
        return used.max(axis=1, initial=0.0)

    def rest_to_rest(self, keys: Keys) -> Vector:
        """The least time of each leg, were it to begin and end at rest [s]."""
        ways = np.abs(np.diff(keys, axis=0))
        return self.share(SPEED_OF_REST * ways, ACCELERATION_OF_REST * ways)


def earliest(keys: Keys, lengths: Vector, pace: Pace, *, least: float) -> Course:
    """The smooth course that is soon at its end: keys [m] are passed without a stop where that saves time.

    Lengths [s], NaN where free, and passing speeds depend on each other. From stops at all keys on, each leg is
    lengthened or shortened by what it uses of the limits, to no less than the least [s]; each course on the way is then
    scaled as a whole, so that the limits hold exactly, and the shortest is kept. So it never takes longer than with
    stops at all keys.
    """
    free = np.isnan(lengths)
    lengths = np.where(free, np.maximum(pace.rest_to_rest(keys), least), lengths)
    best = Course.smooth(_times(lengths), keys, passing=False)
    if not free.any():
        return Course.smooth(_times(lengths), keys)
    for _ in range(_ROUNDS):
        course = Course.smooth(_times(lengths), keys)
        used = np.where(free, pace.share(*course.peaks()), 0.0)
        scaled = Course.smooth(_times(np.where(free, np.maximum(used.max() * lengths, least), lengths)), keys)
        if scaled.seconds < best.seconds and pace.share(*scaled.peaks()).max() <= 1 + _HAIR:
            best = scaled
        lengths = np.where(free, np.maximum(lengths * np.sqrt(used), least), lengths)
    return best


def linear(keys: Keys, lengths: Vector, pace: Pace, *, least: float) -> Course:
    """The linear course whose speeds keep to the limits in free legs."""
    soonest = (np.abs(np.diff(keys, axis=0)) / pace.speed).max(axis=1, initial=least)
    return Course.linear(_times(np.where(np.isnan(lengths), soonest, lengths)), keys)


def _times(lengths: Vector) -> Vector:
    return np.concatenate([[0.0], np.cumsum(lengths)])


_ROUNDS = 60

_HAIR = 1e-9  # limits hold to this share of them
