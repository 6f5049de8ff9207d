"""`find_equilibria`: whether contractions alone decide the pose, or also the loading path (E20)."""

# Of the thesis (docs/thesis.md): E20

from collections import Counter
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.given import check_type
from hydrostat.progress import Progress
from hydrostat.result_table import Columns, ResultTable, Tabular
from hydrostat.simulation.branches.loading_paths import Approach, follow_approach, loading_paths_to
from hydrostat.simulation.equilibrium import Equilibrium, largest_distance
from hydrostat.simulation.simulation import Contractions, Simulation
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True, eq=False)
class FoundPose:
    """Equilibrium, and the loading paths that lead to it.

    Attributes:
        pose: minimum of the energy; its marker positions are those of the equilibrium.
        ways: description of each loading path that ends there, one for each start.
    """

    pose: Equilibrium
    ways: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Multistability(Tabular):
    """Equilibria of a robot at the same contractions after different loading paths.

    Attributes:
        contractions: contractions of all the poses [m], then drive values [rad, m or share].
        poses: distinct equilibria, lowest energy first.
        lost: description of each loading path without an equilibrium or without a stable one.
        spread: largest distance of each marker between two of the poses [m].
        node_spread: largest distance of any node between two of the poses [m].
        near: largest node distance at which two poses count as one [m].
        friction: True if cables have friction, which makes the pose depend on the loading path.
    """

    contractions: Vector
    poses: tuple[FoundPose, ...]
    lost: tuple[str, ...]
    spread: dict[str, float]
    node_spread: float
    near: float
    friction: bool

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<Multistability: {plural(len(self.poses), 'pose')} after {plural(self.starts, 'start')}>"

    def columns(self) -> Columns:
        """Return a table of energy, number of paths, contractions, markers and tensions, one row for each pose."""
        energies, paths = np.array([[found.pose.energy, len(found.ways)] for found in self.poses]).reshape(-1, 2).T
        table = ResultTable.of(found.pose for found in self.poses).columns() if self.poses else {}
        return {"energy_J": energies, "loading_paths": paths} | table

    @property
    def unique(self) -> bool:
        """True if all starts lead to one pose, so that the contractions alone determine it."""
        return len(self.poses) == 1

    @property
    def starts(self) -> int:
        """Number of starts that lead to a pose."""
        return sum(len(found.ways) for found in self.poses)

    @property
    def largest(self) -> tuple[str, float]:
        """Marker with the largest distance between poses, and this distance [m]; "a node" without markers."""
        if not self.spread:
            return "a node", self.node_spread
        return max(self.spread.items(), key=lambda item: item[1])

    def lines(self) -> list[str]:
        """Return a report as lines of text."""
        if not self.poses:
            lines = ["no pose found"]
        elif self.unique:
            lines = [f"unique pose on {plural(self.starts, 'loading path')}"]
        else:
            where, far = self.largest
            paths = plural(self.starts, "loading path")
            lines = [f"{len(self.poses)} poses on {paths}, up to {1e3 * far:.3g} mm apart at {where}"]
            if self.friction:
                lines.append("cable friction is on: the pose depends on the loading path")
            lines += [self._line(number, found) for number, found in enumerate(self.poses, 1)]
        if self.lost:
            lines.append(f"no stable pose on {plural(len(self.lost), 'loading path')}: {_path_names(self.lost)}")
        return lines

    def _line(self, number: int, found: FoundPose) -> str:
        return (
            f"pose {number}: energy {found.pose.energy:.4g} J, from {len(found.ways)} of {self.starts}: "
            f"{_path_names(found.ways)}"
        )


def find_equilibria(
    simulation: Simulation,
    contractions: Contractions,
    *,
    count: int = 16,
    seed: int = 0,
    tolerance: float = 1e-4,
    progress: Progress | None = None,
) -> Multistability:
    """Solve for the same contractions from different starts; return the distinct poses.

    The loading paths are from `loading_paths_to`. A single pose does not prove uniqueness: other paths may differ.

    Args:
        simulation: the robot's physics.
        contractions: contractions at the end of every loading path [m], and drive values.
        count: number of loading paths.
        seed: random seed of the loading paths.
        tolerance: largest node distance, as a share of the body's size, at which two poses count as one.
        progress: callback for progress.

    Raises:
        InputError: contractions that do not fit the robot, or no loading paths.
    """
    goal = simulation.as_contractions(contractions)
    check_type(count, int, "count must be a whole number of at least 1")
    if count < 1:
        raise InputError(f"count must be at least 1, not {count}; 16 are enough for most robots")
    if not tolerance > 0:
        raise InputError(f"tolerance must be above 0, not {tolerance:g}; it is a share of the body's size")
    groups: list[tuple[Equilibrium, list[str]]] = []
    lost: list[str] = []
    near = tolerance * simulation.robot.body.mesh.size
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"seed must be a whole number of 0 or more, not {seed!r}")
    ways = loading_paths_to(simulation, goal, count, seed)
    for done, way in enumerate(ways, 1):
        _sort(follow_approach(simulation, way), way, goal, groups, lost, near)
        if progress is not None:
            progress("solving loading paths", done, len(ways))
    groups.sort(key=lambda group: group[0].energy)
    poses = tuple(FoundPose(pose=pose, ways=tuple(names)) for pose, names in groups)
    return Multistability(
        contractions=goal,
        poses=poses,
        lost=tuple(lost),
        spread=_marker_spread(simulation, poses),
        node_spread=max((largest_distance(a.pose.nodes, b.pose.nodes) for a, b in combinations(poses, 2)), default=0.0),
        near=near,
        friction=simulation.friction is not None,
    )


def _sort(
    pose: Equilibrium,
    way: Approach,
    goal: Vector,
    groups: list[tuple[Equilibrium, list[str]]],
    lost: list[str],
    near: float,
) -> None:
    """Add a pose to those that are the same, or as a new one."""
    if not (pose.result.converged and pose.result.stable and (pose.controls == goal).all()):
        lost.append(way.name)
        return
    for known, names in groups:
        if largest_distance(known.nodes, pose.nodes) <= near:
            names.append(way.name)
            return
    groups.append((pose.without_factors(), [way.name]))


def _marker_spread(simulation: Simulation, poses: tuple[FoundPose, ...]) -> dict[str, float]:
    """Largest distance of each marker between two of the poses [m]."""
    spread = {}
    for marker in simulation.robot.markers:
        places = [found.pose.markers[marker.name] for found in poses]
        gaps = [float(np.linalg.norm(a - b)) for a, b in combinations(places, 2)]
        spread[marker.name] = max(gaps, default=0.0)
    return spread


def _path_names(ways: tuple[str, ...]) -> str:
    """Descriptions of loading paths, each once, with its count."""
    kinds = Counter(name.partition(":")[0] for name in ways)
    return ", ".join(name if times == 1 else f"{name} ({times} times)" for name, times in kinds.items())
