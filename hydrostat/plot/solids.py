"""Solids of triangles for scenes in space: skins of bodies, slabs, tubes, spheres, spools and crosses, in many keys."""

from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.drawing import CREASE, smooth_normals
from hydrostat.geometry import Mesh

Places = Float[np.ndarray, "_ _ 3"]  # places of points in every key [m]
Triangles = Int[np.ndarray, "_ 3"]
Solid = tuple[Triangles, Places, Places]  # triangles, and places and normals of the vertices in every key
SIDES = 8  # sides of a tube and meridians of a sphere


def skin(mesh: Mesh, nodes: Places) -> Solid:
    """The boundary of a body in space; a vertex for each normal at rest, so that edges stay sharp."""
    facets = mesh.boundary
    rest = smooth_normals(mesh.nodes[facets], facets, sharp=CREASE)
    told = np.column_stack([facets.ravel(), np.round(rest.reshape(-1, 3), 3) + 0.0])
    rows, corners = np.unique(told, axis=0, return_inverse=True)
    triangles = corners.reshape(facets.shape)
    places = nodes[:, rows[:, 0].astype(int)]
    return triangles, places, _smooth(triangles, places)


def slab(mesh: Mesh, nodes: Float[np.ndarray, "_ _ 2"], thickness: float) -> Solid:
    """A flat body: its two faces, and its rim with vertices of its own."""
    keys, count, _ = nodes.shape
    rim = mesh.boundary_nodes
    names = np.zeros(count, dtype=int)
    names[rim] = np.arange(len(rim))
    a, b = names[mesh.boundary].T
    low, high = 2 * count, 2 * count + len(rim)
    sides = np.concatenate([np.stack([low + a, low + b, high + b], 1), np.stack([low + a, high + b, high + a], 1)])
    triangles = np.concatenate([mesh.elements, mesh.elements[:, ::-1] + count, sides])
    flat = np.concatenate([nodes, nodes, nodes[:, rim], nodes[:, rim]], axis=1)
    half = np.repeat([0.5, -0.5, -0.5, 0.5], [count, count, len(rim), len(rim)]) * thickness
    places = np.concatenate([flat, np.tile(half[None, :, None], (keys, 1, 1))], axis=2)
    normals = np.zeros_like(places)
    normals[:, :count, 2], normals[:, count : 2 * count, 2] = 1.0, -1.0
    normals[:, low:] = _smooth(sides, places)[:, low:]
    return triangles, places, normals


def tube(points: Places, radius: float) -> Solid:
    """A round tube along points; its rings turn as little as they can."""
    ways = np.diff(points, axis=1)
    ways = _unit(ways, fallback=np.array([1.0, 0.0, 0.0]))
    ends = np.concatenate([ways[:, :1], ways[:, :-1] + ways[:, 1:], ways[:, -1:]], axis=1)
    along = _unit(ends, fallback=np.array([1.0, 0.0, 0.0]))
    across = _across(along[0])
    sideways = np.stack([_rotate(across, along[0], way) for way in along])
    third = np.cross(along, sideways)
    turns = 2 * np.pi * np.arange(SIDES) / SIDES
    normals = np.cos(turns)[:, None] * sideways[:, :, None] + np.sin(turns)[:, None] * third[:, :, None]
    places = points[:, :, None] + radius * normals
    ring, side = np.meshgrid(np.arange(points.shape[1] - 1), np.arange(SIDES), indexing="ij")
    one, two = SIDES * ring + side, SIDES * ring + (side + 1) % SIDES
    triangles = np.stack([one, two, two + SIDES, one, two + SIDES, one + SIDES], axis=-1).reshape(-1, 3)
    shape = (len(points), -1, 3)
    return triangles, places.reshape(shape), normals.reshape(shape)


def sphere(radius: float) -> Solid:
    """A sphere about the origin."""
    turns, rows = 2 * np.pi * np.arange(SIDES) / SIDES, np.pi * np.arange(1, 5) / 5
    ring = np.stack([np.cos(turns), np.sin(turns), np.zeros(SIDES)], axis=1)
    rounds = [np.sin(row) * ring + np.cos(row) * np.array([0, 0, 1.0]) for row in rows]
    normals = np.concatenate([np.array([[0, 0, 1.0]]), *rounds, np.array([[0, 0, -1.0]])])
    at, after = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES
    last = len(normals) - 1
    triangles = [np.stack([0 * at, 1 + at, 1 + after], axis=1)]
    for row in range(3):
        one, two = 1 + SIDES * row + at, 1 + SIDES * row + after
        triangles += [np.stack([one, one + SIDES, two + SIDES], 1), np.stack([one, two + SIDES, two], 1)]
    triangles.append(np.stack([0 * at + last, last - SIDES + after, last - SIDES + at], axis=1))
    return np.concatenate(triangles), radius * normals[None], normals[None]


