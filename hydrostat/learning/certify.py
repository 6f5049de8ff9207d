"""`certify`: what the simulator says of a learned answer, and how much nearer exact steps bring it."""

from dataclasses import replace

import numpy as np
from scipy.optimize import lsq_linear

from hydrostat.arrays import Vector
from hydrostat.errors import NotConvergedError
from hydrostat.ik import InverseOptions, Limits, solve_ik
from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.learned_pose import LearnedPose, Tier
from hydrostat.simulation import Simulation, SolvedPose


def certify(simulation: Simulation, model: LearnedModel, answer: LearnedPose, *, steps: int = 0) -> LearnedPose:
    """A learned answer with the error that the simulator finds, if asked after exact Gauss-Newton steps from there.

    The contractions are solved from rest, unless the answer was certified before; each step goes on from the pose
    before, and is taken back if it leads further away. Where no equilibrium is found, `certified` is None and `reason`
    says why.

    Args:
        simulation: of the robot that the model was learned of.
        model: whose answer it is.
        answer: what `LearnedModel.solve` or this gave.
        steps: exact steps to take.

    Raises:
        InputError: a model of another robot.
    """
    model.check(simulation.robot)
    pose = answer.pose or simulation.solve(answer.contractions, strict=False)
    for _ in range(steps if pose.result.converged else 0):
        further = _step(simulation, model, answer, pose)
        if further is None:
            break
        pose = further
    tier = Tier.STEP if steps else answer.tier
    found = model.judged(answer.target, pose.contractions, tier)
    certified = _missed(answer, pose) if pose.result.converged else None
    return replace(found, certified=certified, reason=pose.result.reason, pose=pose)


def solve_exactly(
    simulation: Simulation,
    model: LearnedModel,
    answer: LearnedPose,
    *,
    limits: Limits | None = None,
    options: InverseOptions | None = None,
) -> LearnedPose:
    """The answer of `solve_ik` that begins where a learned answer leads, from rest where that is no equilibrium.

    Args:
        simulation: of the robot that the model was learned of.
        model: whose answer it is.
        answer: what `LearnedModel.solve` gave.
        limits: as for `solve_ik`.
        options: as for `solve_ik`.

    Raises:
        InputError: a model of another robot, or as for `solve_ik`.
        NotConvergedError: as for `solve_ik`.
    """
    start = certify(simulation, model, answer)
    begun = start.pose if start.certified is not None else None
    reached = solve_ik(simulation, answer.target, limits=limits, start=begun, options=options)
    found = model.judged(answer.target, reached.pose.contractions, Tier.EXACT)
    return replace(found, certified=_missed(answer, reached.pose), reason=reached.reason, pose=reached.pose)


def _step(simulation: Simulation, model: LearnedModel, answer: LearnedPose, pose: SolvedPose) -> SolvedPose | None:
    """The pose one bounded Gauss-Newton step on; None if it is no nearer."""
    try:
        moves = simulation.jacobian(pose)
    except NotConvergedError:
        return None
    anchors, names = simulation.marker_anchors, [marker.name for marker in simulation.robot.markers]
    asked = [names.index(name) for name in answer.target.targets]
    slopes = np.einsum("pc,pcdw->pdw", anchors.weights, moves[anchors.stencils])[asked].reshape(-1, len(model.low))
    begun = pose.contractions
    change = bounded_step(slopes, _residual(answer, pose).ravel(), model.low - begun, model.high - begun)
    further = simulation.solve(pose.contractions + change, start=pose, strict=False)
    nearer = further.result.converged and np.linalg.norm(_residual(answer, further)) < np.linalg.norm(
        _residual(answer, pose)
    )
    return further if nearer else None


def bounded_step(slopes: np.ndarray, residual: Vector, low: Vector, high: Vector) -> Vector:
    """The change within limits that best undoes what is missed; the shortest where several do.

    Args:
        slopes: of what is missed, (rows, winches).
        residual: what is missed [m].
        low: least change of each winch [m].
        high: largest [m].
    """
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    some = _SHORT * np.sqrt(np.square(slopes).sum(axis=0).max(initial=0.0))
    rows = np.vstack([slopes, some * np.eye(len(low))])
    found = lsq_linear(rows, np.r_[-residual, np.zeros(len(low))], bounds=(low - _ROOM, high + _ROOM))
    return np.clip(found.x, low, high)


def _residual(answer: LearnedPose, pose: SolvedPose) -> np.ndarray:
    """From targets to markers [m], a row for each that was asked for."""
    return np.array([pose.markers[name] - np.asarray(point) for name, point in answer.target.targets.items()])


def _missed(answer: LearnedPose, pose: SolvedPose) -> dict[str, float]:
    distances = np.linalg.norm(_residual(answer, pose), axis=1).tolist()
    return dict(zip(answer.target.targets, distances, strict=True))


_SHORT = 1e-3
"""How much a change counts beside what it undoes, as a share of the steepest slope."""

_ROOM = 1e-12
"""Bounds are moved apart by so much [m], as an empty range is refused."""
