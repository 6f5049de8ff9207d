"""`TimedPath`: contractions in time from key to key; `StraightCourse`: through many poses of a leg."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.ik.limits import limit_by_control
from hydrostat.robot import Robot

Keys = Float[np.ndarray, "keys winches"]
Samples = Float[np.ndarray, "samples winches"]
Peaks = Float[np.ndarray, "legs winches"]


@dataclass(frozen=True, kw_only=True, eq=False)
class TimedPath:
    """Quintic in each leg, with the speeds given at its ends and no acceleration there.

    With T the length of a leg, u = (t - t_0) / T, D the way and p, q the speeds at both ends times T:

        a(u) = a_0 + p u + (10 D - 6 p - 4 q) u^3 + (8 p + 7 q - 15 D) u^4 + (6 D - 3 p - 3 q) u^5

    It is C2 where the speeds at the end of a leg are those at the beginning of the next, monotone where p and q lie
    between 0 and 2 D, at rest at both ends the polynomial of least jerk (Flash 1985), and a line where p = q = D.
    """

    times: Vector  # times of the keyframes, rising from 0 [s]
    keys: Keys  # contractions at these times [m]
    begins: Peaks  # speeds at the start of each leg [m/s]
    ends: Peaks  # speeds at the end of each leg [m/s]

    @classmethod
    def linear(cls, times: Vector, keys: Keys) -> Self:
        """Along lines, at the same speed in all of a leg (R58, R72)."""
        slopes = _slopes(times, keys)
        return cls(times=times, keys=keys, begins=slopes, ends=slopes)

    @classmethod
    def smooth(cls, times: Vector, keys: Keys, *, passing: bool = True) -> Self:
        """C2 through keys [m] at times [s], at rest at both ends; no winch goes beyond its keys.

        One that turns around stops for that; one that goes on passes its keys without a stop, unless told not to.
        """
        speeds = np.zeros_like(keys)
        if passing and len(times) > 2:
            speeds[1:-1] = passing_speeds(times, keys)
        return cls(times=times, keys=keys, begins=speeds[:-1], ends=speeds[1:])

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return float(self.times[-1])

    def at(self, times: Vector) -> tuple[Samples, Samples, Samples]:
        """Contractions [m], speeds [m/s] and accelerations [m/s^2] at times from 0 to the last key [s]."""
        leg = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2)
        length = np.diff(self.times)[leg][:, None]
        u = (times - self.times[leg])[:, None] / length
        begin, one, three, four, five = (part[leg] for part in self._coefficients())
        values = begin + u * (one + u**2 * (three + u * (four + u * five)))
        speeds = (one + u**2 * (3 * three + u * (4 * four + u * 5 * five))) / length
        return values, speeds, u * (6 * three + u * (12 * four + u * 20 * five)) / length**2

    def peaks(self) -> tuple[Peaks, Peaks]:
        """Largest speed [m/s] and acceleration [m/s^2] of each winch in each leg, in closed form.

        A leg accelerates as u (1 - u) (r + s u), which is 0 at both ends and at one more place, where the speed is
        extreme; where the jerk is 0 the acceleration is.
        """
        _, one, three, four, five = self._coefficients()
        length = np.diff(self.times)[:, None]
        turn = _inside(-6 * three, -20 * five)
        speed = np.abs(one + turn**2 * (3 * three + turn * (4 * four + turn * 5 * five)))
        fastest = np.max([np.abs(self.begins), np.abs(self.ends), speed / length], axis=0)
        root = np.sqrt(np.maximum((24 * four) ** 2 - 4 * 60 * five * 6 * three, 0.0))
        hardest = np.zeros_like(one)
        for sign in (-1.0, 1.0):
            # The stable form of the roots of 60 e u^2 + 24 d u + 6 c: no difference of near equals.
            half = -0.5 * (24 * four + sign * root)
            for place in (_inside(half, 60 * five), _inside(6 * three, half)):
                hardest = np.maximum(hardest, np.abs(place * (6 * three + place * (12 * four + place * 20 * five))))
        return fastest, hardest / length**2

    def _coefficients(self) -> tuple[Peaks, Peaks, Peaks, Peaks, Peaks]:
        length = np.diff(self.times)[:, None]
        way, p, q = np.diff(self.keys, axis=0), self.begins * length, self.ends * length
        return self.keys[:-1], p, 10 * way - 6 * p - 4 * q, 8 * p + 7 * q - 15 * way, 6 * way - 3 * p - 3 * q


ACCELERATION_OF_REST = 10 / np.sqrt(3)  # largest acceleration of a leg from rest to rest, in ways / its length^2


def passing_speeds(times: Vector, keys: Keys) -> Float[np.ndarray, "inner winches"]:
    """Speeds at the inner keys [m/s]: 0 where a winch turns around, else between those before and after.

    The harmonic mean, weighted by the lengths of the legs (Fritsch 1984), and never more than twice the slower one, so
    that the course stays monotone.
    """
    slopes, lengths = _slopes(times, keys), np.diff(times)[:, None]
    before, after = slopes[:-1], slopes[1:]
    weights = 2 * lengths[1:] + lengths[:-1], lengths[1:] + 2 * lengths[:-1]
    on = before * after > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (weights[0] + weights[1]) / (weights[0] / before + weights[1] / after)
    slower = np.minimum(np.abs(before), np.abs(after))
    return np.where(on, np.sign(before) * np.minimum(np.abs(mean), 2 * slower), 0.0)


def _slopes(times: Vector, keys: Keys) -> Peaks:
    return np.diff(keys, axis=0) / np.diff(times)[:, None]


def _inside(above: Peaks, below: Peaks) -> Peaks:
    """Quotient if it lies between 0 and 1, else 0."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = above / below
    return np.where((found > 0) & (found < 1), found, 0.0)


