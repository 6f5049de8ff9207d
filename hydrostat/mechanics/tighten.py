"""Cables during one step of Newton: `settle` finds their tensions, `Tightener` brings these about."""

from typing import no_type_check

import numpy as np
from numba import njit

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.cable import CableEnergy, TensionLaw
from hydrostat.mechanics.stiffness import Small, Stiffness


def settle(law: TensionLaw, stretches: Vector, compliance: Small) -> Vector | None:
    """Tensions at which cables on a linear body come to rest; None if that is not found.

    The body gives way by compliance @ tensions, so T = law(stretches - compliance @ T): the least of a convex function
    of one number a cable. Unlike a linear law it knows that a slack cable does not push.

    Args:
        law: of the cables.
        stretches: of each cable on a body that does not yet feel them [m].
        compliance: positive semidefinite, (cables, cables) [m/N].
    """
    tensions = np.zeros_like(stretches)
    return tensions if _settle(law.stiffness, law.smoothing, stretches, compliance, tensions) else None


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
        self._cables = cables
        self._surplus = controls[cables.winches] - cables.rest_lengths - cables.slack
        compliance = stiffness.compliance
        extra = 10.0 / np.maximum(np.abs(compliance.diagonal()), np.finfo(float).tiny)
        for _ in range(20):
            softened = np.linalg.inv(np.eye(len(extra)) + compliance * extra)
            metric = compliance @ softened
            metric = 0.5 * (metric + metric.T)
            if np.linalg.eigvalsh(metric)[0] > 0:
                break
            extra = 4 * extra
        self._metric, self._moves = metric, stiffness.moves @ softened

    def __call__(self, nodes: Nodes, promised: Vector) -> Nodes:
        """Nodes moved on until the cables have about the promised tensions [N]; the same if they have them already."""
        cables = self._cables
        moved = nodes.copy()
        changed = _tighten(
            nodes.reshape(-1), cables.stencils, cables.weights, cables.offsets, cables.roundings, cables.cables,
            self._surplus, cables.law.stiffness, cables.law.smoothing, self._metric, self._moves, promised,
            moved.reshape(-1),
        )  # fmt: skip
        return moved if changed else nodes


_NEAR = 1e-2
"""A tension this close to the promised one, as a share of the largest, is close enough."""

_ITERATIONS = 12
_SETTLING = 30
_HALVINGS = 12


@njit(cache=True, error_model="numpy")
@no_type_check
def _law(k, eps, stretch):
    """Energy, tension and its slope at one stretch; see `TensionLaw`."""
    if stretch <= 0.0:
        return 0.0, 0.0, 0.0
    if stretch <= 2.0 * eps:
        return k * stretch**3 / (12.0 * eps), k * stretch * stretch / (4.0 * eps), k * stretch / (2.0 * eps)
    return 0.5 * k * (stretch - eps) ** 2 + k * eps * eps / 6.0, k * (stretch - eps), k


@njit(cache=True, error_model="numpy")
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


@njit(cache=True, error_model="numpy")
@no_type_check
def _settle(stiffness, smoothing, stretches, compliance, tensions):
    """Newton with a line search on T M T / 2 + U(stretches - M T); false if it does not arrive."""
    count = tensions.shape[0]
    matrix = np.empty((count, count))
    change, trial, remaining, slopes = np.empty(count), np.empty(count), stretches.copy(), np.empty(count)
    value = 0.0
    for cable in range(count):
        value += _law(stiffness[cable], smoothing[cable], remaining[cable])[0]
    for _ in range(_SETTLING):
        largest = missing = 0.0
        for cable in range(count):
            _, wanted, slopes[cable] = _law(stiffness[cable], smoothing[cable], remaining[cable])
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
                remaining[row] = stretches[row] - yielded
                reached += 0.5 * trial[row] * yielded + _law(stiffness[row], smoothing[row], remaining[row])[0]
            if reached <= value + 1e-4 * length * slope + 1e-14 * abs(value):
                found = True
                break
            length *= 0.5
        if not found:
            return False
        tensions[:] = trial
        value = reached
    return False


