"""`verify`: error of a learned answer in the simulator; `exact_steps`, `solve_exactly`: steps that reduce it."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hydrostat.errors import InputError
from hydrostat.given import Point, check_type
from hydrostat.ik import IKOptions, IKStatus, Limits, Targets, Tracker, named_targets, solve_ik
from hydrostat.learning.known_contact import contact_facts
from hydrostat.learning.learned_model import LearnedModel, LearnedPose, Tier
from hydrostat.learning.sample_plan import physics_hash
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation


def verify(
    simulation: Simulation, model: LearnedModel, answer: LearnedPose, *, steps: int = 0, enough: float = 0.0
) -> LearnedPose:
    """Simulate a learned answer and return it with the simulated error, after exact Gauss-Newton steps if requested.

    The contractions are solved from rest, unless the answer was already certified for the same robot. Each step starts
    from the previous pose, as an update of `Tracker`. Without an equilibrium, `certified` is None and `status` gives
    the reason. The returned pose is the end of these steps: the same contractions, taken in from rest, may lead to
    another pose. To get the error from rest, call `verify(simulation, model, replace(found, pose=None))`.

    Args:
        simulation: simulation of the robot of the model.
        model: model that gave the answer.
        answer: answer of `LearnedModel.solve` or of this function.
        steps: maximum number of exact steps.
        enough: mean error below which no further step is taken [m]; this saves time if the answer is already good.

    Raises:
        InputError: a model of another robot.
    """
    check_type(simulation, Simulation, "simulation must be a Simulation(robot)")
    check_type(model, LearnedModel, "the model must be one that LearnedModel.load returns")
    check_type(answer, LearnedPose, "the answer must be what model.solve gives")
    if isinstance(steps, bool) or not isinstance(steps, int) or steps < 0:
        raise InputError(f"steps must be a whole number of 0 or more, not {steps!r:.60}")
    model.check(simulation.robot)
    pose = answer.pose
    if pose is None or not _same(pose.robot, simulation.robot):
        pose = simulation.solve(answer.contractions, strict=False)
    pose, taken = exact_steps(simulation, pose, answer.target, steps, enough=enough)
    found = model.evaluate(answer.target, pose.controls, Tier.STEP if taken else answer.tier)
    certified = _target_distances(answer, pose) if pose.result.converged else None
    return replace(found, certified=certified, status=pose.result.status, pose=pose)


def exact_steps(
    simulation: Simulation, pose: Equilibrium, target: Targets, steps: int, *, enough: float = 0.0
) -> tuple[Equilibrium, int]:
    """Take exact steps towards a target, each an update of `Tracker`; return the pose and the number of steps taken.

    If an update finds no better pose, it is tried again with a shorter step, up to 3 times in a row. A pose that is
    not in equilibrium is returned unchanged.

    Args:
        simulation: simulation of the robot.
        pose: start pose.
        target: target positions of the markers [m].
        steps: maximum number of steps.
        enough: mean error below which no further step is taken [m].

    Raises:
        InputError: as for `Tracker.update`.
    """
    if not (steps and pose.result.converged):
        return pose, 0
    goals = dict(named_targets(target)) if not isinstance(target, PoseTarget) else target.targets
    tracker, taken, tried = Tracker(simulation, start=pose), 0, 0
    tries = 3  # So many updates in a row may find nothing better; each tries shorter steps than the one before
    while taken < steps and tried < tries and _mean_error(pose, goals) > enough:
        reached = tracker.update(target, seconds=1.0)
        moved = not np.array_equal(reached.pose.controls, pose.controls)
        pose, taken, tried = reached.pose, taken + moved, 0 if moved else tried + 1
        if not moved and reached.status in (IKStatus.REACHED, IKStatus.LOCAL_OPTIMUM):
            break
    return pose, taken


def _mean_error(pose: Equilibrium, goals: Mapping[str, Point]) -> float:
    """Return the mean distance of the markers from their targets [m]."""
    return float(np.mean([np.linalg.norm(pose.markers[name] - np.asarray(goal)) for name, goal in goals.items()]))


def solve_exactly(
    simulation: Simulation,
    model: LearnedModel,
    answer: LearnedPose,
    *,
    limits: Limits | None = None,
    options: IKOptions | None = None,
) -> LearnedPose:
    """Run `solve_ik` from the pose of a learned answer, or from rest if that is not an equilibrium.

    Args:
        simulation: simulation of the robot of the model.
        model: model that gave the answer.
        answer: answer of `LearnedModel.solve`.
        limits: same as for `solve_ik`.
        options: same as for `solve_ik`.

    Raises:
        InputError: a model of another robot, or as for `solve_ik`.
        NotConvergedError: as for `solve_ik`.
    """
    start = verify(simulation, model, answer)
    begun = start.pose if start.certified is not None else None
    reached = solve_ik(simulation, answer.target, limits=limits, start=begun, options=options)
    found = model.evaluate(answer.target, reached.pose.controls, Tier.EXACT)
    return replace(found, certified=_target_distances(answer, reached.pose), status=reached.status, pose=reached.pose)


def _same(one: Robot, other: Robot) -> bool:
    """Return True if two robots have the same poses."""
    return one is other or (physics_hash(one), contact_facts(one)) == (physics_hash(other), contact_facts(other))


def _residual(answer: LearnedPose, pose: Equilibrium) -> np.ndarray:
    """From targets to markers [m], a row for each that was asked for."""
    return np.array([pose.markers[name] - np.asarray(point) for name, point in answer.target.targets.items()])


def _target_distances(answer: LearnedPose, pose: Equilibrium) -> dict[str, float]:
    distances = np.linalg.norm(_residual(answer, pose), axis=1).tolist()
    return dict(zip(answer.target.targets, distances, strict=True))
