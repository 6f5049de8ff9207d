"""`corrected_errors`, `expected_corrected_error`: pose errors of built robots after one correction by a measurement."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.built_error import BuiltErrors, mean_square
from hydrostat.design.spread import spread_columns
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.errors import NotConvergedError
from hydrostat.ik import CORRECTION_DAMPING, IKResult, Limits, correct_contractions
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation, cable_sensitivities

MEASURED = 5
"""Number of markers that are measured in each pose, if it has that many targets."""

NOISE = 5e-4
"""Standard deviation of each measured coordinate [m]: a ruler or a photo."""


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

    The robots are those of `built_errors` with the same seed. Each pose is corrected by itself, by
    `hydrostat.ik.correct_contractions`, from the markers of `spread_markers`.

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
    before, after = [], []
    for number in range(draws):
        built = Simulation(uncertainty.draw(robot, np.random.default_rng([seed, number])))
        chance = np.random.default_rng([seed, number, 1])
        first, second = [], []
        for one, chosen in zip(reached, names, strict=True):
            played = built.solve(one.pose.contractions, strict=False)
            first.append(mean_square(played, one.pose_target))
            if played.result.converged:
                places = {
                    name: played.markers[name] + noise * chance.standard_normal(rest[name].shape) for name in chosen
                }
                contractions = correct_contractions(model, one, places, limits=limits)
                played = built.solve(contractions, strict=False)
            second.append(mean_square(played, one.pose_target))
        before.append(np.sqrt(np.mean(first)))
        after.append(np.sqrt(np.mean(second)))
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
    names, squares = list(rest), []
    for one in reached:
        targets = list(one.pose_target.targets)
        chosen = spread_markers({name: rest[name] for name in targets}, measured)
        try:
            sensitivities = cable_sensitivities(simulation, one.pose, [names.index(name) for name in targets])
        except NotConvergedError:
            return float("inf")
        dim = simulation.robot.body.mesh.dim
        rows = dim * len(targets)
        columns = spread_columns(simulation, one.pose, sensitivities, uncertainty, rows)
        jacobian, seen = sensitivities.contractions[:rows], np.repeat([name in chosen for name in targets], dim)
        normal = jacobian.T @ jacobian + CORRECTION_DAMPING**2 * np.eye(jacobian.shape[1])
        back = jacobian @ np.linalg.solve(normal, jacobian.T) * seen
        left = float(((columns - back @ columns) ** 2).sum()) + noise**2 * float((back**2).sum())
        squares.append(one.rms_error**2 + left / len(targets))
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