ByWinch = float | Mapping[str, float]  # one number for all winches, or numbers by name

DRIVE_SPEEDS = {"rad": 1.0, "m": 0.05, "share": 1.0}
"""Usual largest speed of a drive, by its unit [1/s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionLimits:
    """Speed and acceleration limits of the winches, then of the drives in rad, m or shares."""

    speed: Vector  # maximum speed of each contraction [m/s]; infinite without a limit
    acceleration: Vector  # maximum acceleration of each contraction [m/s^2]; infinite without a limit

    @classmethod
    def of(cls, robot: Robot, speed: ByWinch | None, acceleration: ByWinch | None) -> Self:
        """Limits on the controls of a robot (InputError: a name that it does not have, or a limit not above 0)."""
        usual = np.array([DRIVE_SPEEDS[drive.unit] for drive in robot.drives])
        per_second = np.inf if acceleration is None else 4.0
        return cls(
            speed=limit_by_control(robot, speed, usual, "speed", "m/s"),
            acceleration=limit_by_control(robot, acceleration, per_second * usual, "acceleration", "m/s^2"),
        )

    def share(self, speeds: Peaks, accelerations: Peaks) -> Vector:
        """Share of the limits that each leg uses: it keeps to them if its duration is multiplied by this factor."""
        used = np.maximum(speeds / self.speed, np.sqrt(accelerations / self.acceleration))
        return used.max(axis=1, initial=0.0)

    def rest_to_rest(self, keys: Keys) -> Vector:
        """Least time of each leg, were it to begin and end at rest [s]."""
        ways = np.abs(np.diff(keys, axis=0))
        speed_of_rest = 15 / 8  # largest speed of a leg from rest to rest, in ways for each length of the leg
        return self.share(speed_of_rest * ways, ACCELERATION_OF_REST * ways)


def earliest(keys: Keys, lengths: Vector, pace: MotionLimits, *, least: float) -> TimedPath:
    """Smooth course that is soon at its end: keys [m] are passed without a stop where that saves time.

    Lengths [s], NaN where free, and passing speeds depend on each other. From stops at all keys on, each leg is
    lengthened or shortened by what it uses of the limits, to no less than the least [s]; each course on the way is then
    scaled as a whole, so that the limits hold exactly, and the shortest is kept. So it never takes longer than with
    stops at all keys.
    """
    free = np.isnan(lengths)
    lengths = np.where(free, np.maximum(pace.rest_to_rest(keys), least), lengths)
    best = TimedPath.smooth(_times(lengths), keys, passing=False)
    if not free.any():
        return TimedPath.smooth(_times(lengths), keys)
    rounds = 60
    hair = 1e-9  # limits hold to this share of them
    for _ in range(rounds):
        course = TimedPath.smooth(_times(lengths), keys)
        used = np.where(free, pace.share(*course.peaks()), 0.0)
        scaled = TimedPath.smooth(_times(np.where(free, np.maximum(used.max() * lengths, least), lengths)), keys)
        if scaled.seconds < best.seconds and pace.share(*scaled.peaks()).max() <= 1 + hair:
            best = scaled
        lengths = np.where(free, np.maximum(lengths * np.sqrt(used), least), lengths)
    return best


def linear(keys: Keys, lengths: Vector, pace: MotionLimits, *, least: float) -> TimedPath:
    """Linear course whose speeds keep to the limits in free legs."""
    soonest = (np.abs(np.diff(keys, axis=0)) / pace.speed).max(axis=1, initial=least)
    return TimedPath.linear(_times(np.where(np.isnan(lengths), soonest, lengths)), keys)


def _times(lengths: Vector) -> Vector:
    return np.concatenate([[0.0], np.cumsum(lengths)])


@dataclass(frozen=True, kw_only=True, eq=False)
class StraightCourse:
    """Markers along straight lines, and at rest in each keyframe: a line that ends in a corner cannot go through it.

    In a leg the contractions are a course c(s) through the knots of that leg,
    and s = 10 u^3 - 15 u^4 + 6 u^5 with u = (t - t_0) / T. So da/dt = c' s' and d2a/dt2 = c'' s'^2 + c' s''.
    """

    times: Vector  # times of the keyframes, from 0 [s]
    legs: tuple[TimedPath, ...]  # path of each leg, of length 1

    @classmethod
    def earliest(cls, knots: Sequence[Keys], lengths: Vector, pace: MotionLimits, *, least: float) -> Self:
        """Fastest path through the knots of each leg [m], of given durations [s] (NaN if free), within limits."""
        legs = tuple(_leg(keys) for keys in knots)
        soonest = np.array([float(pace.share(*_peaks(leg))[0]) for leg in legs])
        room = 1.0005  # a leg takes so many times as long as the limits ask at these places
        # Between the places that are looked at a leg may be faster by a hair.
        free = np.maximum(room * soonest, least)
        times = np.concatenate([[0.0], np.cumsum(np.where(np.isnan(lengths), free, lengths))])
        return cls(times=times, legs=legs)

    @property
    def seconds(self) -> float:
        """Duration [s]."""
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
        """Largest speed [m/s] and acceleration [m/s^2] of each winch in each leg, at many places."""
        lengths = np.diff(self.times)[:, None]
        found = [_peaks(leg) for leg in self.legs]
        fastest, hardest = np.concatenate([one for one, _ in found]), np.concatenate([two for _, two in found])
        return fastest / lengths, hardest / lengths**2


def _leg(keys: Keys) -> TimedPath:
    """Through knots; at its ends as steep as the first and last step.

    Where a winch must go far for little, the way is stretched: shares grow as the largest change of a contraction.
    """
    steps = np.abs(np.diff(keys, axis=0)).max(axis=1, initial=0.0)
    least = 0.01  # a step of the way has at least this share of it
    steps = steps + least * steps.sum() if steps.any() else np.ones(len(steps))
    times = np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
    course = TimedPath.smooth(times, keys)
    begins, ends = course.begins.copy(), course.ends.copy()
    slopes = np.diff(keys, axis=0) / np.diff(times)[:, None]
    begins[0], ends[-1] = slopes[0], slopes[-1]
    return TimedPath(times=times, keys=keys, begins=begins, ends=ends)


def _along(leg: TimedPath, shares: Vector) -> tuple[Samples, Samples, Samples]:
    """Contractions of a leg at shares of its time, and their derivatives by that."""
    u = shares[:, None]
    s, rate, rise = u**3 * (10 - 15 * u + 6 * u**2), 30 * u**2 * (1 - u) ** 2, 60 * u * (1 - u) * (1 - 2 * u)
    values, slopes, bends = leg.at(s[:, 0])
    return values, slopes * rate, bends * rate**2 + slopes * rise


def _peaks(leg: TimedPath) -> tuple[Peaks, Peaks]:
    places = 400  # places for each knot where speed and acceleration are looked at
    _, speeds, accelerations = _along(leg, np.linspace(0.0, 1.0, places * len(leg.keys)))
    return np.abs(speeds).max(axis=0, keepdims=True), np.abs(accelerations).max(axis=0, keepdims=True)
