"""Kernels of a shaded picture: how much of the sky each place sees, and its colour by light, hatching and lines."""

from typing import no_type_check

import numpy as np

from hydrostat.kernel import INNER, KERNEL, njit

SAMPLES = 40  # neighbours that are asked how much of the sky they take


@njit(**KERNEL)
@no_type_check
def sky_shares(depth, normals, reach):
    """How much of the sky each pixel sees past its neighbours, 0 to 1 (screen-space ambient occlusion).

    Depth is towards the eye, and reach how far neighbours shade, both in pixels; normals (height, width, 3) are unit.
    """
    height, width = depth.shape
    sky = np.ones((height, width), dtype=np.float32)
    offsets = np.empty((SAMPLES, 2), dtype=np.int64)
    for sample in range(SAMPLES):
        radius = reach * np.sqrt((sample + 0.5) / SAMPLES)
        offsets[sample, 0] = int(np.round(radius * np.cos(2.399963229728653 * sample)))
        offsets[sample, 1] = int(np.round(radius * np.sin(2.399963229728653 * sample)))
    for row in range(height):
        for column in range(width):
            if depth[row, column] == -np.inf:
                continue
            taken = 0.0
            for sample in range(SAMPLES):
                dx, dy = offsets[sample]
                x, y = column + dx, row + dy
                if x < 0 or y < 0 or x >= width or y >= height or depth[y, x] == -np.inf:
                    continue
                rise = depth[y, x] - depth[row, column]
                far = np.sqrt(dx * dx + dy * dy + rise * rise) + 1e-6
                n_x, n_y, n_z = normals[row, column, 0], normals[row, column, 1], normals[row, column, 2]
                lean = (n_x * dx + n_y * dy + n_z * rise) / far - 0.12
                if lean > 0 and far < 2 * reach:
                    taken += lean * (1 - far / (2 * reach))
            sky[row, column] = max(0.0, 1.0 - 2.6 * taken / SAMPLES)
    return sky


@njit(**KERNEL)
@no_type_check
def paint(depth, shown, sky, look, table, inks, shares):
    """Colours of an image from the samples within its pixels: light, hatching, mesh and edges.

    Args:
        depth: of each sample towards the eye, in samples, (finer height, finer width).
        shown: normal and whether it is held, of each sample, then its distances to the three sides of its facet in
            samples, if edges of the mesh are drawn, (finer height, finer width, 4 or 7).
        sky: share of the sky that each pixel sees, (height, width).
        look: samples along a side of a pixel, along a point (1/72 inch), of the least step in depth that is an edge;
            how far the sky is up, and towards the eye; how far hatching is moved to the right, in samples, (6,).
        table: colours from no light to full light, (colours, 3).
        inks: colours of hatching, mesh and edges, (3, 3).
        shares: how strongly each of them is laid on, (3,).

    Returns:
        red, green, blue and cover, (height, width, 4), all 0 to 1.
    """
    fine, dot, jump = int(look[0]), look[1], look[2]
    height, width = sky.shape
    image = np.zeros((height, width, 4))
    covers = np.empty(3)
    around = np.empty((8, 2), dtype=np.int64)
    for turn in range(8):
        around[turn, 0] = int(np.round(0.55 * dot * np.cos(turn * np.pi / 4)))
        around[turn, 1] = int(np.round(0.55 * dot * np.sin(turn * np.pi / 4)))
    for row in range(height * fine):
        for column in range(width * fine):
            if depth[row, column] == -np.inf:
                continue
            x, y, z = shown[row, column, 0], shown[row, column, 1], shown[row, column, 2]
            length = max(np.sqrt(x * x + y * y + z * z), 1e-12)
            x, y, z = x / length, y / length, z / length
            light = _light(x, y, z, look[3], look[4]) * (0.35 + 0.65 * sky[row // fine, column // fine])
            place = min(max(light, 0.0), 1.0) * (len(table) - 1)
            lower = min(int(place), len(table) - 2)
            covers[0] = _hatching(row, column + look[5], dot) if shown[row, column, 3] > 0.5 else 0.0
            covers[1] = 0.0
            if shown.shape[2] == 7:
                rim = min(shown[row, column, 4], shown[row, column, 5], shown[row, column, 6])
                covers[1] = min(max(0.24 * dot + 0.5 - rim, 0.0), 1.0)
            covers[2] = _edge(depth, row, column, x, y, z, jump, around)
            for channel in range(3):
                value = table[lower, channel] + (place - lower) * (table[lower + 1, channel] - table[lower, channel])
                for ink in range(3):
                    value += shares[ink] * covers[ink] * (inks[ink, channel] - value)
                image[row // fine, column // fine, channel] += value
            image[row // fine, column // fine, 3] += 1.0
    for row in range(height):
        for column in range(width):
            if image[row, column, 3] > 0:
                image[row, column, :3] /= image[row, column, 3]
                image[row, column, 3] /= fine * fine
            else:
                image[row, column, :3] = inks[2]
    return image


@njit(**INNER)
@no_type_check
def _light(x, y, z, up, near):
    """Light on a normal (x, y, z): lamps to the left above the eye and, weaker, right; the sky at (0, up, near)."""
    key = min(max((-0.4801 * x + 0.6202 * y + 0.6202 * z + 0.25) / 1.25, 0.0), 1.0)
    side = min(max(0.8518 * x + 0.0501 * y + 0.5211 * z, 0.0), 1.0)
    hemisphere = 0.5 + 0.5 * (up * y + near * z)
    away = 1.0 - min(max(z, 0.0), 1.0)
    return (0.14 + 0.26 * hemisphere + 0.56 * key + 0.12 * side) * (1.0 - 0.22 * away * away * away)


@njit(**INNER)
@no_type_check
def _hatching(row, column, dot):
    """Slanting strokes on a thin ground."""
    gap = 3.0 * dot
    near = abs(((column - row) / np.sqrt(2.0)) % gap - gap / 2)
    return 0.1 + 0.42 * min(max(0.32 * dot + 0.5 - near, 0.0), 1.0)


@njit(**INNER)
@no_type_check
def _edge(depth, row, column, x, y, z, jump, around):
    """1 where a nearer part of the body begins at a neighbour, 0 elsewhere."""
    height, width = depth.shape
    lean_x, lean_y = x / max(z, 0.15), y / max(z, 0.15)
    for turn in range(8):
        dx, dy = around[turn]
        u, v = column + dx, row + dy
        if u < 0 or v < 0 or u >= width or v >= height or depth[v, u] == -np.inf:
            continue
        if depth[v, u] - depth[row, column] - max(-(lean_x * dx + lean_y * dy), 0.0) > jump:
            return 1.0
    return 0.0
