"""`certify`: what the simulator says of a learned answer, and how much nearer exact steps bring it."""

from dataclasses import replace

import numpy as np

from hydrostat.ik import InverseOptions, Limits, Targets, Tracker, solve_ik
from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.learned_pose import LearnedPose, Tier
from hydrostat.simulation import Simulation, SolvedPose


def certify(simulation: Simulation, model: LearnedModel, answer: LearnedPose, *, steps: int = 0) -> LearnedPose:
    """A learned answer with the error that the simulator finds, if asked after exact Gauss-Newton steps from there.

    The contractions are solved from rest, unless the answer was certified before; each step goes on from the pose
    before, as an update of `Tracker`. Where no equilibrium is found, `certified` is None and `reason` says why.

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
    pose = exact_steps(simulation, pose, answer.target, steps)
    tier = Tier.STEP if steps else answer.tier
    found = model.judged(answer.target, pose.contractions, tier)
    certified = _missed(answer, pose) if pose.result.converged else None
    return replace(found, certified=certified, reason=pose.result.reason, pose=pose)


def exact_steps(simulation: Simulation, pose: SolvedPose, target: Targets, steps: int) -> SolvedPose:
    """The pose after updates of `Tracker` towards a target; the same where it is no equilibrium.

    Raises:
        InputError: as for `Tracker.update`.
    """
    if steps and pose.result.converged:
        tracker = Tracker(simulation, start=pose)
        for _ in range(steps):
            pose = tracker.update(target, seconds=1.0).pose
    return pose


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


def _residual(answer: LearnedPose, pose: SolvedPose) -> np.ndarray:
    """From targets to markers [m], a row for each that was asked for."""
    return np.array([pose.markers[name] - np.asarray(point) for name, point in answer.target.targets.items()])


def _missed(answer: LearnedPose, pose: SolvedPose) -> dict[str, float]:
    distances = np.linalg.norm(_residual(answer, pose), axis=1).tolist()
    return dict(zip(answer.target.targets, distances, strict=True))
