"""`Trajectory`: poses in time, that winches can play."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.ik.ik_result import IKResult
from hydrostat.ik.trajectory.poses import BranchJump
from hydrostat.ik.trajectory.timed_path import MotionLimits, Samples
from hydrostat.painters import draw_record, html_repr
from hydrostat.result_table import Columns, Tabular, control_columns, marker_columns, named_columns
from hydrostat.robot import PoseTarget
from hydrostat.simulation import ContractionProfile, Equilibrium
from hydrostat.units import plural


class PathKind(StrEnum):
    """Quantity that follows a simple path from one keyframe to the next."""

    SMOOTH = "smooth"
    LINEAR = "linear"
    STRAIGHT = "straight"


@dataclass(frozen=True, kw_only=True, eq=False)
class KeyPose:
    """Result of a keyframe."""

    name: str  # name of its pose
    time: float  # time when it is reached [s]
    index: int  # index of its sample
    target: PoseTarget | None  # target positions of markers; None for a given pose
    found: IKResult | None  # answer of inverse kinematics from the keyframe before; None for a given pose
    pose: Equilibrium = field(repr=False)  # pose of the robot when the trajectory is there
    errors: Mapping[str, float]  # distance of each marker from its target in that pose [m]
    path_deviation: (
        float  # largest distance of a marker from the straight line from the keyframe before to this one [m]
    )
    free_error: float | None  # rms error of a search from rest on another branch, if that is smaller [m]
    same: bool  # True if the path leads to the pose that inverse kinematics found

    @property
    def rms_error(self) -> float:
        """Root of the mean squared error over the markers [m]."""
        return float(np.sqrt(np.mean(np.square(list(self.errors.values()))))) if self.errors else 0.0

    def lines(self) -> list[str]:
        """Plain report."""
        head = f"{self.time:.2f} s {self.name}: "
        head += f"marker error {1e3 * self.rms_error:.2f} mm rms" if self.errors else "as given"
        if self.pose.markers:
            head += f"; markers up to {1e3 * self.path_deviation:.2f} mm off a straight path"
        lines = [head]
        if self.found is not None:
            lines[0] += f"; {self.found.outcome}"
            lines += [f"  {words}" for words in self.found.active_limits]
        if self.free_error is not None:
            lines.append(f"  a search from rest reaches {1e3 * self.free_error:.2f} mm, on another branch")
        if not self.same:
            lines.append("  this path ends in another pose than planned: several poses share these contractions")
        return lines


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory(Tabular):
    """Contractions over time, and the equilibrium at each sample.

    Attributes:
        path: quantity that follows a simple path between keyframes.
        times: times of the samples, from 0 [s].
        contractions: contractions at each sample [m], in winch order, then drive values [rad, m or share].
        speeds: rates of change of these values [1/s].
        accelerations: second derivatives of these values [1/s^2]; 0 for a linear path, infinite at its corners.
        peak_speeds: maximum speed of each winch and drive, also between samples [1/s].
        peak_accelerations: maximum acceleration of each, also between samples [1/s^2].
        limits: limits on speed and acceleration.
        poses: equilibria, each continued from the previous one.
        keyframes: results of the keyframes, without the start.
        branch_jumps: jumps of the robot to another branch (snap-through).
        winches: names of the winches.
        cables: name of the winch of each cable.
        tension: maximum tension of each cable [N]; infinite without a limit.
    """

    path: PathKind
    times: Vector
    contractions: Samples = field(repr=False)
    speeds: Samples = field(repr=False)
    accelerations: Samples = field(repr=False)
    peak_speeds: Vector = field(repr=False)
    peak_accelerations: Vector = field(repr=False)
    limits: MotionLimits = field(repr=False)
    poses: tuple[Equilibrium, ...] = field(repr=False)
    keyframes: tuple[KeyPose, ...]
    branch_jumps: tuple[BranchJump, ...]
    winches: tuple[str, ...]
    cables: tuple[str, ...] = field(repr=False)
    tension: Vector = field(repr=False)

    def columns(self) -> Columns:
        """Return a table of time, contractions, drive values, markers and tensions, one row for each sample."""
        drives = {drive.name: drive.unit for drive in self.poses[0].robot.drives}
        columns = {"time_s": self.times, **control_columns(self.winches, drives, self.contractions)}
        names = [cable.name for cable in self.poses[0].robot.cables]
        return columns | marker_columns(self.markers) | named_columns("tension", names, self.tensions, "N")

    def _repr_html_(self) -> str:
        """Report and a picture, for a notebook."""
        return html_repr("\n".join(self.lines()), draw_record("trajectory", self.poses[0].robot, self))

    def __repr__(self) -> str:
        """Return a one-line summary."""
        parts = f"{plural(len(self.poses), 'pose')}, {plural(len(self.branch_jumps), 'snap')}"
        return f"<Trajectory of {self.times[-1]:.3g} s, {self.path}: {parts}>"

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return float(self.times[-1])

    @property
    def markers(self) -> dict[str, Float[np.ndarray, "samples dim"]]:
        """Position of each marker at each sample [m]."""
        return {name: np.array([pose.markers[name] for pose in self.poses]) for name in self.poses[0].markers}

    @property
    def tensions(self) -> Float[np.ndarray, "samples cables"]:
        """Tension of each cable at each sample [N]."""
        return np.array([pose.tensions for pose in self.poses])

    def profile(self) -> ContractionProfile:
        """Return contractions for `Simulation.play` and for motors, linear between samples."""
        return ContractionProfile(times=self.times, values=self.contractions)

    def lines(self) -> list[str]:
        """Return a report as lines of text: keyframes, used share of the limits, and violated limits."""
        lines = [line for key in self.keyframes for line in key.lines()]
        lines.append(f"{self.seconds:.2f} s in total, {len(self.times)} samples; path {self.path}")
        if self.winches:
            lines.append(self._most("speed", self.peak_speeds, self.limits.speed, "mm/s"))
            if self.path is PathKind.LINEAR:
                lines.append("acceleration: unlimited at the keyframes, where the speed jumps")
            else:
                lines.append(self._most("acceleration", self.peak_accelerations, self.limits.acceleration, "mm/s^2"))
        count = len(self.winches)
        for drive, most in zip(self.poses[0].robot.drives, self.peak_speeds[count:].tolist(), strict=True):
            lines.append(f"largest speed of drive {drive.name}: {drive.format_value(most)} a second")
        lines += self._over_tension()
        for snap in self.branch_jumps:
            lines.append(f"at {snap.time:.2f} s the robot snaps through: a node jumps {1e3 * snap.distance:.1f} mm")
        return lines

    def _most(self, what: str, most: Vector, limits: Vector, unit: str) -> str:
        most, limits = most[: len(self.winches)], limits[: len(self.winches)]
        winch = int(np.argmax(most / limits if np.isfinite(limits).any() else most))
        limit = f" of {1e3 * limits[winch]:.4g}" if np.isfinite(limits[winch]) else ""
        return f"largest {what}: {1e3 * most[winch]:.4g}{limit} {unit} ({self.winches[winch]})"

    def _over_tension(self) -> list[str]:
        """Cables that pull harder than they may: the search keeps to a limit on tension in the keyframes it finds."""
        lines = []
        tensions = self.tensions
        hair = 1e-3  # a tension may exceed its limit by this share before it is told
        for cable, limit in enumerate(self.tension):
            sample = int(np.argmax(tensions[:, cable]))
            most = tensions[sample, cable]
            if most > limit * (1 + hair):
                lines.append(
                    f"at {self.times[sample]:.2f} s, {self._place(sample)}, cable {cable + 1} ({self.cables[cable]}) "
                    f"reaches {most:.3g} N, above its limit of {limit:.3g} N"
                )
        return lines

    def _place(self, sample: int) -> str:
        """Describe the position of a sample in the trajectory."""
        if sample == 0:
            return "at the start"
        key = next(key for key in self.keyframes if key.index >= sample)
        return f"in {key.name}" if key.index == sample else f"on the way to {key.name}"


def path_deviation(markers: Mapping[str, Float[np.ndarray, "samples dim"]]) -> float:
    """Largest distance of a marker from the line between its first and its last place [m]."""
    most = 0.0
    for places in markers.values():
        way, offsets = places[-1] - places[0], places - places[0]
        square = float(way @ way)
        shares = np.clip(offsets @ way / square, 0.0, 1.0) if square > 0 else np.zeros(len(places))
        most = max(most, float(np.linalg.norm(offsets - shares[:, None] * way, axis=1).max()))
    return most


def legs_of(indices: list[int]) -> list[slice]:
    """Samples of each leg, both ends included."""
    return [slice(first, last + 1) for first, last in pairwise(indices)]
