"""`Keyframe`: a pose to be taken on the way, and the search for its contractions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from hydrostat.errors import InputError
from hydrostat.ik.effort import Effort, EffortKind
from hydrostat.ik.limits import Limits
from hydrostat.ik.objective import Objective
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.search import InverseOptions
from hydrostat.ik.solve_ik import Targets, as_pose, solve_ik
from hydrostat.robot import Pose
from hydrostat.simulation import Simulation, SolvedPose


@dataclass(frozen=True, kw_only=True, eq=False)
class Keyframe:
    """A pose in time.

    Attributes:
        target: where markers should be [m]; or a solved pose, whose contractions are taken as they are, such as
            `simulation.rest` or one that was taught (R58).
        time: when, counted from the start [s]; as soon as the limits allow if left out.
        name: for reports; that of the pose if left out.
    """

    target: Targets | SolvedPose
    time: float | None = None
    name: str | None = None

    @property
    def pose(self) -> Pose | None:
        """Where markers should be; None for a solved pose."""
        return None if isinstance(self.target, SolvedPose) else as_pose(self.target)


Key = Keyframe | Targets | SolvedPose | tuple[float | None, Targets | SolvedPose]
"""A keyframe; or only its target; or its time [s] and its target."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """A keyframe with its contractions.

    Attributes:
        keyframe: what was asked for.
        pose: what was found.
        reached: how it was found; None for a pose that was given.
        free_error: rms error that a search from rest finds, where that is better [m].
        knots: poses on the way there that are to be passed; the last one is `pose`.
    """

    keyframe: Keyframe
    pose: SolvedPose
    reached: ReachedPose | None
    free_error: float | None
    knots: tuple[SolvedPose, ...]


def as_keyframes(given: Sequence[Key]) -> list[Keyframe]:
    """Keyframes with names.

    Raises:
        InputError: none at all, one without a target, times for some only, or times that do not rise from above 0.
    """
    keyframes = [_as_keyframe(key) for key in given]
    if not keyframes:
        raise InputError("a trajectory needs at least one keyframe")
    for number, key in enumerate(keyframes, 1):
        if not isinstance(key.target, SolvedPose) and not key.target:
            raise InputError(f"keyframe {number} has no target; name a marker and its place")
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


def _as_keyframe(key: Key) -> Keyframe:
    if isinstance(key, Keyframe):
        return key
    if isinstance(key, tuple):
        time, target = key
        return Keyframe(target=target, time=time)
    return Keyframe(target=key)


@dataclass(frozen=True, kw_only=True, eq=False)
class KeySearch:
    """Inverse kinematics from one keyframe to the next.

    Attributes:
        simulation: the robot's physics.
        limits: what the winches may do.
        objectives: what is wished for beside the targets.
        options: of a search from rest; one from a keyframe does not restart.
        compare: look whether a search from rest does better.
        knots: poses on a way along which markers go straight; 0 for other ways.
    """

    simulation: Simulation
    limits: Limits
    objectives: tuple[Objective, ...]
    options: InverseOptions
    compare: bool
    knots: int

    def find(self, keyframe: Keyframe, before: SolvedPose) -> Found:
        """The pose of a keyframe, on the branch of the one before.

        Raises:
            InputError, NotConvergedError: as for `solve_ik`.
        """
        if isinstance(keyframe.target, SolvedPose):
            knots = self._straight(tuple(keyframe.target.markers), before, keyframe.target)
            return Found(keyframe=keyframe, pose=keyframe.target, reached=None, free_error=None, knots=knots)
        target = keyframe.pose
        assert target is not None
        reached = self._solve(target, before)
        knots = self._straight(tuple(target.targets), before, reached.pose)
        return Found(
            keyframe=keyframe,
            pose=reached.pose,
            reached=reached,
            free_error=self._free_error(target, reached),
            knots=knots,
        )

    def _solve(self, target: Targets, start: SolvedPose) -> ReachedPose:
        wishes = self.objectives
        if self.knots:
            wishes = (*wishes, _TAUT)
        options = replace(self.options, restarts=0)
        return solve_ik(self.simulation, target, limits=self.limits, objectives=wishes, start=start, options=options)

    def _free_error(self, target: Pose, reached: ReachedPose) -> float | None:
        if not self.compare or reached.reason is InverseReason.REACHED:
            return None
        free = solve_ik(self.simulation, target, limits=self.limits, objectives=self.objectives, options=self.options)
        near = _TELL * self.simulation.robot.body.mesh.size
        better = free.rms_error < min((1 - _BETTER) * reached.rms_error, reached.rms_error - near)
        return free.rms_error if better else None

    def _straight(self, names: tuple[str, ...], begin: SolvedPose, end: SolvedPose) -> tuple[SolvedPose, ...]:
        """Poses in which the markers are on the straight lines between two poses, at even steps."""
        poses, last = [], begin
        for knot in range(1, self.knots):
            share = knot / self.knots
            places = {
                name: tuple(((1 - share) * begin.markers[name] + share * end.markers[name]).tolist()) for name in names
            }
            last = self._solve(places, last).pose
            poses.append(last)
        return (*poses, end)


_TAUT = Effort(of=EffortKind.SLACK, weight=0.0)
"""Slack cables are kept just short of taut, so that they join without a jump of their contraction."""

_BETTER = 0.01
"""A search from rest is better when its error is smaller by this share,"""

_TELL = 1e-5
"""and by this share of the body's size."""
