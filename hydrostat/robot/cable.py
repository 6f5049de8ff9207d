"""`Cable`: a tendon from a winch through the body to a stopper; naming of cables."""

# Of the thesis (docs/thesis.md): R23, R25, R28, E12, R14, E11, E3

from collections import Counter
from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import (
    MAX_NAME,
    Point,
    check_name,
    check_not_negative,
    check_number,
    check_point,
    check_positive,
    check_type,
)


@dataclass(frozen=True, kw_only=True)
class Cable:
    """Cable (tendon); without friction its tension is constant along its length.

    Attributes:
        winch: name of the winch that pulls it.
        points: via points in the rest pose [m]; the first at the winch, the last the stopper.
        stiffness: stiffness of the whole cable when taut [N/m] (2K in Chang 2018).
        smoothing: half the elongation over which the cable becomes taut [m] (eps in Chang 2018).
        slack: contraction at which the cable starts to become taut [m].
        sheathed: pairs (i, j) of point indices between which it runs in a sheath of fixed length.
        friction: friction coefficient mu at the via points: where the cable bends by an angle, its tension differs
            between the two sides by at most a factor exp(mu * angle) (capstan).
        spool_radius: radius of the cable's own step on the shaft of its winch [m]; None for that of the winch. The
            cable's contraction is that of the winch times the ratio of both radii.
        reverse: True if it is wound in the opposite direction: it is taken in when its winch turns to pay out, and paid
            out when the winch takes in.
        name: name, unique in the robot; a `Robot` names cables without one.

    Raises:
        InputError: fewer than two points, coincident points, or a value out of range.
    """

    winch: str
    points: tuple[Point, ...]
    stiffness: float = 4e3
    smoothing: float = 0.5e-3
    slack: float = 0.0
    sheathed: tuple[tuple[int, int], ...] = ()
    friction: float = 0.0
    spool_radius: float | None = None
    reverse: bool = False
    name: str = ""

    def __post_init__(self) -> None:
        if self.name:
            check_name(self.name)
        check_type(self.winch, str, "winch must be the name of a winch")
        check_type(self.points, (tuple, list, np.ndarray), "points must hold at least 2 points [m]")
        check_type(self.sheathed, (tuple, list), "sheathed must hold pairs of point indices")
        count = len(self.points)
        if count < 2:
            raise InputError(f"points must hold at least 2 points, not {count}")
        for place, point in enumerate(self.points):
            check_point(f"points[{place}]", point)
            if len(point) != len(self.points[0]):
                raise InputError(
                    f"points[{place}] has {len(point)} coordinates, but points[0] has {len(self.points[0])}"
                )
        check_positive("stiffness", self.stiffness, "N/m")
        check_positive("smoothing", self.smoothing, "m")
        check_not_negative("slack", self.slack, "m")
        if self.spool_radius is not None:
            check_positive("spool_radius", self.spool_radius, "m")
        check_type(self.reverse, bool, "reverse must be True or False")
        check_number("friction", self.friction, "")
        # no coefficient of friction is larger: one half turn would then hold 500 times the tension
        largest_friction = 2.0
        if not 0 <= self.friction <= largest_friction:
            raise InputError(f"friction must be at least 0 and at most {largest_friction:g}, not {self.friction:g}")
        for start, end in self.sheathed:
            if not 0 <= start < end < count:
                raise InputError(
                    f"sheathed = [{start}, {end}] must be two point indices, rising, from 0 to {count - 1}"
                )
        same = np.flatnonzero(self.segments < 1e-9)
        if same.size:
            raise InputError(f"points[{same[0]}] and points[{same[0] + 1}] are the same; remove one of them")
        if not self.bare.any():
            raise InputError("sheathed: the whole cable is sheathed and cannot move anything; leave a part of it bare")

    @property
    def segments(self) -> np.ndarray:
        """Rest length of each segment [m], (points - 1,)."""
        return np.linalg.norm(np.diff(np.array(self.points), axis=0), axis=1)

    @property
    def bare(self) -> np.ndarray:
        """Mask of the segments outside sheaths, (points - 1,)."""
        bare = np.ones(len(self.points) - 1, dtype=bool)
        for start, end in self.sheathed:
            bare[start:end] = False
        return bare

    @property
    def length(self) -> float:
        """Rest length from winch to stopper, sheaths included [m]."""
        return float(self.segments.sum())


def name_cables(cables: Iterable[Cable]) -> tuple[Cable, ...]:
    """Return the same cables, each with a name: its own, or its winch's name and its number there, such as "left 2".

    A name that is taken is not given: counting goes on from there.
    """
    cables = tuple(cables)
    if all(cable.name for cable in cables):
        return cables
    taken = {cable.name for cable in cables}
    named = []
    for cable, number in zip(cables, _numbers(cables), strict=True):
        if not cable.name:
            while (name := _usual_name(cable.winch, number)) in taken:
                number += 1
            taken.add(name)
            cable = copy(cable)  # not made again: all else is checked, and designs make robots by the thousand
            object.__setattr__(cable, "name", name)
        named.append(cable)
    return tuple(named)


def given_names(cables: Sequence[Cable]) -> tuple[str, ...]:
    """Name of each cable, but "" where `name_cables` would give it that name again."""
    return tuple(
        "" if cable.name == _usual_name(cable.winch, number) else cable.name
        for cable, number in zip(cables, _numbers(cables), strict=True)
    )


def _numbers(cables: Sequence[Cable]) -> list[int]:
    """Count of each cable among those of its winch, from 1."""
    seen: Counter[str] = Counter()
    numbers = []
    for cable in cables:
        seen[cable.winch] += 1
        numbers.append(seen[cable.winch])
    return numbers


def _usual_name(winch: str, number: int) -> str:
    """Winch's name and a number, no longer than a name may be."""
    tail = f" {number}"
    return winch[: MAX_NAME - len(tail)] + tail