def spool(way: Float[np.ndarray, " 3"], radius: float) -> Solid:
    """A winch's spool about the origin, its axis across the way of its cable: a drum between two flanges."""
    outline = np.array([(0, -0.5), (1, -0.5), (1, -0.3), (0.6, -0.3), (0.6, 0.3), (1, 0.3), (1, 0.5), (0, 0.5)])
    axis = _across(_unit(way[None], fallback=np.array([1.0, 0.0, 0.0])))[0]
    one = _across(axis[None])[0]
    two = np.cross(axis, one)
    count = 2 * SIDES
    turns = 2 * np.pi * np.arange(count) / count
    out = np.cos(turns)[:, None] * one + np.sin(turns)[:, None] * two
    places, normals, triangles = [], [], []
    for start, end in pairwise(outline):
        run = end - start
        normal = _unit(run[1] * out - run[0] * axis, fallback=axis)
        first = count * len(places)
        places += [start[0] * out + start[1] * axis, end[0] * out + end[1] * axis]
        normals += [normal, normal]
        at, after = first + np.arange(count), first + (np.arange(count) + 1) % count
        triangles += [np.stack([at, after, after + count], 1), np.stack([at, after + count, at + count], 1)]
    return np.concatenate(triangles), radius * np.concatenate(places)[None], np.concatenate(normals)[None]


def cross(size: float) -> Solid:
    """Three bars of a length that cross in the origin."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    places, normals, triangles = [], [], []
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    ways = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]], dtype=float)
    for axis in range(3):
        sides = np.full(3, 0.16)
        sides[axis] = 1.0
        for quad, way in zip(quads, ways, strict=True):
            first = 4 * len(triangles)
            places.append(signs[quad] * sides)
            normals.append(np.tile(way, (4, 1)))
            triangles.append(np.array([[0, 1, 2], [0, 2, 3]]) + first)
    turned, ways = size / 2 * np.concatenate(places) @ _TILT.T, np.concatenate(normals) @ _TILT.T
    return np.concatenate(triangles), turned[None], ways[None]


_TILT = np.array([[1, -1, 0], [1, 1, -2], [1, 1, 1]]) / np.sqrt([[2.0], [6.0], [3.0]])
"""A cross of coordinate axes would be hard to tell from the axes themselves."""


def join_solids(solids: list[Solid]) -> Solid:
    """Join several solids into one."""
    starts = np.cumsum([0, *(solid[1].shape[1] for solid in solids)])
    triangles = [solid[0] + start for solid, start in zip(solids, starts[:-1], strict=True)]
    return (
        np.concatenate(triangles),
        np.concatenate([solid[1] for solid in solids], axis=1),
        np.concatenate([solid[2] for solid in solids], axis=1),
    )


def _smooth(triangles: Triangles, places: Places) -> Places:
    """Normals at vertices: of the triangles about them, by their area."""
    normals = np.zeros_like(places)
    for key, spots in enumerate(places):
        a, b, c = (spots[corner] for corner in triangles.T)
        crosses = np.cross(b - a, c - a)
        for axis in range(3):
            total = np.bincount(triangles.ravel(), np.repeat(crosses[:, axis], 3), minlength=len(spots))
            normals[key, :, axis] = total
    return _unit(normals, fallback=np.array([0.0, 0.0, 1.0]))


def _unit(vectors: np.ndarray, *, fallback: Float[np.ndarray, " 3"]) -> np.ndarray:
    """Vectors of length 1; of none, a given one."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 1e-15, vectors / np.where(lengths > 1e-15, lengths, 1.0), fallback)


def _across(ways: Float[np.ndarray, "_ 3"]) -> Float[np.ndarray, "_ 3"]:
    """A direction across each of several, the next one turned from the last as little as possible."""
    least = np.eye(3)[int(np.argmin(np.abs(ways[0])))]
    result = [_unit(np.cross(ways[0], least), fallback=least)]
    for way in ways[1:]:
        result.append(_unit(result[-1] - (result[-1] @ way) * way, fallback=np.cross(way, result[-1])))
    return np.array(result)


def _rotate(
    vectors: Float[np.ndarray, "_ 3"], before: Float[np.ndarray, "_ 3"], after: Float[np.ndarray, "_ 3"]
) -> Float[np.ndarray, "_ 3"]:
    """Vectors across `before` turned by the shortest turn to `after` (Rodrigues' formula)."""
    cosines = np.einsum("pd,pd->p", before, after)[:, None]
    axes = np.cross(before, after)
    along = np.einsum("pd,pd->p", axes, vectors)[:, None]
    turned = vectors * cosines + np.cross(axes, vectors) + axes * along / np.maximum(1 + cosines, 1e-9)
    across = turned - np.einsum("pd,pd->p", turned, after)[:, None] * after
    return _unit(across, fallback=np.array([0.0, 0.0, 1.0]))
