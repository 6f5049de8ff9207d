"""`TensionLaw`: tension of a cable against its elongation; and `spring`, the same for compiled loops."""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Float
from numba import njit

from hydrostat.arrays import Vector
from hydrostat.kernel import INNER, KERNEL


@dataclass(frozen=True, kw_only=True, eq=False)
class TensionLaw:
    """The unilateral spring, shifted so that a cable at rest has no tension (R25, E1, E2, E3).

    T(s) = 0 for s <= 0; k s^2 / (4 eps) for 0 <= s <= 2 eps; k (s - eps) above. Its integral is C2.
    All is a row per cable.

    Attributes:
        stiffness: k [N/m], the thesis's 2K.
        smoothing: eps [m].
    """

    stiffness: Vector
    smoothing: Vector

    def energy(self, elongation: Vector) -> Vector:
        """Integral of the tension [J]."""
        return self._evaluate(elongation)[0]

    def tension(self, elongation: Vector) -> Vector:
        """T [N] (R26)."""
        return self._evaluate(elongation)[1]

    def tangent(self, elongation: Vector) -> Vector:
        """dT/ds [N/m]."""
        return self._evaluate(elongation)[2]

    def _evaluate(self, elongation: Vector) -> Float[np.ndarray, "three cables"]:
        stiffness, smoothing = self.stiffness, self.smoothing
        if elongation.shape != stiffness.shape:
            stiffness, smoothing, elongation = np.broadcast_arrays(stiffness, smoothing, elongation)
        found = np.empty((3, len(elongation)))
        _evaluate(stiffness, smoothing, np.ascontiguousarray(elongation), found)
        return found

    def elongation(self, tension: Vector) -> Vector:
        """The elongation [m] at which a taut cable has this tension > 0 [N]."""
        k, eps = self.stiffness, self.smoothing
        share = np.maximum(tension, 0.0) / k
        return np.where(share > eps, share + eps, 2 * np.sqrt(eps * share))


@njit(**INNER)
@no_type_check
def spring(k, eps, elongation):
    """Energy, tension and its slope at one elongation; see `TensionLaw`."""
    if elongation <= 0.0:
        return 0.0, 0.0, 0.0
    if elongation <= 2.0 * eps:
        return k * elongation**3 / (12.0 * eps), k * elongation * elongation / (4.0 * eps), k * elongation / (2.0 * eps)
    return 0.5 * k * (elongation - eps) ** 2 + k * eps * eps / 6.0, k * (elongation - eps), k


@njit(**KERNEL)
@no_type_check
def _evaluate(stiffness, smoothing, elongation, found):
    """Energy, tension and slope of every cable."""
    for cable in range(stiffness.shape[0]):
        found[0, cable], found[1, cable], found[2, cable] = spring(
            stiffness[cable], smoothing[cable], elongation[cable]
        )
