"""`correct_contractions`: one round of correction by measured markers, after a pose was played on the built robot."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.given import check_type
from hydrostat.ik.ik_result import IKResult
from hydrostat.ik.inverse_kinematics import solve_ik
from hydrostat.ik.limits import Limits
from hydrostat.ik.objectives.marker_target import named_targets
from hydrostat.ik.objectives.pose_regularizer import ClosenessKind, PoseRegularizer
from hydrostat.ik.search.problem import IKOptions
from hydrostat.simulation import Simulation

CORRECTION_DAMPING = 0.35
"""Default marker error that a change of a contraction is worth [m/m]."""


def correct_contractions(
    simulation: Simulation,
    reached: IKResult,
    measured: Mapping[str, Sequence[float] | Vector],
    *,
    limits: Limits | None = None,
    damping: float = CORRECTION_DAMPING,
) -> Vector:
    """Return contractions that take back measured marker errors, solved again in the model from the pose played [m].

    Values of drives follow those of the winches.

    Play `reached.pose.contractions` on the built robot, measure markers, then play the answer. Each target moves by
    the difference of model and measurement; a marker that is not measured keeps its target. The search stays near the
    contractions played, for winches with nearly the same effect would move far for a small measured error.

    Args:
        simulation: model of the robot.
        reached: pose that was played, with its targets.
        measured: measured positions of markers of the pose [m].
        limits: limits of the winches, in addition to travel and release.
        damping: marker error that a change of a contraction is worth [m/m]; 0 trusts the model.

    Raises:
        InputError: a marker without a target in this pose, a position that is not in the body's space, or a pose of
            another robot.
    """
    check_type(reached, IKResult, "reached must be a result of solve_ik")
    targets = reached.pose_target.targets
    seen = named_targets(measured)
    for name in seen:
        if name not in targets:
            raise InputError(
                f'pose "{reached.pose_target.name}" has no target for marker "{name}". Measure its targets.'
            )
        if np.shape(seen[name]) != np.shape(targets[name]) or not np.isfinite(seen[name]).all():
            raise InputError(f'marker "{name}": measured position must be {len(targets[name])} finite numbers [m]')
    moved = {name: np.subtract(place, reached.pose.markers[name]) for name, place in seen.items()}
    wanted = {name: tuple(np.subtract(to, moved.get(name, 0.0)).tolist()) for name, to in targets.items()}
    near = PoseRegularizer(pose=reached.pose, of=ClosenessKind.CONTRACTIONS, weight=damping)
    found = solve_ik(simulation, wanted, limits=limits, objectives=[near], start=reached.pose, options=_FROM_HERE)
    return found.pose.controls


_FROM_HERE = IKOptions(restarts=0, min_tension=False, hold_free_markers=False)
