"""`built_errors`, `expected_error`: pose errors of a design as it may be built, its commands played open loop."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.spread import spread_columns
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import NotConvergedError
from hydrostat.ik import IKResult
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation, cable_sensitivities


@dataclass(frozen=True, kw_only=True, eq=False)
class BuiltErrors:
    """Rms errors over markers and poses of robots as they may be built [m].

    Attributes:
        drawn: error of each draw [m], (draws,); infinite where a pose has no equilibrium.
        model: error of the design itself, by the commands it was given [m].
    """

    drawn: Vector
    model: float

    @property
    def median(self) -> float:
        """Half of the robots are as good as this [m]."""
        return float(np.median(self.drawn))

    @property
    def most(self) -> float:
        """Nine of ten robots are as good as this: the 90 % quantile [m]."""
        return float(np.quantile(self.drawn, 0.9, method="higher"))


def built_errors(
    robot: Robot,
    poses: Sequence[PoseTarget],
    commands: Sequence[Vector],
    uncertainty: BuildTolerances,
    *,
    draws: int = 40,
    seed: int = 0,
) -> BuiltErrors:
    """Play the same contractions on robots drawn at random, and measure how far their markers are from the targets.

    Each is solved from rest along the straight loading path, friction included. The draws are the same for the same
    seed.

    Args:
        robot: the robot of the design.
        poses: the targets.
        commands: contractions of each pose [m].
        uncertainty: build tolerances.
        draws: number of robots.
        seed: random seed.
    """
    found = []
    for number in range(draws):
        built = uncertainty.draw(robot, np.random.default_rng([seed, number]))
        found.append(played_error(built, poses, commands))
    return BuiltErrors(drawn=np.array(found), model=played_error(robot, poses, commands))


def played_error(robot: Robot, poses: Sequence[PoseTarget], commands: Sequence[Vector]) -> float:
    """Rms error over markers and poses of contractions played from rest [m]; infinite without an equilibrium."""
    simulation = Simulation(robot)
    squares = []
    for pose, command in zip(poses, commands, strict=True):
        squares.append(mean_square(simulation.solve(np.asarray(command), strict=False), pose))
    return float(np.sqrt(np.mean(squares)))


def mean_square(played: Equilibrium, pose: PoseTarget) -> float:
    """Mean squared distance of the markers of a pose from their targets [m^2]; infinite without an equilibrium."""
    if not played.result.converged:
        return float("inf")
    misses = [np.subtract(played.markers[name], target) for name, target in pose.targets.items()]
    return float(np.mean(np.sum(np.square(misses), axis=1)))


def expected_error(simulation: Simulation, reached: Sequence[IKResult], uncertainty: BuildTolerances) -> float:
    """Root mean square of the marker error over poses and over robots as they may be built [m].

    By first-order second moments (`spread_columns`): squares of the error in the model and of what each tolerance adds.
    Infinite at a pose that is about to snap.
    """
    names = [marker.name for marker in simulation.robot.markers]
    squares = []
    for one in reached:
        targets = one.pose_target.targets
        markers = [names.index(name) for name in targets]
        try:
            sensitivities = cable_sensitivities(simulation, one.pose, markers)
        except NotConvergedError:
            return float("inf")
        rows = len(markers) * simulation.robot.body.mesh.dim
        columns = spread_columns(simulation, one.pose, sensitivities, uncertainty, rows)
        squares.append(one.rms_error**2 + float((columns**2).sum()) / len(markers))
    return float(np.sqrt(np.mean(squares)))
