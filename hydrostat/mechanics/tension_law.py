"""`TensionLaw`: tension of a cable against its elongation; and `spring`, the same for compiled loops."""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.kernel import INNER, Kernel, njit
from hydrostat.mechanics.energy import Small


@dataclass(frozen=True, kw_only=True, eq=False)
class TensionLaw:
    """Unilateral spring by its elongation, shifted so that a cable at rest has no tension (R25, E1, E2, E3).

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

    def balance(self, elongations: Vector, compliance: Small) -> Vector | None:
        """Tensions of cables on a linear body at rest, as a complementarity problem; None if they are not found.

        The body gives way by compliance @ tensions, so T = law(elongations - compliance @ T): the least of a convex
        function of one number a cable. This knows, as a linear law does not, that a slack cable does not push.

        Args:
            elongations: of each cable on a body that does not yet feel them [m].
            compliance: positive semidefinite, (cables, cables) [m/N].
        """
        tensions = np.zeros_like(elongations)
        found = _balance(self.stiffness, self.smoothing, elongations, compliance, tensions)
        return tensions if found else None


@njit(**INNER)
@no_type_check
def spring(k, eps, elongation):
    """Energy, tension and its slope at one elongation; see `TensionLaw`."""
    if elongation <= 0.0:
        return 0.0, 0.0, 0.0
    if elongation <= 2.0 * eps:
        return k * elongation**3 / (12.0 * eps), k * elongation * elongation / (4.0 * eps), k * elongation / (2.0 * eps)
    return 0.5 * k * (elongation - eps) ** 2 + k * eps * eps / 6.0, k * (elongation - eps), k


@Kernel
@no_type_check
def _evaluate(stiffness, smoothing, elongation, found):
    """Energy, tension and slope of every cable."""
    for cable in range(stiffness.shape[0]):
        found[0, cable], found[1, cable], found[2, cable] = spring(
            stiffness[cable], smoothing[cable], elongation[cable]
        )


_BALANCING = 30
_HALVINGS = 12


@njit(**INNER)
@no_type_check
def _eliminate(matrix, right):
    """Solve a small system in place, with pivoting; false if it is singular."""
    size = right.shape[0]
    for column in range(size):
        pivot = column
        for row in range(column + 1, size):
            if abs(matrix[row, column]) > abs(matrix[pivot, column]):
                pivot = row
        if not abs(matrix[pivot, column]) > 0.0:
            return False
        if pivot != column:
            for other in range(column, size):
                matrix[column, other], matrix[pivot, other] = matrix[pivot, other], matrix[column, other]
            right[column], right[pivot] = right[pivot], right[column]
        for row in range(column + 1, size):
            factor = matrix[row, column] / matrix[column, column]
            if factor != 0.0:
                for other in range(column + 1, size):
                    matrix[row, other] -= factor * matrix[column, other]
                right[row] -= factor * right[column]
    for row in range(size - 1, -1, -1):
        total = right[row]
        for other in range(row + 1, size):
            total -= matrix[row, other] * right[other]
        right[row] = total / matrix[row, row]
    return True


@Kernel
@no_type_check
def _balance(stiffness, smoothing, elongations, compliance, tensions):
    """Newton with a line search on T M T / 2 + U(elongations - M T); false if it does not arrive."""
    count = tensions.shape[0]
    matrix = np.empty((count, count))
    change, trial, remaining, slopes = np.empty(count), np.empty(count), elongations.copy(), np.empty(count)
    value = 0.0
    for cable in range(count):
        value += spring(stiffness[cable], smoothing[cable], remaining[cable])[0]
    for _ in range(_BALANCING):
        largest = missing = 0.0
        for cable in range(count):
            _, wanted, slopes[cable] = spring(stiffness[cable], smoothing[cable], remaining[cable])
            change[cable] = wanted - tensions[cable]
            largest, missing = max(largest, wanted), max(missing, abs(change[cable]))
        if missing <= 1e-12 * largest:
            return True
        slope = 0.0
        for row in range(count):
            trial[row] = 0.0
            for column in range(count):
                trial[row] += compliance[row, column] * change[column]
                matrix[row, column] = slopes[row] * compliance[row, column] + (1.0 if row == column else 0.0)
        if not _eliminate(matrix, change):
            return False
        for cable in range(count):
            slope -= trial[cable] * change[cable]
        length, found = 1.0, False
        for _ in range(_HALVINGS):
            reached = 0.0
            for row in range(count):
                trial[row] = tensions[row] + length * change[row]
            for row in range(count):
                yielded = 0.0
                for column in range(count):
                    yielded += compliance[row, column] * trial[column]
                remaining[row] = elongations[row] - yielded
                reached += 0.5 * trial[row] * yielded + spring(stiffness[row], smoothing[row], remaining[row])[0]
            if reached <= value + 1e-4 * length * slope + 1e-14 * abs(value):
                found = True
                break
            length *= 0.5
        if not found:
            return False
        for cable in range(count):
            tensions[cable] = trial[cable]
        value = reached
    return False
