"""`Keyframe`: target of a trajectory at an instant; the search for its contractions; checks of given poses."""

# Of the thesis (docs/thesis.md): R58

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik.ik_result import IKResult, IKStatus
from hydrostat.ik.inverse_kinematics import Targets, as_pose, solve_ik
from hydrostat.ik.limits import Bounds, Limits
from hydrostat.ik.objectives.effort import Effort, EffortKind
from hydrostat.ik.objectives.objective import Objective, describe
from hydrostat.ik.search.problem import IKOptions
from hydrostat.ik.trajectory.poses import follow
from hydrostat.robot import PinDrive, PoseTarget
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True, eq=False)
class Keyframe:
    """Target of a trajectory at one time.

    Attributes:
        target: target positions of markers [m]; or a solved pose, whose contractions are used unchanged, such as
            `simulation.rest` or a recorded pose.
        time: time from the start [s]; None for as soon as the limits allow.
        name: name for reports; None for that of the pose.
    """

    target: Targets | Equilibrium
    time: float | None = None
    name: str | None = None

    @property
    def pose(self) -> PoseTarget | None:
        """Target positions of the markers; None for a solved pose."""
        return None if isinstance(self.target, Equilibrium) else as_pose(self.target)


Key = Keyframe | Targets | Equilibrium | tuple[float | None, Targets | Equilibrium]
"""A keyframe; or only its target; or its time [s] and its target."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """Keyframe with its contractions."""

    keyframe: Keyframe  # requested keyframe
    pose: Equilibrium  # pose found
    reached: IKResult | None  # answer of inverse kinematics; None for a given pose
    free_error: float | None  # rms error of a search from rest on another branch, if that is smaller [m]
    knots: tuple[Equilibrium, ...]  # intermediate poses on the way there; the last one is `pose`


def as_keyframes(given: Sequence[Key]) -> list[Keyframe]:
    """Keyframes with names.

    Raises:
        InputError: none at all, one that is no keyframe, one without a target, a time that is not finite, times for
            some only, or times that do not rise from above 0.
    """
    if not isinstance(given, Sequence) or isinstance(given, str):
        raise InputError(f"keyframes must be a list of targets, not {describe(given)}")
    keyframes = [_as_keyframe(number, key) for number, key in enumerate(given, 1)]
    if not keyframes:
        raise InputError("a trajectory needs at least one keyframe")
    times = [key.time for key in keyframes if key.time is not None]
    if times and len(times) < len(keyframes):
        raise InputError(f"{len(times)} of {len(keyframes)} keyframes have a time; give one to all or to none")
    for before, time in zip([0.0, *times], times, strict=False):
        if not time > before:
            raise InputError(f"times of keyframes must rise from above 0 s, not {time:g} s after {before:g} s")
    return [
        replace(key, name=key.name or (key.pose.name if key.pose else None) or f"keyframe {number}")
        for number, key in enumerate(keyframes, 1)
    ]


def _as_keyframe(number: int, given: Key) -> Keyframe:
    """Convert to a keyframe and check the types of its parts."""
    key = given
    if isinstance(key, tuple):
        if len(key) != 2:
            raise InputError(f"keyframe {number} must be (time [s], target) or a target, not {describe(given)}")
        key = Keyframe(target=key[1], time=key[0])
    elif not isinstance(key, Keyframe):
        key = Keyframe(target=key)
    if not isinstance(key.target, Equilibrium | PoseTarget | Mapping):
        raise InputError(
            f"keyframe {number} needs a target, which is a pose, a solved pose, or places by marker such as "
            f'{{"tip": (0.1, 0.02)}}, not {describe(key.target)}'
        )
    if not isinstance(key.target, Equilibrium) and not as_pose(key.target):
        raise InputError(f"keyframe {number} has no target; name a marker and its place")
    if key.time is not None and not (isinstance(key.time, Real) and np.isfinite(key.time)):
        raise InputError(f"the time of keyframe {number} must be a finite number [s], not {describe(key.time)}")
    return key


@dataclass(frozen=True, kw_only=True, eq=False)
class KeySearch:
    """Inverse kinematics from one keyframe to the next."""

    simulation: Simulation  # physics of the robot
    limits: Limits  # limits of the winches
    objectives: tuple[Objective, ...]  # objectives in addition to the targets
    options: IKOptions  # options of a search from rest; one from a keyframe does not restart
    compare: bool  # also try a search from rest
    jump: float  # distance of a node from its predicted position that counts as a snap-through [m]
    knots: int  # number of poses on a path along which markers move straight; 0 for other paths

    def find(self, keyframe: Keyframe, before: Equilibrium) -> Found:
        """Pose of a keyframe, on the branch before (InputError, NotConvergedError: as for `solve_ik`)."""
        if isinstance(keyframe.target, Equilibrium):
            knots = self._straight(tuple(keyframe.target.markers), before, keyframe.target)
            return Found(keyframe=keyframe, pose=keyframe.target, reached=None, free_error=None, knots=knots)
        target = keyframe.pose
        assert target is not None
        reached, free_error = self._best(target, before)
        knots = self._straight(tuple(target.targets), before, reached.pose)
        return Found(keyframe=keyframe, pose=reached.pose, reached=reached, free_error=free_error, knots=knots)

    def _best(self, target: PoseTarget, before: Equilibrium) -> tuple[IKResult, float | None]:
        """Return the pose found from the pose before, and the smaller error of a search from rest, if any."""
        reached = self._solve(target, before, self.options)
        if not self.compare or reached.status is IKStatus.REACHED:
            return reached, None
        free = solve_ik(self.simulation, target, limits=self.limits, objectives=self._wishes(), options=self.options)
        if not self._better(free, reached):
            return reached, None
        end = self._way(before, free.pose)
        if end is not None:
            other = self._solve(target, end, self.options)
            if self._better(other, reached):
                reached = other
        return reached, free.rms_error if self._better(free, reached) else None

    def _solve(self, target: Targets, start: Equilibrium, options: IKOptions) -> IKResult:
        options = replace(options, restarts=0)
        wishes = self._wishes()
        return solve_ik(self.simulation, target, limits=self.limits, objectives=wishes, start=start, options=options)

    def _wishes(self) -> tuple[Objective, ...]:
        return (*self.objectives, _TAUT) if self.knots else self.objectives

    def _better(self, one: IKResult, other: IKResult) -> bool:
        tell = 1e-5  # and by this share of the body's size
        near = tell * self.simulation.robot.body.mesh.size
        better = 0.01  # a search from rest is better when its error is smaller by this share,
        return one.rms_error < min((1 - better) * other.rms_error, other.rms_error - near)

    def _way(self, begin: Equilibrium, goal: Equilibrium) -> Equilibrium | None:
        """Pose to which the branch of one pose leads at the contractions of another; None if it ends before."""
        # of a way that is followed to contractions found from rest; each is cut into smaller ones as need be
        steps = 20
        shares = np.linspace(0.0, 1.0, steps + 1)
        controls = (1 - shares)[:, None] * begin.controls + shares[:, None] * goal.controls
        try:
            poses, snaps = follow(self.simulation, begin, shares, controls, jump=self.jump)
        except NotConvergedError:
            return None
        return None if snaps else poses[-1]

    def _straight(self, names: tuple[str, ...], begin: Equilibrium, end: Equilibrium) -> tuple[Equilibrium, ...]:
        """Poses in which the markers are on the straight lines between two poses, at even steps."""
        poses, last = [], begin
        iterations = 15  # most Gauss-Newton steps to a pose on a straight way
        rough = replace(self.options, iterations=min(self.options.iterations, iterations))
        for knot in range(1, self.knots if names else 0):
            share = knot / self.knots
            places = {
                name: tuple(((1 - share) * begin.markers[name] + share * end.markers[name]).tolist()) for name in names
            }
            last = self._solve(places, last, rough).pose
            poses.append(last.without_factors())
        return (*poses, end)


_TAUT = Effort(of=EffortKind.SLACK, weight=0.0)  # slack cables stay just short of taut, to join without a jump


def check_given(simulation: Simulation, allowed: Bounds, name: str, pose: Equilibrium) -> None:
    """Reject a pose that inverse kinematics could not have found; its tensions are part of the report instead.

    Raises:
        InputError: a pose of another robot, a control out of its range, or equal winches that are not equal.
    """
    _check_own(simulation, name, pose)
    winches = [winch.name for winch in simulation.robot.winches]
    hair = 1e-9  # a contraction may be out of its limits by this much, for rounding [m]
    for winch, channel, value in zip(winches, allowed.channels, pose.contractions, strict=False):
        low, high = float(allowed.low[channel]) + 0.0, float(allowed.high[channel])
        if not low - hair <= value <= high + hair:
            raise InputError(
                f'{name}: the contraction of winch "{winch}" is {value:.6g} m, but its limits are {low:.6g} to '
                f"{high:.6g} m; give another pose, or widen the limits"
            )
    if outside := PinDrive.check_values(simulation.robot.drives, pose.drives):
        raise InputError(f"{name}: {outside[0]}. Give another pose, or widen the range.")
    for channel in range(len(allowed.low)):
        group = np.flatnonzero(allowed.channels[: len(winches)] == channel)
        values = pose.contractions[group]
        if len(values) and np.ptp(values) > hair:
            each = ", ".join(f'"{winches[winch]}" {pose.contractions[winch]:.6g} m' for winch in group)
            raise InputError(
                f"{name}: winches that should be equal are not equal: {each}; give another pose, or let them differ"
            )


def _check_own(simulation: Simulation, name: str, pose: Equilibrium) -> None:
    robot = simulation.robot
    shape, count = robot.body.mesh.nodes.shape, len(robot.winches)
    remedy = "solve it with the simulation that is given"
    if pose.nodes.shape != shape or not np.isfinite(pose.nodes).all():
        raise InputError(f"{name}: a pose of this robot has finite nodes, {shape}, not {pose.nodes.shape}; {remedy}")
    if len(pose.drives) != len(robot.drives):
        raise InputError(f"{name}: a pose of this robot has {plural(len(robot.drives), 'drive')}; {remedy}")
    if len(pose.contractions) != count or not np.isfinite(pose.contractions).all():
        raise InputError(
            f"{name}: a pose of this robot has {count} finite contractions, not {len(pose.contractions)}; {remedy}"
        )
    markers = [marker.name for marker in robot.markers]
    if sorted(pose.markers) != sorted(markers):
        raise InputError(
            f"{name}: a pose of this robot has the markers {', '.join(markers) or 'none'}, "
            f"not {', '.join(pose.markers) or 'none'}; {remedy}"
        )
