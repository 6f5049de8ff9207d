"""Films: a robot goes from rest through stops or along a trajectory, every frame an equilibrium."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.ik import IKResult, KeyPose, Trajectory
from hydrostat.plot.frame import Frame
from hydrostat.plot.labels import shorten
from hydrostat.progress import Progress
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.units import MILLIMETERS

REST_SHARE = 0.25  # share of the time from one stop to the next in which the robot stays there


@dataclass(frozen=True, kw_only=True, eq=False)
class Stop:
    """A place where a film goes."""

    name: str  # of the pose, or what is done
    contractions: Vector  # cable taken in by each winch [m], then values of drives
    target: PoseTarget | None = None  # whose targets are shown on the way
    words: str = ""  # shown while the robot stays there

    @staticmethod
    def for_poses(reached: Sequence[IKResult]) -> "list[Stop]":
        """Return a stop for each pose that inverse kinematics found."""
        return [
            Stop(
                name=shorten(found.pose_target.name),
                contractions=found.pose.controls,
                target=found.pose_target,
                words=f"{shorten(found.pose_target.name)}: marker error {MILLIMETERS * found.rms_error:.1f} mm rms",
            )
            for found in reached
        ]

    @staticmethod
    def for_winches(robot: Robot) -> "list[Stop]":
        """Take in each winch by half its travel, or less for short cables; then move each drive to its farther end."""
        stops = []
        least_left = 0.7  # no winch is taken in so far that less than this share of its shortest cable is left
        for index, winch in enumerate(robot.winches):
            pairs = zip(robot.cables, robot.spool_ratios, strict=True)
            lengths = [cable.length / ratio for cable, ratio in pairs if cable.winch == winch.name and ratio > 0]
            taken = np.zeros(robot.num_controls)
            taken[index] = min([winch.travel / 2, *((1 - least_left) * length for length in lengths)])
            words = f"{shorten(winch.name)} {MILLIMETERS * taken[index]:.0f} mm"
            stops.append(Stop(name=words, contractions=taken, words=words))
        for index, drive in enumerate(robot.drives, len(robot.winches)):
            value = max(drive.limits, key=abs)
            words = f"{shorten(drive.name)} {drive.format_value(value)}"
            stops.append(Stop(name=words, contractions=value * np.eye(robot.num_controls)[index], words=words))
        return stops


@dataclass(frozen=True, kw_only=True, eq=False)
class Film:
    """Frames at equal times."""

    frames: tuple[Frame, ...]  # the first and the last at rest
    step: float  # time of a frame [s]
    missing: tuple[int, ...]  # numbers of the frames without an equilibrium; they show the one before

    @staticmethod
    def of_stops(
        simulation: Simulation,
        stops: Sequence[Stop],
        *,
        seconds: float,
        step: float = 0.08,
        progress: Progress | None = None,
    ) -> "Film":
        """The equilibria from rest through all stops and back to rest; it starts and stops gently.

        A frame that has no equilibrium, or in which an element would be inverted, shows the one before. The film takes
        so many seconds, each frame about a step [s].

        Raises:
            InputError: no stop, or so little time that a way would have fewer than four frames.
            NotConvergedError: the robot has no equilibrium at rest.
        """
        ways = len(stops) + 1
        if not stops:
            raise InputError("a film needs a stop to go to")
        count = round(seconds / step)
        fewest = 4  # frames from one stop to the next
        if count < 1 + fewest * ways:
            least = np.ceil(10 * (1 + fewest * ways) * step) / 10
            raise InputError(f"{seconds:g} s are too short for {ways} ways; at least {least:g} s")
        ends = 1 + np.round((count - 1) * np.arange(ways + 1) / ways).astype(int)
        rest = simulation.solve({})
        home = Stop(name="rest", contractions=rest.controls, words="at rest")
        shot = _Shot(simulation, rest, count, progress)
        begin = home
        for stop, frames in zip([*stops, home], np.diff(ends), strict=True):
            shot.go(begin, stop, int(frames))
            begin = stop
        return Film(frames=tuple(shot.frames), step=seconds / count, missing=tuple(shot.missing))


class _Shot:
    """Frames as they are made."""

    def __init__(self, simulation: Simulation, rest: Equilibrium, count: int, progress: Progress | None) -> None:
        self.frames = [Frame.of(rest, words="at rest")]
        self.missing: list[int] = []
        self._simulation, self._last, self._count, self._progress = simulation, rest, count, progress

    def go(self, begin: Stop, end: Stop, count: int) -> None:
        """Go from one stop to the next in a number of frames, the last of them still."""
        still = max(1, round(REST_SHARE * count))
        words = "back to rest" if not end.contractions.any() else f"to {end.name}"
        for number in range(1, count - still + 1):
            share = 0.5 - 0.5 * np.cos(np.pi * number / (count - still))
            goal = begin.contractions + share * (end.contractions - begin.contractions)
            self._take(goal, end, words)
        self.frames += [replace(self.frames[-1], words=end.words)] * still
        self._report()

    def _take(self, goal: Vector, end: Stop, words: str) -> None:
        pose = self._simulation.solve(goal, start=self._last, strict=False)
        if pose.result.converged and upright(self._simulation.robot, pose):
            self._last = pose
        else:
            self.missing.append(len(self.frames))
        self.frames.append(Frame.of(self._last, target=end.target, words=words))
        self._report()

    def _report(self) -> None:
        if self._progress is not None:
            self._progress("solving", len(self.frames), self._count)


def upright(robot: Robot, pose: Equilibrium) -> bool:
    """Return True if no element is inverted."""
    corners = pose.nodes[robot.body.mesh.elements]
    return bool((np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all())


STEP = 0.04  # time of a frame of a short trajectory [s]


def trajectory_frames(trajectory: Trajectory) -> tuple[list[Frame], float]:
    """Frames at equal times, each the sample that is nearest; and the time of a frame [s]."""
    most = 240  # frames of a long trajectory
    step = max(STEP, ceil(100 * trajectory.seconds / most) / 100)
    count = max(ceil(trajectory.seconds / step), 1)
    frames = []
    for time in np.linspace(0.0, trajectory.seconds, count + 1):
        sample = int(np.argmin(np.abs(trajectory.times - time)))
        key, there = _key(trajectory, sample)
        frames.append(Frame.of(trajectory.poses[sample], target=key.target, words=_words(key, there)))
    end = 0.6  # how long the last pose is shown [s]
    return [*frames, *[frames[-1]] * ceil(end / step)], step


def _key(trajectory: Trajectory, sample: int) -> tuple[KeyPose, bool]:
    """The keyframe that is approached, or in which the robot stays."""
    for before in reversed(trajectory.keyframes):
        if before.index <= sample:
            stays = (trajectory.contractions[sample] == trajectory.contractions[before.index]).all()
            if stays or before is trajectory.keyframes[-1]:
                return before, True
            break
    return next(key for key in trajectory.keyframes if key.index > sample), False


def _words(key: KeyPose, there: bool) -> str:
    name = shorten(key.name)
    if not there:
        return f"to {name}"
    return f"{name}: marker error {MILLIMETERS * key.rms_error:.1f} mm rms" if key.errors else name
