"""`Limits`: limits on contraction, rate and tension of winches."""

# Of the thesis (docs/thesis.md): E18

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.ik.objectives.objective import above_zero, by_name, describe, numbers
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation, contraction_values


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits of the winches, in addition to travel and release. Tension and torque default to those of the robot.

    Attributes:
        contraction: minimum and maximum contraction of a winch [m], instead of -release and travel.
        rate: maximum rate of change of a contraction [m/s], for every winch or by name; measured from the start.
        interval: time available for the change from the start [s]; required with a rate.
        tension: maximum cable tension [N], for every winch's cables or by the winch's name.
        torque: maximum torque of a winch [N m], for every winch or by name: the sum over its cables of spool radius
            times tension, minus that of cables wound in the opposite direction.
        equal: groups of winches that share one contraction.
    """

    contraction: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rate: float | Mapping[str, float] | None = None
    interval: float | None = None
    tension: float | Mapping[str, float] | None = None
    torque: float | Mapping[str, float] | None = None
    equal: Sequence[Sequence[str]] = ()


@dataclass(frozen=True, eq=False)
class Bounds:
    """Limits on one robot. A channel is a winch, a group of winches of one contraction, or a drive."""

    low: Vector  # least contraction of each channel [m]
    high: Vector  # largest contraction of each channel [m]
    span: Vector  # full range, whatever the rate allows [m]; the unit of steps
    tension: Vector  # maximum tension of each cable [N]; infinite without a limit
    reach: Vector  # maximum change of each channel from the start [m]; infinite without a limit
    channels: np.ndarray  # channel of each winch, then of each drive
    driven: np.ndarray  # True for a channel that is a drive, whose value is an angle [rad] or a travel [m]
    spread: Float[np.ndarray, "controls channels"]  # 1 where a winch or drive follows a channel
    cables: np.ndarray  # channel of each cable
    loads: Float[np.ndarray, "loads cables"]  # limited sums of tensions: single cables [1], torques of winches [m]
    most: Vector  # their maxima [N], [N m]
    motors: tuple[str, ...]  # winches of the torques among them, the last of the loads

    def channel(self, contractions: Vector) -> Vector:
        """Values of the channels, from those of the controls: the mean of a group, within the limits."""
        means = self.spread.T @ contractions / self.spread.sum(axis=0)
        return np.clip(means, self.low, self.high)

    def near(self, values: Vector) -> "Bounds":
        """Return the bounds within reach of these channel contractions [m] in the given time."""
        low, high = np.maximum(self.low, values - self.reach), np.minimum(self.high, values + self.reach)
        return replace(self, low=low, high=high)


def bounds(simulation: Simulation, limits: Limits) -> Bounds:
    """Limits on one robot.

    Raises:
        InputError: no simulation, no limits, a winch that it does not have, an empty range, a rate, tension or torque
            not above 0, a rate without an interval or the other way round, a winch named twice among equal ones.
    """
    if not isinstance(simulation, Simulation):
        raise InputError(f"simulation must be a Simulation(robot), not {describe(simulation)}")
    if not isinstance(limits, Limits):
        raise InputError(f"limits must be Limits(...), such as Limits(tension=5.0), not {describe(limits)}")
    robot = simulation.robot
    channels = _groups(robot, limits.equal)
    pulled = channels.max(initial=-1) + 1
    channels = np.append(channels, pulled + np.arange(len(robot.drives)))
    count = pulled + len(robot.drives)
    spread = np.zeros((len(channels), count))
    spread[np.arange(len(channels)), channels] = 1.0
    low, high = _ranges(robot, limits.contraction)
    largest = limit_by_winch(robot, robot.max_tension if limits.tension is None else limits.tension, "tension", "N")
    reach = np.append(limit_by_winch(robot, limits.rate, "rate", "m/s"), np.full(len(robot.drives), np.inf))
    if limits.rate is not None:
        if limits.interval is None:
            raise InputError("a limit on the rate needs an interval above 0 s, the time since the start")
        reach = reach * above_zero("interval of limits", limits.interval, unit="s")
    elif limits.interval is not None:
        raise InputError(f"an interval of {describe(limits.interval)} s limits nothing without a rate; give a rate too")
    strongest = robot.max_torque if limits.torque is None else limits.torque
    tension, torque = largest[simulation.cables.winches], limit_by_winch(robot, strongest, "torque", "N m")
    arms = spool_arms(robot)
    limited, turned = np.isfinite(tension), np.isfinite(torque) & arms.any(axis=1)
    back = turned & (arms < 0).any(axis=1)  # their motors are turned both ways
    lows = np.array([low[channels == channel].max() for channel in range(count)])
    highs = np.array([high[channels == channel].min() for channel in range(count)])
    found = Bounds(
        low=lows,
        high=highs,
        span=np.maximum(highs - lows, np.finfo(float).tiny),
        tension=tension,
        reach=np.array([reach[channels == channel].min() for channel in range(count)]),
        channels=channels,
        driven=np.arange(count) >= pulled,
        spread=spread,
        cables=channels[simulation.cables.winches],
        loads=np.concatenate([np.eye(len(tension))[limited], arms[turned], -arms[back]]),
        most=np.concatenate([tension[limited], torque[turned], torque[back]]),
        motors=tuple(robot.winches[number].name for number in np.append(np.flatnonzero(turned), np.flatnonzero(back))),
    )
    for channel in np.flatnonzero(found.low > found.high):
        names = ", ".join(winch.name for winch, own in zip(robot.winches, channels, strict=False) if own == channel)
        raise InputError(f"no contraction of {names} is within all of its limits; widen them")
    return found


def spool_arms(robot: Robot) -> Float[np.ndarray, "winches cables"]:
    """Radius at which each winch pulls each cable [m], negative for reversed ones; 0 for cables of other winches."""
    arms = np.zeros((len(robot.winches), len(robot.cables)))
    numbers = {winch.name: number for number, winch in enumerate(robot.winches)}
    for index, (cable, ratio) in enumerate(zip(robot.cables, robot.spool_ratios, strict=True)):
        number = numbers[cable.winch]
        radius = cable.spool_radius or robot.winches[number].spool_radius
        arms[number, index] = radius if ratio > 0 else -radius
    return arms


def _groups(robot: Robot, equal: Sequence[Sequence[str]]) -> np.ndarray:
    """Channel of each winch, numbered in the order of the winches."""
    group = {winch.name: number for number, winch in enumerate(robot.winches)}
    order = dict(group)
    seen: set[str] = set()
    if isinstance(equal, str) or not isinstance(equal, Sequence):
        raise InputError(f"equal must be groups of winches, such as {_GROUPS}, not {describe(equal)}")
    for names in equal:
        if isinstance(names, str) or not isinstance(names, Sequence):
            raise InputError(f"equal must be groups of winches, such as {_GROUPS}, not of {describe(names)}")
        for name in names:
            robot.winch(name)
            if names.count(name) > 1:
                raise InputError(f'winch "{name}" is named twice in a group of equal contraction; name it once')
            if name in seen:
                raise InputError(f'winch "{name}" is in two groups of equal contraction; join them')
        seen.update(names)
        first = min((order[name] for name in names), default=0)
        group.update(dict.fromkeys(names, first))
    return np.unique(list(group.values()), return_inverse=True)[1] if group else np.zeros(0, dtype=np.int64)


def _ranges(robot: Robot, given: Mapping[str, tuple[float, float]]) -> tuple[Vector, Vector]:
    ranges = {winch.name: (-winch.release, winch.travel) for winch in robot.winches}
    for name, limits in by_name("limits of contraction", given, '{"left": (0.0, 0.02)}').items():
        robot.winch(name)
        ends = numbers(limits)
        if ends is None or ends.shape != (2,) or not (np.isfinite(ends).all() and ends[0] <= ends[1]):
            raise InputError(
                f'contraction of winch "{name}" must lie between two rising numbers [m], not {describe(limits)}'
            )
        for end in ends:
            contraction_values(robot, {name: float(end)})  # in meters
        ranges[name] = (ends[0], ends[1])
    values = np.array([*ranges.values(), *(drive.limits for drive in robot.drives)], dtype=float).reshape(-1, 2)
    return values[:, 0], values[:, 1]


def limit_by_winch(robot: Robot, given: float | Mapping[str, float] | None, what: str, unit: str) -> Vector:
    """Limit for each winch, infinite where none is given (InputError: no such winch, or not above 0)."""
    if given is None:
        return np.full(len(robot.winches), np.inf)
    if isinstance(given, Mapping):
        for name in given:
            robot.winch(name)
        values = [given.get(winch.name, np.inf) for winch in robot.winches]
    else:
        values = [given] * len(robot.winches)
    return np.array([above_zero(f"a limit on the {what}", value, unit=unit) for value in values])


def limit_by_control(
    robot: Robot, given: float | Mapping[str, float] | None, usual: Vector, what: str, unit: str
) -> Vector:
    """Limit for each winch as by `limit_by_winch`, then for each drive: the one given by name, or the usual one."""
    drives, named = [drive.name for drive in robot.drives], given if isinstance(given, Mapping) else {}
    own = given
    if isinstance(given, Mapping):
        own = {name: value for name, value in given.items() if name not in drives}
    values = [
        above_zero(f"a limit on the {what}", named[name], unit=f"{drive.unit}/{unit.partition('/')[2]}")
        if (name := drive.name) in named
        else most
        for drive, most in zip(robot.drives, usual.tolist(), strict=True)
    ]
    return np.append(limit_by_winch(robot, own, what, unit), values)


_GROUPS = '[["left", "right"]]'
