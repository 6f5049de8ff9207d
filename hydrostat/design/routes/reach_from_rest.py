"""`reach_from_rest`: inverse kinematics of a pose that its contractions also lead to from rest."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hydrostat.design.routes.search_rules import RULES
from hydrostat.ik import IKOptions, IKResult, Limits, solve_ik
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Equilibrium, Simulation


def reach_from_rest(
    simulation: Simulation,
    target: PoseTarget,
    limits: Limits,
    options: IKOptions,
    *,
    start: Equilibrium | None = None,
    seconds: Callable[[], float | None] = lambda: None,
) -> IKResult:
    """The pose that is reached when its contractions are played from rest on, as the robot will.

    Inverse kinematics may end on a branch of equilibria that the straight way from rest does not lead to. Then it
    begins again where that leads, a few times. Raises NotConvergedError where there is no equilibrium on the way.
    """
    found = solve_ik(simulation, target, start=start, limits=limits, options=options, seconds=seconds())
    for _ in range(RULES.max_replays):
        played = simulation.solve(found.pose.contractions)
        apart = max(float(np.linalg.norm(played.markers[name] - place)) for name, place in found.pose.markers.items())
        if apart <= RULES.same_pose * simulation.robot.body.mesh.size:
            return found
        found = solve_ik(simulation, target, start=played, limits=limits, options=options, seconds=seconds())
    played = simulation.solve(found.pose.contractions)
    errors = {name: float(np.linalg.norm(played.markers[name] - place)) for name, place in target.targets.items()}
    return replace(found, pose=played, errors=errors)
