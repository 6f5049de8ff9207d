"""Checks of an `Energy` for the solver besides its derivatives: laws, steps, supports, loads, history."""

from collections.abc import Iterable

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import Energy, LowRankStiffness
from hydrostat.testing.differences import ConformanceError

_TINY = np.finfo(float).tiny


def check_law(part: LowRankStiffness) -> None:
    """Check that D is the tangent of the law, and that the forces it finds on a body that gives way balance."""
    assert part.law is not None
    assert part.elongations is not None
    tangents = np.diag(part.law.tangent(part.elongations))
    miss = _largest(part.weights - tangents) / (_largest(tangents) or 1.0)
    if miss > 1e-9:
        raise ConformanceError("low_rank_hessian", "D is not the tangent of its law", relative_error=miss)
    for softness in (1e-6, 1.0, 1e3):
        compliance = softness / (_largest(tangents) or 1.0) * np.eye(len(tangents))
        tensions = part.law.solve_slack_complementarity(part.elongations, compliance)
        if tensions is None:
            raise ConformanceError("low_rank_hessian", "its law finds no balance on a body that gives way evenly")
        wanted = part.law.tension(part.elongations - compliance @ tensions)
        off = _largest(wanted - tensions) / (_largest(tensions) or 1.0)
        if off > 1e-6:
            raise ConformanceError("low_rank_hessian", "the forces of its law do not balance", relative_error=off)


def check_steps(energy: Energy, nodes: Nodes, controls: Vector, states: Iterable[Nodes]) -> None:
    """Check that largest force and step are in their range, and that the terms near a place stay.

    The energy must be finite wherever its largest step from `nodes` towards one of the `states` leads.
    """
    force = energy.largest_force(nodes, controls)
    if not (np.isfinite(force) and force >= 0.0):
        raise ConformanceError("largest force", f"it must be finite and not negative, not {force:g}")
    for goal in states:
        share = energy.largest_step(nodes, goal - nodes)
        if not 0.0 < share <= 1.0:
            raise ConformanceError("largest step", f"it must be above 0 and at most 1, not {share:g}")
        reached = nodes + share * (goal - nodes)
        if share < 1.0 and not np.isfinite(energy.with_active_terms(reached).value(reached, controls)):
            raise ConformanceError("largest step", "the energy is not finite where it allows the nodes to go")
    near = energy.with_active_terms(nodes)
    if not np.array_equal(near.with_active_terms(nodes).stencils, near.stencils):
        raise ConformanceError("near", "asked again at the same nodes it has other terms")


def check_supports(energy: Energy, nodes: Nodes, controls: Vector) -> None:
    """Check that supports that have not moved change nothing, and that an energy they alone hold goes with them."""
    count = 0 if energy.supports is None else int(energy.supports.max(initial=-1)) + 1
    value = energy.value(nodes, controls)
    for shift in (0.0, 0.01 * float(np.ptp(nodes, axis=0).max())):
        moved = energy.with_supports_moved(np.full((count, nodes.shape[1]), shift))
        here = moved.value(nodes + (shift if count else 0.0), controls)
        if abs(here - value) > 1e-9 * max(abs(value), _TINY):
            raise ConformanceError("supports", "moved together with its supports it has another value")


def check_loads(energy: Energy, nodes: Nodes, controls: Vector) -> None:
    """Check that a whole load is the energy itself, and that the work told of loads is that of the forces they add.

    The works of all other parameters must be finite numbers in vectors.
    """
    field = np.random.default_rng(0).standard_normal(nodes.shape)
    works = energy.parameter_derivative(nodes, field)
    for name, work in works.items():
        if not (np.ndim(work) == 1 and np.isfinite(work).all()):
            raise ConformanceError("parameters", f"the work of {name} must be finite numbers in a vector")
    whole, full, none = (
        float(np.vdot(_forces(one, nodes, controls), field))
        for one in (energy, energy.with_load(1.0), energy.with_load(0.0))
    )
    if abs(full - whole) > 1e-9 * max(abs(whole), _TINY):
        raise ConformanceError("load", "with its whole load it is not what it was")
    if abs(float(np.sum(works.get("load", 0.0))) - (full - none)) > 1e-6 * max(abs(full - none), _TINY):
        raise ConformanceError("parameters", "the work of the load is not that of the forces it adds")


def check_history(energy: Energy, nodes: Nodes, controls: Vector) -> None:
    """Check that an energy with a history goes on from it as if it had never stopped, and others remember nothing."""
    if not energy.has_history:
        if (
            len(energy.history)
            or energy.history_residual(nodes, controls)
            or energy.with_advanced_history(nodes, controls) is not energy
        ):
            raise ConformanceError("history", "an energy that remembers must say so by `has_history`")
        return
    after = energy.with_advanced_history(nodes, controls)
    resumed = energy.with_history(after.history, nodes, controls)
    if np.abs(resumed.history - after.history).max(initial=0.0) > 0:
        raise ConformanceError("history", "resumed from what it remembers it remembers something else")
    first, second = (one.value(nodes, controls) for one in (after, resumed))
    if abs(first - second) > 1e-9 * max(abs(first), _TINY):
        raise ConformanceError("history", "resumed from what it remembers it has another value")
    left = energy.with_corrected_history(nodes, controls, None).history_residual(nodes, controls)
    if left > 1e-6 * energy.largest_force(nodes, controls) and left >= energy.history_residual(nodes, controls):
        raise ConformanceError("history", "a correction brings it no nearer to balance")


def _forces(energy: Energy, nodes: Nodes, controls: Vector) -> np.ndarray:
    total = np.zeros(nodes.shape)
    np.add.at(total, energy.stencils, energy.gradient(nodes, controls))
    return total


def _largest(array: np.ndarray) -> float:
    return float(np.abs(array).max(initial=0.0))