@njit(cache=True, error_model="numpy")
@no_type_check
def _pull(dofs, stencils, weights, offsets, roundings, cables, moves, stretches, slopes, along):
    """Add the lengths to `stretches`; `slopes`[cable, j] = dl/dx . moves[:, j], unless it is empty."""
    dim = offsets.shape[1]
    slopes[:] = 0.0
    for term in range(stencils.shape[0]):
        square = roundings[term] * roundings[term]
        for axis in range(dim):
            span = offsets[term, axis]
            for corner in range(stencils.shape[1]):
                span += weights[term, corner] * dofs[stencils[term, corner] * dim + axis]
            along[axis] = span
            square += span * span
        length = np.sqrt(square)
        cable = cables[term]
        stretches[cable] += length
        for j in range(slopes.shape[1]):
            total = 0.0
            for corner in range(stencils.shape[1]):
                weight = weights[term, corner] / length
                if weight != 0.0:
                    for axis in range(dim):
                        total += weight * along[axis] * moves[stencils[term, corner] * dim + axis, j]
            slopes[cable, j] += total


@njit(cache=True, error_model="numpy")
@no_type_check
def _tighten(
    dofs, stencils, weights, offsets, roundings, cables, surplus, stiffness, smoothing, metric, moves, promised, moved
):
    """Newton with a line search on (T + y/2) M y + U(s(x - Z y)); true if anything moved."""
    count = promised.shape[0]
    along, none = np.empty(3), np.empty((count, 0))
    matrix, slopes, tangents = np.empty((count, count)), np.empty((count, count)), np.empty(count)
    change, direction, trial = np.zeros(count), np.empty(count), np.empty(count)
    tensions, stretches = np.empty(count), surplus.copy()
    near = 0.0
    for cable in range(count):
        near = max(near, _NEAR * promised[cable])
    value = 0.0
    changed = False
    for iteration in range(_ITERATIONS):
        stretches[:] = surplus
        _pull(moved, stencils, weights, offsets, roundings, cables, moves, stretches, slopes, along)
        missing = energy = 0.0
        for cable in range(count):
            own, tensions[cable], tangents[cable] = _law(stiffness[cable], smoothing[cable], stretches[cable])
            energy += own
            missing = max(missing, abs(tensions[cable] - promised[cable] - change[cable]))
        if missing <= near:
            break
        if iteration == 0:
            value = energy
        slope = 0.0
        for row in range(count):
            gradient = 0.0
            for column in range(count):
                gradient += metric[row, column] * (promised[column] + change[column])
                gradient -= slopes[column, row] * tensions[column]
                total = metric[row, column]
                for cable in range(count):
                    total += slopes[cable, row] * tangents[cable] * slopes[cable, column]
                matrix[row, column] = total
            direction[row] = -gradient
            trial[row] = gradient
        if not _eliminate(matrix, direction):
            break
        for row in range(count):
            slope += trial[row] * direction[row]
        length, found = 1.0, False
        for _ in range(_HALVINGS):
            reached = 0.0
            for row in range(count):
                trial[row] = change[row] + length * direction[row]
            for dof in range(dofs.shape[0]):
                total = 0.0
                for cable in range(count):
                    total += moves[dof, cable] * trial[cable]
                moved[dof] = dofs[dof] - total
            stretches[:] = surplus
            _pull(moved, stencils, weights, offsets, roundings, cables, moves, stretches, none, along)
            for row in range(count):
                reached += _law(stiffness[row], smoothing[row], stretches[row])[0]
                for column in range(count):
                    reached += (promised[row] + 0.5 * trial[row]) * metric[row, column] * trial[column]
            if reached <= value + 1e-4 * length * slope:
                found = True
                break
            length *= 0.5
        if not found:
            for dof in range(dofs.shape[0]):
                total = 0.0
                for cable in range(count):
                    total += moves[dof, cable] * change[cable]
                moved[dof] = dofs[dof] - total
            break
        change[:] = trial
        value = reached
        changed = True
    return changed
