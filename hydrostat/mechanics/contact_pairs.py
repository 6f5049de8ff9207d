"""Barriers between pairs of features that may touch: energy, forces, Hessian.

A pair of squared distance D has the energy W h phi(D/h), phi(r) = -(r - 1)^2 ln r below r = 1, 0 above (the barrier of
Li et al. 2020), h being the square of the distance at which it begins to be felt. D is the least F(x, l) over the
nearest points l (`geometry.pair_distances`): by the envelope theorem dD = dF and d2D = F_xx - F_xl F_ll^-1 F_lx,
exactly, with the parts of l that are free, none at a corner.
"""

import math
from typing import no_type_check

import numpy as np

from hydrostat.geometry.pair_distances import dot, nearest, place
from hydrostat.kernel import INNER, Kernel, njit


@njit(**INNER)
@no_type_check
def _barrier(squared, begin, weight):
    """Energy of a pair, and its first two derivatives by D."""
    r = squared / begin
    if r >= 1.0:
        return 0.0, 0.0, 0.0
    if r <= 0.0:
        return np.inf, -np.inf, np.inf
    log, below = -math.log(r), r - 1.0
    slope = 2.0 * below * log - below * below / r
    curve = 2.0 * log - 4.0 * below / r + below * below / (r * r)
    return weight * begin * below * below * log, weight * slope, weight * curve / begin


@Kernel
@no_type_check
def barrier_energy(x, stencils, edges, soft, begins, weights):
    """Energy of all pairs [J], and how many are felt."""
    y, w, dw, c = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3)
    total, felt = 0.0, 0
    for pair in range(stencils.shape[0]):
        place(x, stencils[pair], y)
        _, squared = nearest(y, stencils.shape[1], edges[pair], soft, w, dw, c)
        if squared < begins[pair]:
            total += _barrier(squared, begins[pair], weights[pair])[0]
            felt += 1
    return total, felt


@Kernel
@no_type_check
def barrier_forces(x, stencils, edges, soft, begins, weights, blocks):
    """Fill in dE/dx of each pair [N]."""
    y, w, dw, c = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3)
    for pair in range(stencils.shape[0]):
        place(x, stencils[pair], y)
        _, squared = nearest(y, stencils.shape[1], edges[pair], soft, w, dw, c)
        _, slope, _ = _barrier(squared, begins[pair], weights[pair])
        for i in range(stencils.shape[1]):
            for k in range(x.shape[1]):
                blocks[pair, i, k] = 2.0 * slope * w[i] * c[k]


@Kernel
@no_type_check
def barrier_hessian(x, stencils, edges, soft, begins, weights, share, blocks):
    """Fill in d2E/dx2 of each pair [N/m], with this share of what is negative in it taken out.

    It is P - N with P and N semidefinite, in closed form: N is what the force, as it pushes, takes away across c.
    """
    corners, dim = stencils.shape[1], x.shape[1]
    y, w, dw, c = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3)
    lines, mixed = np.empty((2, 3)), np.empty((2, 12))
    for pair in range(stencils.shape[0]):
        block = blocks[pair]
        block[:] = 0.0
        place(x, stencils[pair], y)
        free, squared = nearest(y, corners, edges[pair], soft, w, dw, c)
        if squared >= begins[pair]:
            continue
        _, slope, curve = _barrier(squared, begins[pair], weights[pair])
        long = max(dot(c, c), 1e-300)
        across = 2.0 * slope * (1.0 - share)
        along = 4.0 * long * curve + 2.0 * slope
        if along < 0.0:
            along *= 1.0 - share
        for i in range(corners):
            for j in range(corners):
                for a in range(dim):
                    for b in range(dim):
                        one = (along - across) * c[a] * c[b] / long
                        if a == b:
                            one += across
                        block[dim * i + a, dim * j + b] = w[i] * w[j] * one
        if free == 0:
            continue
        for q in range(free):
            for k in range(3):
                lines[q, k] = 0.0
                for i in range(corners):
                    lines[q, k] += dw[q, i] * y[i, k]
            for i in range(corners):
                for k in range(dim):
                    mixed[q, dim * i + k] = w[i] * lines[q, k] + dw[q, i] * c[k]
        extra = soft if edges[pair] else 0.0
        a00, a11, a01 = dot(lines[0], lines[0]) + extra, 1.0, 0.0
        if free == 2:
            a11, a01 = dot(lines[1], lines[1]) + extra, dot(lines[0], lines[1])
        else:
            mixed[1] = 0.0
        push = -2.0 * slope / (a00 * a11 - a01 * a01)
        for i in range(dim * corners):
            for j in range(dim * corners):
                block[i, j] += push * (
                    a11 * mixed[0, i] * mixed[0, j]
                    + a00 * mixed[1, i] * mixed[1, j]
                    - a01 * (mixed[0, i] * mixed[1, j] + mixed[1, i] * mixed[0, j])
                )
