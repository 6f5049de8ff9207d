"""`Course`: contractions in time, from one key to the next."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector

Keys = Float[np.ndarray, "keys winches"]
Samples = Float[np.ndarray, "samples winches"]
Peaks = Float[np.ndarray, "legs winches"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """A quintic in each leg, with the speeds given at its ends and no acceleration there.

    With T the length of a leg, u = (t - t_0) / T, D the way and p, q the speeds at both ends times T:

        a(u) = a_0 + p u + (10 D - 6 p - 4 q) u^3 + (8 p + 7 q - 15 D) u^4 + (6 D - 3 p - 3 q) u^5

    It is C2 where the speeds at the end of a leg are those at the beginning of the next, monotone where p and q lie
    between 0 and 2 D, at rest at both ends the polynomial of least jerk (Flash 1985), and a line where p = q = D.
    """

    times: Vector  # of the keys, rising from 0 [s]
    keys: Keys  # contractions there [m]
    begins: Peaks  # speeds at the beginning of each leg [m/s]
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
        """How long it takes [s]."""
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
        """The largest speed [m/s] and acceleration [m/s^2] of each winch in each leg, in closed form.

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


SPEED_OF_REST = 15 / 8  # largest speed of a leg from rest to rest, in ways for each length of the leg
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
    """A quotient if it lies between 0 and 1, else 0."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = above / below
    return np.where((found > 0) & (found < 1), found, 0.0)
