"""`StuffedResults`: what a network of a flat robot reaches on the filled body, by commands that are found there."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.ik import IKOptions, IKResult, Limits, solve_ik
from hydrostat.robot import CableSide, PoseTarget, Robot, inflated_robot
from hydrostat.simulation import Simulation


@dataclass(frozen=True, kw_only=True, eq=False)
class StuffedResults:
    """A network on the body in space that a flat one becomes once it is filled, cables on its skin."""

    face: CableSide  # where the cables run
    reached: tuple[IKResult, ...]  # each pose by contractions found there, its targets in the plane
    played: float  # rms error over markers and poses with the commands of the flat model [m]
    finalists: int  # networks that were compared so, this one among them

    @property
    def rms_error(self) -> float:
        """Root of the mean squared marker error over all poses, by the contractions that were found there [m]."""
        return float(np.sqrt(np.mean([pose.rms_error**2 for pose in self.reached])))

    @property
    def out(self) -> float:
        """The farthest that a marker of any pose is out of the plane [m]."""
        return max(pose.pose.out_of_plane for pose in self.reached)


def solve_stuffed(robot: Robot, reached: Sequence[IKResult], *, limits: Limits, finalists: int = 1) -> StuffedResults:
    """Find the commands of poses on the filled body, from those of the flat model on.

    Args:
        robot: flat, with a drawing; its cables run where it says.
        reached: its poses in the flat model.
        limits: limits of its winches; the tension is that of each cable, of a pair of both.
        finalists: networks that are compared so.

    Raises:
        InputError: a robot in space, one without a drawing, or a body too thick for its outline.
        NotConvergedError: a pose that has no equilibrium.
    """
    simulation = Simulation(inflated_robot(robot))
    once = IKOptions(restarts=0)
    found, squares = [], []
    for flat in reached:
        pose = lift_target(flat.pose_target)
        start = simulation.solve(flat.pose.contractions)
        squares += [float(np.sum((start.markers[name] - place) ** 2)) for name, place in pose.targets.items()]
        found.append(solve_ik(simulation, pose, limits=limits, options=once).without_factors())
    played = float(np.sqrt(np.mean(squares)))
    face = robot.face or CableSide.FRONT
    return StuffedResults(face=face, reached=tuple(found), played=played, finalists=finalists)


def lift_target(pose: PoseTarget) -> PoseTarget:
    """A pose of a flat robot as one in space, within the plane z = 0."""
    return replace(pose, targets={name: (*place, 0.0) for name, place in pose.targets.items()})


def check_stuffed(robot: Robot) -> None:
    """Refuse a robot that cannot be filled (InputError: in space, without a drawing, or too thick for its outline)."""
    inflated_robot(robot.with_network((), ()))
