"""`solve_pulls`: the equilibrium at given pulls of winches, in place of contractions."""

from collections.abc import Mapping

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.given import check_number
from hydrostat.ik.objectives.objective import StateJacobian, winch_to_cable_matrix
from hydrostat.simulation import Contractions, Equilibrium, Simulation

TOLERANCE = 1e-6
STEPS = 60
MAX_STEP = 0.1
"""Longest change of a contraction in a step, as a share of the size of the body."""


def solve_pulls(
    simulation: Simulation,
    pulls: Mapping[str, float],
    contractions: Contractions | None = None,
    *,
    start: Equilibrium | None = None,
) -> Equilibrium:
    """Solve for the equilibrium at given pull forces of some winches, by Newton's method on their contractions.

    The pull of a winch is its torque divided by its spool radius: the sum of its cable tensions times their spool
    ratios. Travel limits are not checked: compare `pose.contractions` with them.

    Args:
        simulation: simulation of the robot.
        pulls: pull of each winch by name [N], at least 0.
        contractions: contractions of all other winches [m], and drive values; 0 by default.
        start: start pose; the rest pose if left out.

    Raises:
        InputError: an unknown winch, a winch that pulls both ways, or a pull below 0.
        NotConvergedError: no such equilibrium was found, for example beyond a snap-through.
    """
    names = [winch.name for winch in simulation.robot.winches]
    for name, pull in pulls.items():
        simulation.robot.winch(name)
        if any(cable.reverse for cable in simulation.robot.cables if cable.winch == name):
            raise InputError(f'pulls.{name}: winch "{name}" pulls both ways; give its contraction instead')
        check_number(f"pulls.{name}", pull, "N")
        if pull < 0:
            raise InputError(f"pulls.{name} must be at least 0 N, not {pull:g}: a cable only pulls")
    own = np.array([names.index(name) for name in pulls], dtype=int)
    goal = np.array([float(pull) for pull in pulls.values()])
    given = simulation.as_contractions(contractions or {})
    if start is not None:
        given[own] = start.contractions[own]
    pose = simulation.solve(given, start=start)
    ratios = winch_to_cable_matrix(simulation)[:, own]
    allowed = TOLERANCE * max(float(goal.max(initial=0.0)), 1e-3)
    missing = goal - ratios.T @ pose.tensions
    for _ in range(STEPS):
        if np.abs(missing).max(initial=0.0) <= allowed:
            return pose
        step = _newton_step(simulation, pose, ratios, own, missing)
        pose, missing = _search(simulation, pose, own, step, goal, ratios, missing)
    left = ", ".join(f"{name} {gap:+.3g} N" for name, gap in zip(pulls, missing, strict=True))
    raise NotConvergedError(f"no equilibrium with these pulls was found; still missing: {left}", pose.result)


def _newton_step(simulation: Simulation, pose: Equilibrium, ratios: np.ndarray, own: Vector, missing: Vector) -> Vector:
    """Change of the contractions that would give the pulls, were the derivatives constant; at most `MAX_STEP`."""
    cables = simulation.cables
    derivatives = ratios.T @ StateJacobian.at(simulation, pose).tensions[:, own]
    slack = cables.elongations(pose.nodes, pose.contractions) <= 0
    # A winch whose cables are slack goes on until the first is taut.
    gaps = np.where(slack, -cables.elongations(pose.nodes, pose.contractions), 0.0) + 0.5 * cables.law.smoothing
    step, longest = np.zeros(len(own)), MAX_STEP * simulation.robot.body.mesh.size
    idle = np.array([bool(slack[column > 0].all()) for column in ratios.T], dtype=bool)
    for index in np.flatnonzero(idle & (missing > 0)):
        mine = ratios[:, index] > 0
        step[index] = float((gaps[mine] / ratios[mine, index]).min(initial=longest))
    live = ~idle
    if live.any():
        step[live] = np.linalg.lstsq(derivatives[np.ix_(live, live)], missing[live], rcond=1e-10)[0]
    return step * min(1.0, longest / max(float(np.abs(step).max()), 1e-300))


def _search(
    simulation: Simulation,
    pose: Equilibrium,
    own: Vector,
    step: Vector,
    goal: Vector,
    ratios: np.ndarray,
    missing: Vector,
) -> tuple[Equilibrium, Vector]:
    """Pose after the longest part of a step that brings the pulls nearer, and what is still missing [N]."""
    before, halvings = float(np.abs(missing).max()), 8
    for halving in range(halvings):
        controls = pose.controls.copy()
        controls[own] += 0.5**halving * step
        try:
            found = simulation.solve(controls, start=pose)
        except (NotConvergedError, InputError):  # it may take in more cable than there is
            continue
        gap = goal - ratios.T @ found.tensions
        if float(np.abs(gap).max()) < before or not (ratios.T @ pose.tensions).any():
            return found, gap
    raise NotConvergedError("no step brings the pulls nearer: they are too large, or the robot snaps", pose.result)
