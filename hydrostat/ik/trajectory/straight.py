"""`StraightCourse`: contractions through many poses of a leg, at the pace of a leg from rest to rest."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik.trajectory.course import Course, Keys, Peaks, Samples
from hydrostat.ik.trajectory.pace import Pace


@dataclass(frozen=True, kw_only=True, eq=False)
class StraightCourse:
    """Markers along straight lines, and at rest in each keyframe: a line that ends in a corner cannot go through it.

    In a leg the contractions are a course c(s) through the knots of that leg,
    and s = 10 u^3 - 15 u^4 + 6 u^5 with u = (t - t_0) / T. So da/dt = c' s' and d2a/dt2 = c'' s'^2 + c' s''.
    """

    times: Vector  # of the keyframes, from 0 [s]
    legs: tuple[Course, ...]  # course of each leg, of length 1

    @classmethod
    def earliest(cls, knots: Sequence[Keys], lengths: Vector, pace: Pace, *, least: float) -> Self:
        """The earliest one through the knots of each leg [m], of given lengths [s] (NaN where free), within limits."""
        legs = tuple(_leg(keys) for keys in knots)
        soonest = np.array([float(pace.share(*_peaks(leg))[0]) for leg in legs])
        # Between the places that are looked at a leg may be faster by a hair.
        free = np.maximum(_ROOM * soonest, least)
        times = np.concatenate([[0.0], np.cumsum(np.where(np.isnan(lengths), free, lengths))])
        return cls(times=times, legs=legs)

    @property
    def seconds(self) -> float:
        """How long it takes [s]."""
        return float(self.times[-1])

    def at(self, times: Vector) -> tuple[Samples, Samples, Samples]:
        """Contractions [m], speeds [m/s] and accelerations [m/s^2] at times from 0 to the last keyframe [s]."""
        which = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.legs) - 1)
        shape = (len(times), self.legs[0].keys.shape[1])
        values, speeds, accelerations = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        for index, leg in enumerate(self.legs):
            own = which == index
            length = self.times[index + 1] - self.times[index]
            found = _along(leg, (times[own] - self.times[index]) / length)
            values[own], speeds[own], accelerations[own] = found[0], found[1] / length, found[2] / length**2
        return values, speeds, accelerations

    def peaks(self) -> tuple[Peaks, Peaks]:
        """The largest speed [m/s] and acceleration [m/s^2] of each winch in each leg, at many places."""
        lengths = np.diff(self.times)[:, None]
        found = [_peaks(leg) for leg in self.legs]
        fastest, hardest = np.concatenate([one for one, _ in found]), np.concatenate([two for _, two in found])
        return fastest / lengths, hardest / lengths**2


def _leg(keys: Keys) -> Course:
    """Through knots; at its ends as steep as the first and last step.

    Where a winch must go far for little, the way is stretched: shares grow as the largest change of a contraction.
    """
    steps = np.abs(np.diff(keys, axis=0)).max(axis=1, initial=0.0)
    steps = steps + _LEAST * steps.sum() if steps.any() else np.ones(len(steps))
    times = np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
    course = Course.smooth(times, keys)
    begins, ends = course.begins.copy(), course.ends.copy()
    slopes = np.diff(keys, axis=0) / np.diff(times)[:, None]
    begins[0], ends[-1] = slopes[0], slopes[-1]
    return Course(times=times, keys=keys, begins=begins, ends=ends)


def _along(leg: Course, shares: Vector) -> tuple[Samples, Samples, Samples]:
    """Contractions of a leg at shares of its time, and their derivatives by that."""
    u = shares[:, None]
    s, rate, rise = u**3 * (10 - 15 * u + 6 * u**2), 30 * u**2 * (1 - u) ** 2, 60 * u * (1 - u) * (1 - 2 * u)
    values, slopes, bends = leg.at(s[:, 0])
    return values, slopes * rate, bends * rate**2 + slopes * rise


def _peaks(leg: Course) -> tuple[Peaks, Peaks]:
    _, speeds, accelerations = _along(leg, np.linspace(0.0, 1.0, _PLACES * len(leg.keys)))
    return np.abs(speeds).max(axis=0, keepdims=True), np.abs(accelerations).max(axis=0, keepdims=True)


_LEAST = 0.01  # a step of the way has at least this share of it
_PLACES = 400  # places for each knot where speed and acceleration are looked at
_ROOM = 1.0005  # a leg takes so many times as long as the limits ask at these places
