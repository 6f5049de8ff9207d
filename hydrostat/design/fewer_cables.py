"""`drop_cables`: a robot with the fewest cables that still reach its poses, about."""

from dataclasses import dataclass, replace

import numpy as np

from hydrostat.design.built_error import expected_error
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import IKOptions, IKResult, Limits, solve_ik
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

_ONCE = IKOptions(restarts=0)


@dataclass(frozen=True, kw_only=True)
class PosedNetwork:
    """A robot with its poses.

    Attributes:
        robot: robot with cables.
        reached: its poses.
        error: rms error expected of the robot as it is built [m].
    """

    robot: Robot
    reached: tuple[IKResult, ...]
    error: float

    @classmethod
    def solve(cls, robot: Robot, limits: Limits | None = None) -> "PosedNetwork":
        """Reach all poses of a robot (NotConvergedError: one has no equilibrium)."""
        simulation = Simulation(robot)
        reached = tuple(
            solve_ik(simulation, pose, limits=limits or Limits(), options=_ONCE) for pose in robot.poses.values()
        )
        error = expected_error(simulation, reached, BuildTolerances.of(robot.body))
        return cls(robot=robot, reached=reached, error=error)

    def friction_motion(self, friction: float) -> float:
        """Largest distance that a marker is moved by this friction coefficient at all holes [m] (NotConvergedError)."""
        smooth = Simulation(self.robot)
        cables = [replace(cable, friction=friction) for cable in self.robot.cables]
        rough = Simulation(self.robot.with_network(self.robot.winches, cables))
        moved = 0.0
        for reached in self.reached:
            pulled = reached.pose.contractions
            before, after = smooth.solve(pulled).markers, rough.solve(pulled).markers
            moved = max(moved, *(float(np.linalg.norm(after[name] - before[name])) for name in before))
        return moved


def drop_cables(
    robot: Robot,
    *,
    limits: Limits | None = None,
    worse: float = 1.5,
    share: float = 0.02,
    progress: Progress = no_progress,
) -> tuple[PosedNetwork, PosedNetwork]:
    """Take one cable after another out of a robot, the one that is missed least first; a winch goes with its last one.

    It ends where the expected as-built error would exceed both `worse` times that of the full robot and this share of
    the body's size. One cable stays. Returns the full robot and the one with fewer cables.

    Args:
        robot: robot with cables and poses.
        limits: limits of its poses.
        worse: largest ratio to the error of the full robot.
        share: error that is allowed anyway, as a share of the body's size.
        progress: receives the number of cables that are out.

    Raises:
        InputError: the robot has no poses or no cables.
        NotConvergedError: a pose of the full robot has no equilibrium.
    """
    if not (robot.cables and robot.poses):
        raise InputError("fewer cables are found by poses. Add a [[pose]] and cables to the robot.")
    full = best = PosedNetwork.solve(robot, limits)
    most = max(worse * full.error, share * robot.body.mesh.size)
    while len(best.robot.cables) > 1:
        progress("Fewer cables", len(robot.cables) - len(best.robot.cables), len(robot.cables) - 1)
        trials = [trial for index in range(len(best.robot.cables)) if (trial := _drop(best.robot, index, limits))]
        found = min(trials, key=lambda trial: trial.error, default=full)
        if not trials or found.error > most:
            break
        best = found
    return full, best


def _drop(robot: Robot, index: int, limits: Limits | None) -> PosedNetwork | None:
    """The robot without a cable, and without its winch if that pulls no other; None if it cannot be posed."""
    cables = [cable for number, cable in enumerate(robot.cables) if number != index]
    pulled = {cable.winch for cable in cables}
    try:
        return PosedNetwork.solve(
            robot.with_network([winch for winch in robot.winches if winch.name in pulled], cables), limits
        )
    except (InputError, NotConvergedError):
        return None
