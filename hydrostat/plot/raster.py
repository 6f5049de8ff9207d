"""Kernels of the pictures in space: normals with creases, a depth buffer, and what neighbours shade."""

from typing import no_type_check

import numpy as np
from numba import njit

SAMPLES = 40
"""Neighbours that are asked how much of the sky they take."""


@njit(cache=True)
@no_type_check
def corner_normals(corners, facets, starts, members, least):
    """Unit normal at each corner of each facet, (facets, 3, 3).

    The mean over the facets that share the node, weighted by their area, as far as they bend less than a crease.

    Args:
        corners: of each facet, (facets, 3, 3).
        facets: node indices, (facets, 3).
        starts: where the facets of each node begin in `members`, (nodes + 1,).
        members: facets of node after node.
        least: cosine of the sharpest bend that is drawn smooth.
    """
    count = len(facets)
    flat = np.empty((count, 3))
    area = np.empty(count)
    for facet in range(count):
        a, b, c = corners[facet]
        normal = np.cross(b - a, c - a)
        area[facet] = np.sqrt(np.sum(normal * normal))
        flat[facet] = normal / max(area[facet], 1e-300)
    normals = np.empty((count, 3, 3))
    for facet in range(count):
        for corner in range(3):
            node = facets[facet, corner]
            total = np.zeros(3)
            for index in range(starts[node], starts[node + 1]):
                other = members[index]
                if np.sum(flat[facet] * flat[other]) >= least:
                    total += area[other] * flat[other]
            normals[facet, corner] = total / max(np.sqrt(np.sum(total * total)), 1e-300)
    return normals


@njit(cache=True)
@no_type_check
def rasterise(corners, values, width, height):
    """The nearest facet at the middle of each pixel.

    Args:
        corners: of each facet: column, row and depth towards the eye, in pixels, (facets, 3, 3).
        values: to interpolate over each facet, (facets, 3, values).
        width: pixels in a row.
        height: rows.

    Returns:
        depth (height, width), minus infinity where there is nothing; interpolated values (height, width, values);
        distance to the nearest side of the facet in pixels (height, width).
    """
    depth = np.full((height, width), -np.inf, dtype=np.float32)
    shown = np.zeros((height, width, values.shape[2]), dtype=np.float32)
    rim = np.zeros((height, width), dtype=np.float32)
    for facet in range(len(corners)):
        a, b, c = corners[facet]
        double = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if double <= 1e-12:
            continue
        high_a = double / max(np.hypot(c[0] - b[0], c[1] - b[1]), 1e-12)
        high_b = double / max(np.hypot(a[0] - c[0], a[1] - c[1]), 1e-12)
        high_c = double / max(np.hypot(b[0] - a[0], b[1] - a[1]), 1e-12)
        left = max(int(np.ceil(min(a[0], b[0], c[0]) - 0.5)), 0)
        right = min(int(np.floor(max(a[0], b[0], c[0]) - 0.5)), width - 1)
        below = max(int(np.ceil(min(a[1], b[1], c[1]) - 0.5)), 0)
        above = min(int(np.floor(max(a[1], b[1], c[1]) - 0.5)), height - 1)
        for row in range(below, above + 1):
            y = row + 0.5
            for column in range(left, right + 1):
                x = column + 0.5
                share_b = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / double
                share_c = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / double
                share_a = 1.0 - share_b - share_c
                if share_a < -1e-9 or share_b < -1e-9 or share_c < -1e-9:
                    continue
                near = share_a * a[2] + share_b * b[2] + share_c * c[2]
                if near > depth[row, column]:
                    depth[row, column] = near
                    rim[row, column] = min(share_a * high_a, share_b * high_b, share_c * high_c)
                    for index in range(values.shape[2]):
                        shown[row, column, index] = (
                            share_a * values[facet, 0, index]
                            + share_b * values[facet, 1, index]
                            + share_c * values[facet, 2, index]
                        )
    return depth, shown, rim


@njit(cache=True)
@no_type_check
def sky_shares(depth, normals, reach):
    """How much of the sky each pixel sees past its neighbours, 0 to 1 (screen-space ambient occlusion).

    Args:
        depth: towards the eye in pixels, (height, width).
        normals: (height, width, 3), unit.
        reach: how far neighbours shade, in pixels.
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


@njit(cache=True)
@no_type_check
def paint(depth, shown, rim, sky, look, table, inks, shares):
    """Colours of an image from the samples within its pixels: light, hatching, mesh and edges.

    Args:
        depth: of each sample towards the eye, in samples, (finer height, finer width).
        shown: normal and whether it is held, of each sample, (finer height, finer width, 4).
        rim: distance of each sample to a side of its facet, in samples.
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
            covers[1] = min(max(0.24 * dot + 0.5 - rim[row, column], 0.0), 1.0)
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


@njit(cache=True)
@no_type_check
def _light(x, y, z, up, near):
    """Light on a surface of normal (x, y, z): two soft lights, the sky, and less where it turns away.

    The lights stand to the left above the eye and, weaker, to its right; the sky is at (0, up, near).
    """
    key = min(max((-0.4801 * x + 0.6202 * y + 0.6202 * z + 0.25) / 1.25, 0.0), 1.0)
    side = min(max(0.8518 * x + 0.0501 * y + 0.5211 * z, 0.0), 1.0)
    hemisphere = 0.5 + 0.5 * (up * y + near * z)
    away = 1.0 - min(max(z, 0.0), 1.0)
    return (0.14 + 0.26 * hemisphere + 0.56 * key + 0.12 * side) * (1.0 - 0.22 * away * away * away)


@njit(cache=True)
@no_type_check
def _hatching(row, column, dot):
    """Slanting strokes on a thin ground."""
    gap = 3.0 * dot
    near = abs(((column - row) / np.sqrt(2.0)) % gap - gap / 2)
    return 0.1 + 0.42 * min(max(0.32 * dot + 0.5 - near, 0.0), 1.0)


@njit(cache=True)
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
