"""`settle`: which cables are taut, and how much, at the end of a step of Newton."""

from typing import no_type_check

import numpy as np
from numba import njit

from hydrostat.arrays import Vector
from hydrostat.kernel import INNER, KERNEL
from hydrostat.mechanics.stiffness import Small
from hydrostat.mechanics.tension_law import TensionLaw, spring


def settle(law: TensionLaw, elongations: Vector, compliance: Small) -> Vector | None:
    """Tensions at which cables on a linear body come to rest; None if that is not found.

    The body gives way by compliance @ tensions, so T = law(elongations - compliance @ T): the least of a convex
    function of one number a cable. Unlike a linear law it knows that a slack cable does not push.

    Args:
        law: of the cables.
        elongations: of each cable on a body that does not yet feel them [m].
        compliance: positive semidefinite, (cables, cables) [m/N].
    """
    tensions = np.zeros_like(elongations)
    return tensions if _settle(law.stiffness, law.smoothing, elongations, compliance, tensions) else None


_SETTLING = 30
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


@njit(**KERNEL)
@no_type_check
def _settle(stiffness, smoothing, elongations, compliance, tensions):
    """Newton with a line search on T M T / 2 + U(elongations - M T); false if it does not arrive."""
    count = tensions.shape[0]
    matrix = np.empty((count, count))
    change, trial, remaining, slopes = np.empty(count), np.empty(count), elongations.copy(), np.empty(count)
    value = 0.0
    for cable in range(count):
        value += spring(stiffness[cable], smoothing[cable], remaining[cable])[0]
    for _ in range(_SETTLING):
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
