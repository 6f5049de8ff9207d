"""`corrected_errors`, `expected_corrected_error`: pose errors of built robots after one correction by a measurement."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.built_error import BuiltErrors, mean_square
from hydrostat.design.marker_estimator import NOISE, MarkerEstimator
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import NotConvergedError
from hydrostat.ik import CORRECTION_DAMPING, IKResult, Limits, correct_contractions
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

MEASURED = 5
"""Number of markers that are measured in each pose, if it has that many targets."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CorrectedErrors(BuiltErrors):
    """Errors after one correction; `played` are those of the same robots before it, as `built_errors` has them."""

    played: BuiltErrors


def corrected_errors(
    robot: Robot,
    reached: Sequence[IKResult],
    uncertainty: BuildTolerances,
    *,
    limits: Limits | None = None,
    measured: int = MEASURED,
    noise: float = NOISE,
    draws: int = 40,
    seed: int = 0,
) -> CorrectedErrors:
    """Play poses on robots drawn at random, measure markers, correct the contractions once and play again.

    The robots are those of `built_errors` with the same seed. The markers of `spread_markers` are measured in all
    poses, `MarkerEstimator` finds the others, and `hydrostat.ik.correct_contractions` corrects each pose.

    Args:
        robot: the robot of the design.
        reached: its poses, as its own winches reach them in the model.
        uncertainty: build tolerances.
        limits: limits of the winches, in addition to travel and release.
        measured: maximum number of measured markers in each pose.
        noise: standard deviation of each measured coordinate [m].
        draws: number of robots.
        seed: random seed.
    """
    model, rest = Simulation(robot), {marker.name: np.array(marker.at) for marker in robot.markers}
    names = [spread_markers({name: rest[name] for name in one.pose_target.targets}, measured) for one in reached]
    estimator = MarkerEstimator.of(model, reached, uncertainty, noise=noise)
    before, after = [], []
    for number in range(draws):
        built = Simulation(uncertainty.draw(robot, np.random.default_rng([seed, number])))
        chance = np.random.default_rng([seed, number, 1])
        played = [built.solve(one.pose.contractions, strict=False) for one in reached]
        seen = [
            {name: pose.markers[name] + noise * chance.standard_normal(rest[name].shape) for name in chosen}
            if pose.result.converged
            else {}
            for pose, chosen in zip(played, names, strict=True)
        ]
        again = [
            built.solve(correct_contractions(model, one, places, limits=limits), strict=False)
            if pose.result.converged
            else pose
            for one, pose, places in zip(reached, played, estimator.estimate(seen), strict=True)
        ]
        for errors, poses in ((before, played), (after, again)):
            squares = [mean_square(pose, one.pose_target) for pose, one in zip(poses, reached, strict=True)]
            errors.append(np.sqrt(np.mean(squares)))
    own = float(np.sqrt(np.mean([one.rms_error**2 for one in reached])))
    uncorrected = BuiltErrors(drawn=np.array(before), model=own)
    return CorrectedErrors(drawn=np.array(after), model=own, played=uncorrected)


def expected_corrected_error(
    simulation: Simulation,
    reached: Sequence[IKResult],
    uncertainty: BuildTolerances,
    *,
    measured: int = MEASURED,
    noise: float = NOISE,
) -> float:
    """Root mean square of the marker error over poses and built robots after one correction [m], to first order.

    As `expected_error`, with what the correction takes back of each tolerance. Limits of winches do not count here,
    and a slack cable does not help. Infinite at a pose that is about to snap.
    """
    rest = {marker.name: np.array(marker.at) for marker in simulation.robot.markers}
    names = [spread_markers({name: rest[name] for name in one.pose_target.targets}, measured) for one in reached]
    try:
        estimator = MarkerEstimator.of(simulation, reached, uncertainty, noise=noise)
    except NotConvergedError:
        return float("inf")
    gain, squares = estimator.gain(names), []
    shown = gain @ estimator.known_columns(names)
    for one, sensitivity, columns in zip(reached, estimator.sensitivities, estimator.columns, strict=True):
        jacobian = sensitivity.contractions[: len(columns)]
        normal = jacobian.T @ jacobian + CORRECTION_DAMPING**2 * np.eye(jacobian.shape[1])
        back = jacobian @ np.linalg.solve(normal, jacobian.T) @ columns
        left = float(((columns - back @ shown) ** 2).sum()) + noise**2 * float(((back @ gain) ** 2).sum())
        squares.append(one.rms_error**2 + left / len(one.pose_target.targets))
    return float(np.sqrt(np.mean(squares)))


def spread_markers(places: dict[str, Vector], count: int) -> list[str]:
    """Names of up to `count` places: the farthest from their mean, then each time the farthest from those chosen."""
    if len(places) <= count:
        return list(places)
    near = [np.mean(list(places.values()), axis=0)]
    chosen: list[str] = []
    while len(chosen) < count:
        left = [name for name in places if name not in chosen]
        chosen.append(max(left, key=lambda name: min(float(np.linalg.norm(places[name] - one)) for one in near)))
        near = [places[name] for name in chosen]
    return chosen
