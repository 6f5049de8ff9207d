"""Cables during one step of Newton: `settle` finds their tensions, `Tightener` brings these about."""

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.cable import CableEnergy, TensionLaw
from hydrostat.mechanics.stiffness import Stiffness


class Tightener:
    """The second-order correction of a step, for cables much stiffer than the body.

    Newton knows a cable's length to first order; what it misses, squared and times the stiffness of a cable, swamps all
    that the step gains, so the line search would cut it short. Here nodes move on by -Z y, Z the moves of the body when
    the cables pull, until each cable has its promised tension plus y: the least of a convex function of one number a
    cable, for which lengths of cables are all that has to be measured.
    """

    def __init__(self, cables: CableEnergy, controls: Vector, stiffness: Stiffness) -> None:
        """Cables at their controls, and the body about the state where the step begins.

        A body that is held by its cables alone has negative compliances; extra stiffness along the cables mends that.
        """
        self._cables, self._controls = cables, controls
        compliance = stiffness.compliance
        extra = 10.0 / np.maximum(np.abs(compliance.diagonal()), np.finfo(float).tiny)
        for _ in range(20):
            softened = np.linalg.solve(np.eye(len(extra)) + compliance * extra, np.eye(len(extra)))
            metric = compliance @ softened
            metric = 0.5 * (metric + metric.T)
            if np.linalg.eigvalsh(metric)[0] > 0:
                break
            extra = 4 * extra
        self._metric, self._moves = metric, stiffness.moves @ softened

    def __call__(self, nodes: Nodes, promised: Vector) -> Nodes:
        """Nodes moved on until the cables have about the promised tensions [N]."""
        law, near = self._cables.law, _NEAR * max(float(promised.max()), np.finfo(float).tiny)
        change = np.zeros(len(promised))
        at = nodes
        value, stretches = self._value(at, change, promised)
        for _ in range(_ITERATIONS):
            tensions = law.tension(stretches)
            if np.abs(tensions - promised - change).max() <= near:
                break
            slopes = self._cables.columns(at).T @ self._moves
            gradient = self._metric @ (promised + change) - slopes.T @ tensions
            curvature = self._metric + slopes.T @ (law.tangent(stretches)[:, None] * slopes)
            direction = -np.linalg.solve(curvature, gradient)
            slope = float(gradient @ direction)
            for halving in range(_HALVINGS):
                trial = change + 0.5**halving * direction
                moved = nodes - (self._moves @ trial).reshape(nodes.shape)
                reached, lengths = self._value(moved, trial, promised)
                if reached <= value + 1e-4 * 0.5**halving * slope:
                    break
            else:
                break
            change, at, value, stretches = trial, moved, reached, lengths
        return at

    def _value(self, nodes: Nodes, change: Vector, promised: Vector) -> tuple[float, Vector]:
        stretches = self._cables.stretches(nodes, self._controls)
        cost = float((promised + 0.5 * change) @ self._metric @ change)
        return cost + float(self._cables.law.energy(stretches).sum()), stretches


def settle(law: TensionLaw, stretches: Vector, compliance: np.ndarray) -> Vector | None:
    """Tensions at which cables on a linear body come to rest; None if that is not found.

    The body gives way by compliance @ tensions, so T = law(stretches - compliance @ T): the least of a convex function
    of one number a cable. Unlike a linear law it knows that a slack cable does not push.

    Args:
        law: of the cables.
        stretches: of each cable on a body that does not yet feel them [m].
        compliance: positive semidefinite, (cables, cables) [m/N].
    """
    tensions = np.zeros_like(stretches)
    remaining = stretches
    value = float(law.energy(remaining).sum())
    for _ in range(_SETTLING):
        wanted = law.tension(remaining)
        miss = wanted - tensions
        if np.abs(miss).max(initial=0.0) <= 1e-12 * np.abs(wanted).max(initial=0.0):
            return tensions
        change = np.linalg.solve(np.eye(len(miss)) + law.tangent(remaining)[:, None] * compliance, miss)
        slope = -float(miss @ compliance @ change)
        for halving in range(_HALVINGS):
            trial = tensions + 0.5**halving * change
            yielded = compliance @ trial
            after = stretches - yielded
            reached = 0.5 * float(trial @ yielded) + float(law.energy(after).sum())
            if reached <= value + 1e-4 * 0.5**halving * slope + 1e-14 * abs(value):
                break
        else:
            return None
        tensions, remaining, value = trial, after, reached
    return tensions


_NEAR = 1e-2
"""A tension this close to the promised one, as a share of the largest, is close enough."""

_ITERATIONS = 12
_SETTLING = 30
_HALVINGS = 12
