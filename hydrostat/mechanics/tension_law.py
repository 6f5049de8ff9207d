"""`TensionLaw`: tension of a cable against its stretch; and `spring`, the same for compiled loops."""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from numba import njit

from hydrostat.arrays import Vector
from hydrostat.kernel import INNER


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

    def energy(self, stretch: Vector) -> Vector:
        """Integral of the tension [J]."""
        k, eps = self.stiffness, self.smoothing
        within = np.clip(stretch, 0.0, 2 * eps)
        straight = 0.5 * (stretch - eps) ** 2 + eps**2 / 6
        return k * np.where(stretch > 2 * eps, straight, within**3 / (12 * eps))

    def tension(self, stretch: Vector) -> Vector:
        """T [N] (R26)."""
        k, eps = self.stiffness, self.smoothing
        within = np.clip(stretch, 0.0, 2 * eps)
        return k * np.where(stretch > 2 * eps, stretch - eps, within**2 / (4 * eps))

    def tangent(self, stretch: Vector) -> Vector:
        """dT/ds [N/m]."""
        return self.stiffness * np.clip(stretch / (2 * self.smoothing), 0.0, 1.0)

    def stretch(self, tension: Vector) -> Vector:
        """The stretch [m] at which a taut cable has this tension > 0 [N]."""
        k, eps = self.stiffness, self.smoothing
        share = np.maximum(tension, 0.0) / k
        return np.where(share > eps, share + eps, 2 * np.sqrt(eps * share))


@njit(**INNER)
@no_type_check
def spring(k, eps, stretch):
    """Energy, tension and its slope at one stretch; see `TensionLaw`."""
    if stretch <= 0.0:
        return 0.0, 0.0, 0.0
    if stretch <= 2.0 * eps:
        return k * stretch**3 / (12.0 * eps), k * stretch * stretch / (4.0 * eps), k * stretch / (2.0 * eps)
    return 0.5 * k * (stretch - eps) ** 2 + k * eps * eps / 6.0, k * (stretch - eps), k
