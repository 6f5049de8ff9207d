"""Distances between features of a boundary, and how far these may move before they meet.

A pair is a node and an edge in the plane, a node and a triangle or two edges in space. Its squared distance is
D(x) = min over l of F(x, l), l being where on its features the nearest points lie: F = |c|^2 with c = sum of w(l) x.
Two edges that are nearly parallel have no certain nearest points, so that F has
soft ((s - 1/2)^2 + (t - 1/2)^2) more where that is asked for.
"""

import math
from typing import no_type_check

import numpy as np

from hydrostat.kernel import INNER, Kernel, njit


@njit(**INNER)
@no_type_check
def dot(a, b):
    """Inner product of two vectors in space."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(**INNER)
@no_type_check
def place(x, stencil, y):
    """Fill in where the corners of a pair are, in space."""
    for i in range(stencil.shape[0]):
        for k in range(3):
            y[i, k] = x[stencil[i], k] if k < x.shape[1] else 0.0


@njit(**INNER)
@no_type_check
def _on_edge(y, a, b, w, dw):
    """Weights of the point nearest y[0] between two corners, subtracted; how many parts of l are free."""
    along, before = 0.0, 0.0
    for k in range(3):
        along += (y[b, k] - y[a, k]) ** 2
        before += (y[b, k] - y[a, k]) * (y[0, k] - y[a, k])
    share = min(max(before / max(along, 1e-300), 0.0), 1.0)
    w[a], w[b] = -(1.0 - share), -share
    dw[0, a], dw[0, b] = 1.0, -1.0
    return 1 if 0.0 < share < 1.0 else 0


@njit(**INNER)
@no_type_check
def _on_triangle(y, w, dw):
    """The same for the point of the triangle y[1:] nearest y[0], by the regions around it (Ericson 2005, 5.1.5)."""
    u, v, p = np.empty(3), np.empty(3), np.empty(3)
    for k in range(3):
        u[k], v[k], p[k] = y[2, k] - y[1, k], y[3, k] - y[1, k], y[0, k] - y[1, k]
    uu, uv, vv, up, vp = dot(u, u), dot(u, v), dot(v, v), dot(u, p), dot(v, p)
    if up <= 0.0 and vp <= 0.0:
        w[1] = -1.0
        return 0
    if up >= uu and vp - uv <= up - uu:
        w[2] = -1.0
        return 0
    if vp >= vv and up - uv <= vp - vv:
        w[3] = -1.0
        return 0
    one, two = vv * up - uv * vp, uu * vp - uv * up
    whole = uu * vv - uv * uv
    if two <= 0.0 and 0.0 <= up <= uu:
        return _on_edge(y, 1, 2, w, dw)
    if one <= 0.0 and 0.0 <= vp <= vv:
        return _on_edge(y, 1, 3, w, dw)
    if one + two >= whole:
        return _on_edge(y, 2, 3, w, dw)
    one, two = one / whole, two / whole
    w[1], w[2], w[3] = -(1.0 - one - two), -one, -two
    dw[0, 1], dw[0, 2] = 1.0, -1.0
    dw[1, 1], dw[1, 3] = 1.0, -1.0
    return 2


@njit(**INNER)
@no_type_check
def _on_edges(y, soft, w, dw):
    """The same for the points of the edges y[:2] and y[2:] that make F least."""
    u, v, p = np.empty(3), np.empty(3), np.empty(3)
    for k in range(3):
        u[k], v[k], p[k] = y[1, k] - y[0, k], y[3, k] - y[2, k], y[0, k] - y[2, k]
    a, b, c = dot(u, u) + soft, dot(u, v), dot(v, v) + soft
    d, e = dot(u, p) - 0.5 * soft, dot(v, p) + 0.5 * soft
    s = min(max((b * e - c * d) / max(a * c - b * b, 1e-300), 0.0), 1.0)
    t = (e + b * s) / max(c, 1e-300)
    if t < 0.0 or t > 1.0:
        t = min(max(t, 0.0), 1.0)
        s = min(max((b * t - d) / max(a, 1e-300), 0.0), 1.0)
    w[0], w[1], w[2], w[3] = 1.0 - s, s, -(1.0 - t), -t
    free = 0
    if 0.0 < s < 1.0:
        dw[free, 0], dw[free, 1] = -1.0, 1.0
        free += 1
    if 0.0 < t < 1.0:
        dw[free, 2], dw[free, 3] = 1.0, -1.0
        free += 1
    return free


@njit(**INNER)
@no_type_check
def nearest(y, corners, edges, soft, w, dw, c):
    """D of a pair; fills in w, dw/dl and c. How many parts of l are free, and D."""
    for i in range(4):
        w[i], dw[0, i], dw[1, i] = 0.0, 0.0, 0.0
    w[0] = 1.0
    if edges:
        free = _on_edges(y, soft, w, dw)
    elif corners == 3:
        free = _on_edge(y, 1, 2, w, dw)
    else:
        free = _on_triangle(y, w, dw)
    squared = 0.0
    for k in range(3):
        c[k] = 0.0
        for i in range(corners):
            c[k] += w[i] * y[i, k]
        squared += c[k] * c[k]
    if edges:
        squared += soft * ((w[1] - 0.5) ** 2 + (-w[3] - 0.5) ** 2)
    return free, squared


@Kernel
@no_type_check
def squared_distances(x, stencils, edges, soft, squared):
    """Fill in D of each pair [m^2]."""
    y, w, dw, c = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3)
    for pair in range(stencils.shape[0]):
        place(x, stencils[pair], y)
        _, squared[pair] = nearest(y, stencils.shape[1], edges[pair], soft, w, dw, c)


@njit(**INNER)
@no_type_check
def advanced(x, move, rest, stencil, edges, kept, limit, reach, y, way, w, dw, c):
    """Share of a straight move, at most `limit`, after which a pair keeps a share of its distance.

    And whether it may come within reach up to `limit`.

    By conservative advancement: a pair whose corners move no faster than `speed` against one another cannot meet
    before distance / speed (additive continuous collision detection: Li, Kaufman and Jiang 2021). Pairs that touch at
    rest count as grown together. y to c are room to work in.
    """
    corners = stencil.shape[0]
    first = 2 if edges else 1
    place(move, stencil, way)
    for k in range(3):
        mean = 0.0
        for i in range(corners):
            mean += way[i, k] / corners
        for i in range(corners):
            way[i, k] -= mean
    speeds = 0.0
    for begin, end in ((0, first), (first, corners)):
        fastest = 0.0
        for i in range(begin, end):
            fastest = max(fastest, dot(way[i], way[i]))
        speeds += math.sqrt(fastest)
    place(x, stencil, y)
    _, squared = nearest(y, corners, edges, 0.0, w, dw, c)
    distance = math.sqrt(squared)
    close = distance - speeds * limit < reach
    if distance * (1.0 - kept) > speeds * limit:
        return limit, close
    place(rest, stencil, y)
    _, squared = nearest(y, corners, edges, 0.0, w, dw, c)
    if squared == 0.0:
        return limit, close
    place(x, stencil, y)
    least, done = kept * distance, 0.0
    for _ in range(200):
        step = 0.95 * (distance - least) / speeds
        if done + step >= limit:
            return limit, close
        done += step
        for i in range(corners):
            for k in range(3):
                y[i, k] += step * way[i, k]
        _, squared = nearest(y, corners, edges, 0.0, w, dw, c)
        distance = math.sqrt(squared)
        if distance < 1.1 * least:
            break
    return done, close


@Kernel
@no_type_check
def admissible_share(x, move, rest, stencils, edges, kept):
    """Largest share, at most 1, of a straight move after which each of some pairs keeps a share of its distance."""
    y, w, dw, c, way = np.zeros((4, 3)), np.empty(4), np.empty((2, 4)), np.empty(3), np.zeros((4, 3))
    limit = 1.0
    for pair in range(stencils.shape[0]):
        limit, _ = advanced(x, move, rest, stencils[pair], edges[pair], kept, limit, 0.0, y, way, w, dw, c)
    return limit
