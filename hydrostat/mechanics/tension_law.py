"""`TensionLaw`: tension of a cable against its elongation; and `spring`, the same for compiled loops."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import RankMatrix


@dataclass(frozen=True, kw_only=True, eq=False)
class TensionLaw:
    """Unilateral spring by its elongation, shifted so that a cable at rest has no tension (R25, E1, E2, E3).

    T(s) = 0 for s <= 0; k s^2 / (4 eps) for 0 <= s <= 2 eps; k (s - eps) above. Its integral is C2.
    All is a row per cable.

    Attributes:
        stiffness: stiffness k [N/m] (2K in Chang 2018).
        smoothing: smoothing length eps [m].
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
        native.evaluate(stiffness, smoothing, np.ascontiguousarray(elongation), found)
        return found

    def elongation(self, tension: Vector) -> Vector:
        """Elongation [m] at which a taut cable has this tension > 0 [N]."""
        k, eps = self.stiffness, self.smoothing
        share = np.maximum(tension, 0.0) / k
        return np.where(share > eps, share + eps, 2 * np.sqrt(eps * share))

    def solve_slack_complementarity(self, elongations: Vector, compliance: RankMatrix) -> Vector | None:
        """Tensions of cables on a linear body at rest, as a complementarity problem; None if they are not found.

        The body gives way by compliance @ tensions, so T = law(elongations - compliance @ T): the least of a convex
        function of one number a cable. This knows, as a linear law does not, that a slack cable does not push.

        Args:
            elongations: elongation of each cable on the body before it deforms under them [m].
            compliance: positive semidefinite, (cables, cables) [m/N].
        """
        tensions = np.zeros_like(elongations)
        found = native.balance(self.stiffness, self.smoothing, elongations, compliance, tensions)
        return tensions if found else None
