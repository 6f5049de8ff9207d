"""`solve_ik`: the contractions that bring a robot nearest to a pose."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik.limits import Bounds, Limits, bounds
from hydrostat.ik.marker_goal import MarkerGoal
from hydrostat.ik.objective import Objective
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.search import InverseOptions, Search, State
from hydrostat.robot import Point, Pose, Robot
from hydrostat.simulation import Simulation, SolvedPose


def solve_ik(
    simulation: Simulation,
    targets: Pose | Mapping[str, Point] | None = None,
    *,
    limits: Limits | None = None,
    objectives: Sequence[Objective] = (),
    start: SolvedPose | None = None,
    options: InverseOptions | None = None,
) -> ReachedPose:
    """Bounded Gauss-Newton through the sensitivities of the equilibrium (R31 to R33, E18).

    Minimises half the squares of what targets and objectives miss while the winches stay within their limits. Each step
    is linearised by dx/da; equilibria on the way are only as sharp as they must be, the last one is exact. The answer
    is a local optimum. The method: docs/theory/inverse.md.

    Args:
        simulation: the robot's physics.
        targets: where markers should go [m].
        limits: what the winches may do, beside their travel and release.
        objectives: more that is wished for, or instead.
        start: a pose to begin from, and to measure rates from; the rest pose if left out.
        options: tolerances and limits of the search.

    Raises:
        InputError: nothing to reach, something that the robot does not have, limits without room, a robot without
            cables or with friction.
        NotConvergedError: no equilibrium where the search begins.
    """
    target = targets if isinstance(targets, Pose) else Pose(name="target", targets=dict(targets or {}))
    wishes = [*([MarkerGoal(targets=target.targets)] if target.targets else []), *objectives]
    if not wishes:
        raise InputError("there is nothing to reach: give targets for markers, or objectives")
    search = Search(
        simulation,
        [wish.on(simulation) for wish in wishes],
        bounds(simulation, limits or Limits()),
        options or InverseOptions(),
    )
    begun = search.begin(start)
    if begun is None:
        raise NotConvergedError("inverse kinematics has no equilibrium to begin from; give another start")
    found = descend(search, begun)
    return found.answer(search, target)
