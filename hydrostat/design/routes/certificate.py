"""Optimality of a cable network: the gain of one more cable, and the descent left along moves that are allowed."""

from dataclasses import replace

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.design.network import Certificate
from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import linear_model
from hydrostat.design.routes.search_rules import RULES
from hydrostat.ik import solve_nonnegative


def certify(proposals: Proposals, trial: Trial) -> Certificate:
    """Compute the promise of one more cable, and the steepest descent of the error along an allowed move.

    Both are exact to first order at the equilibria of the poses; the search for the best path keeps a few paths for
    each edge, so what it finds is a lower bound of what the best of all paths would gain.
    """
    unbiased = replace(proposals, options=replace(proposals.options, lead_penalty=0.0))
    paths = unbiased.price_paths(trial, count=1)
    gain = paths[0].gain if paths else 0.0
    model = linear_model(proposals.evaluator, proposals.graph.region, trial, effort=0.0, reach=RULES.holding_margin)
    return Certificate(
        further=float(np.sqrt(max(trial.error**2 - 2 * gain, 0.0))),
        paths=len(proposals.graph.edges) * 2 * proposals.options.max_edges,
        descent_rate=_descent_rate(
            model.matrix, model.right, model.rows[model.left <= RULES.holding_margin], trial.error
        ),
    )


def _descent_rate(matrix: np.ndarray, right: Vector, limits: np.ndarray, error: float) -> float:
    """The steepest fall of the error along a number that limits which hold allow [m/m] (Karush, Kuhn and Tucker)."""
    if error == 0.0:
        return 0.0
    gradient = matrix.T @ right / error
    norms = np.linalg.norm(limits, axis=1)
    limits = limits[norms > 0] / norms[norms > 0, None]
    if len(limits):
        gradient = gradient + limits.T @ solve_nonnegative(limits.T, -gradient)
    return float(np.abs(gradient).max(initial=0.0))
