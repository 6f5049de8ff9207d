"""`reached_pose`: what a search found, in the words of its user."""

import numpy as np

from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.search.descend import Descent
from hydrostat.ik.search.inverse_search import InverseSearch
from hydrostat.robot import Pose


def reached_pose(search: InverseSearch, found: Descent, target: Pose | None) -> ReachedPose:
    """Pose that was found, with how near it is to an optimum and the limits that hold."""
    state, problem = found.state, search.problem
    pose = problem.simulation.posed(problem.bounds.spread @ state.values, state.result)
    return ReachedPose(
        target=target,
        pose=pose,
        errors=state.errors,
        reason=found.reason,
        iterations=found.iterations,
        solves=search.solves,
        optimality=problem.slope(state, found.weight),
        held=() if found.reason is InverseReason.REACHED else limits_that_hold(search, found),
    )


def limits_that_hold(search: InverseSearch, found: Descent) -> tuple[str, ...]:
    """Limits that hold, in words: winches at their ends, cables at their largest tension."""
    state, bounds, robot = found.state, search.problem.bounds, search.problem.simulation.robot
    words = []
    hair = _HAIR * bounds.span
    for channel, value in enumerate(state.values):
        winches = [winch.name for winch, own in zip(robot.winches, bounds.channels, strict=True) if own == channel]
        name = " and ".join(winches)
        if value >= bounds.high[channel] - hair[channel]:
            words.append(f"{name}: taken in as far as it may, {1e3 * value:.4g} mm")
        elif value <= bounds.low[channel] + hair[channel] and state.posture.tensions[bounds.cables == channel].any():
            words.append(f"{name}: let out as far as it may, {abs(round(1e3 * value, 3)):g} mm")
    full = state.posture.tensions >= (1.0 - _HAIR) * bounds.tension
    pulling = {robot.cables[cable].winch: bounds.tension[cable] for cable in np.flatnonzero(full)}
    words.extend(f"{name}: pulls as hard as it may, {most:.4g} N" for name, most in pulling.items())
    return tuple(words)


_HAIR = 1e-6
"""A limit holds within this share of it."""
