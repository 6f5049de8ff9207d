"""`LessonPoses`: poses that a robot shows and a person mimics, one after the other; `HeldStill`: averaged readings."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import Motors
from hydrostat.errors import HydrostatError
from hydrostat.teleop.mimicry import Mimicry
from hydrostat.teleop.ridge import Table
from hydrostat.teleop.source import DriveChannels, HandSource
from hydrostat.units import plural

POOL = 400
"""Number of candidate poses for the next pose."""
SHARE = 0.4
"""Largest contraction of a winch in a pose, as a share of its range."""
ARRIVAL_TIME = 2.0
"""Time that motors may take beyond that at full speed [s]."""
HOLD = 0.3
"""Time that a person holds still [s]; readings of that time are averaged."""


@dataclass(frozen=True, eq=False)
class HeldStill:
    """Averaged sensor readings while a person held a pose.

    Attributes:
        values: mean of each sensor.
        spread: largest standard deviation of a sensor.
        readings: number of averaged readings.
    """

    values: Vector
    spread: float
    readings: int

    @property
    def still(self) -> bool:
        """True if the hand was still."""
        # Sensors of a hand that holds still vary by less, one standard deviation of the worst; their range is 1
        still = 0.012
        return self.spread < still

    @staticmethod
    def wait(
        hand: HandSource,
        beat: Callable[[], object] = lambda: None,
        *,
        seconds: float = HOLD,
        clock: Callable[[], float] = time.monotonic,
    ) -> "HeldStill":
        """Average the readings of a hand for a duration [s].

        `beat` runs after each reading, to keep motors holding (HydrostatError: no answer from the hand).
        """
        end, told = clock() + seconds, [hand.read().values]
        while clock() < end:
            beat()
            told.append(hand.read().values)
        table = np.array(told)
        return HeldStill(table.mean(0), float(table.std(0).max()), len(table))


def go_there(motors: Motors, contractions: Vector, beat: Callable[[], object]) -> None:
    """Move motors to contractions [m], driven by each beat (HydrostatError: they do not reach them)."""
    clock = motors.clock
    motors.ask(contractions)
    latest = clock() + float(np.abs(motors.command - motors.places).max(initial=0.0)) / motors.fastest + ARRIVAL_TIME
    beat()
    tick = 1 / 60  # Motors are told again after so long [s]
    while motors.is_moving:
        if clock() > latest:
            index = int(np.abs(motors.command - motors.places).argmax())
            raise HydrostatError(f"{motors.names[index]}: target not reached in time. Check for a jammed cable.")
        time.sleep(tick)
        beat()


class LessonPoses:
    """Sequence of poses in a lesson: the next pose, and the accuracy after each.

    Attributes:
        made: pairs of readings and contractions so far.
        span: output ranges [m]; they scale errors to the range from -1 to 1 of the thesis.
    """

    def __init__(self, made: Mimicry, pool: Table, answers: Table) -> None:
        """Go on with pairs (they may be none) by a pool of contractions [m] and the answers that each would have."""
        self.made, self._pool, self._answers = made, pool, answers
        self.span = np.ptp(answers, axis=0).max()
        self._left = list(range(len(pool)))

    @property
    def count(self) -> int:
        """Number of poses so far."""
        return len(set(self.made.poses))

    def next_pose(self) -> Vector:
        """Return the contractions of the most informative pose [m]; the first pose is the rest pose."""
        which = 0 if not self.made.poses and self._left[0] == 0 else self.made.next_pose(self._answers[self._left])
        return self._pool[self._left.pop(which)]

    def take(self, held: HeldStill, answer: Vector) -> None:
        """Add a pair."""
        number = max(self.made.poses, default=-1) + 1
        self.made.add(number, held.values, answer, time.time())

    def summary(self) -> str:
        """Return a text summary of the cross-validation errors so far."""
        if self.count < 4:
            return f"{plural(self.count, 'pose')}; errors are available from 4 poses on"
        known = self.made.learn()
        one, folds = (f"{1e3 * error:.2f} mm ({2 * error / self.span:.4f})" for error in self.made.errors(known))
        words = f"cross-validation error: leave-one-out {one}, five-fold {folds}"
        return f"{self.count} poses; {words}; in brackets: on a scale from -1 to 1"

    @staticmethod
    def pool(channels: DriveChannels, seed: int = 0, count: int = POOL) -> Table:
        """Return candidate contractions [m]: rest, and random ones in which about half of the winches take in cable."""
        random = np.random.default_rng(seed)
        size = (count, len(channels.names))
        share = random.uniform(0.0, SHARE, size) * (random.uniform(size=size) < 0.5)
        pool = channels.rest + share * (channels.high - channels.rest)
        return np.vstack([channels.rest, pool])
