"""`find_near_pairs`: boxes that meet, by a grid of cells."""

from itertools import product

import numpy as np

from hydrostat.arrays import Float, Int

Corners = Float[np.ndarray, "_ _ 3"]


def find_near_pairs(one: Corners, other: Corners) -> Int[np.ndarray, "pairs 2"]:
    """Pairs of an item of `one` and an item of `other` whose bounding boxes meet, sorted.

    Items are edges or triangles in space, by their corners [m]. A cell of the grid is as large as two boxes of the
    largest size can be apart between their centers, thus only neighboring cells are searched. Items that are not
    finite are near none.
    """
    if not len(one) or not len(other):
        return np.empty((0, 2), dtype=np.int64)
    finite = [np.isfinite(items).all(axis=(1, 2)) for items in (one, other)]
    if not (finite[0].all() and finite[1].all()):
        found = find_near_pairs(one[finite[0]], other[finite[1]])
        return np.column_stack([np.flatnonzero(kept)[found[:, side]] for side, kept in enumerate(finite)])
    lows, highs = (one.min(axis=1), other.min(axis=1)), (one.max(axis=1), other.max(axis=1))
    centers = [0.5 * (low + high) for low, high in zip(lows, highs, strict=True)]
    origin = np.minimum(centers[0].min(axis=0), centers[1].min(axis=0))
    span = float(max((center - origin).max() for center in centers))
    largest = sum(0.5 * float((high - low).max()) for low, high in zip(lows, highs, strict=True))
    side = max(1.001 * largest, span / _MAX_CELLS) or 1.0
    first, second = (((center - origin) / side).astype(np.int64) + 1 for center in centers)
    key = np.array([(_MAX_CELLS + 4) ** 2, _MAX_CELLS + 4, 1])
    order = np.argsort(second @ key, kind="stable")
    kept = (second @ key)[order]
    steps = np.array(list(product((-1, 0, 1), (-1, 0, 1)))) @ key[:2]  # three cells along z have keys in a row
    asked = (first @ key)[:, None] + steps
    begins, ends = np.searchsorted(kept, asked - 1, "left"), np.searchsorted(kept, asked + 1, "right")
    counts = (ends - begins).ravel()
    i = np.repeat(np.repeat(np.arange(len(one)), len(steps)), counts)
    j = order[np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts - begins.ravel(), counts)]
    for axis in range(3):  # one after the other: the first leaves few
        meet = (lows[0][i, axis] <= highs[1][j, axis]) & (lows[1][j, axis] <= highs[0][i, axis])
        i, j = i[meet], j[meet]
    pairs = np.column_stack([i, j])
    return pairs[np.lexsort((j, i))]


_MAX_CELLS = 1_000_000
"""Cells along an axis, at most."""
