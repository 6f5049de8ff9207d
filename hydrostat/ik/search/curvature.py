"""`Curvature`: what Gauss-Newton leaves out of the Hessian, learnt from step to step."""

import numpy as np
from jaxtyping import Float

from hydrostat.ik.search.linear_model import LinearModel

Square = Float[np.ndarray, "channels channels"]


class Curvature:
    """An estimate of sum r_i d2r_i, which counts where a target is out of reach (Dennis, Gay and Welsch 1981).

    It follows from how the slopes of the residual change along a step. It is used only while it tells the objective
    better than Gauss-Newton alone does and that falls slowly, and forgotten when a cable becomes taut or slack.
    """

    def __init__(self) -> None:
        """Nothing is known yet."""
        self._matrix: Square | None = None
        self._trusted = False

    @property
    def matrix(self) -> Square | None:
        """The estimate, if it is to be used."""
        return self._matrix if self._trusted else None

    def doubt(self) -> bool:
        """Whether it had been used; it will not be for the next step."""
        used, self._trusted = self._trusted and self._matrix is not None, False
        return used

    def learn(self, old: LinearModel, new: LinearModel) -> None:
        """Take in a step from one model to the next."""
        if not old.alike(new):
            self._matrix, self._trusted = None, False
            return
        step = new.values - old.values
        plain = old.residual + old.matrix @ step
        missed = 0.5 * float(new.residual @ new.residual - plain @ plain)
        known = np.zeros((len(step), len(step))) if self._matrix is None else self._matrix
        if self._matrix is None:
            fallen = 0.5 * abs(float(old.residual @ old.residual - new.residual @ new.residual))
            self._trusted = abs(missed) > _POOR * fallen
        else:
            self._trusted = abs(missed - 0.5 * float(step @ known @ step)) < abs(missed)
        if new.residual @ new.residual < _FALLS * (old.residual @ old.residual):
            self._trusted = False
        self._matrix = _updated(
            known, step, new.gradient() - old.gradient(new.residual), new.gradient() - old.gradient()
        )


def _updated(known: Square, step: np.ndarray, change: np.ndarray, total: np.ndarray) -> Square:
    """The least change of an estimate that makes it true along a step, after it is scaled down if it is too large.

    Args:
        known: the estimate.
        step: of the channels.
        change: what it should be times the step.
        total: change of the whole gradient.
    """
    along = float(step @ total)
    if not along > 0.0:
        return known
    bent = float(step @ known @ step)
    if bent != 0.0:
        known = known * min(1.0, abs(float(step @ change)) / abs(bent))
    miss = change - known @ step
    outer = np.outer(miss, total)
    return known + (outer + outer.T) / along - float(step @ miss) / along**2 * np.outer(total, total)


_FALLS = 0.25
"""Where squares fall to less than this share in a step, Gauss-Newton is on its way to a target in reach."""

_POOR = 0.1
"""Gauss-Newton is poor if it misses the fall of the objective by this share."""
