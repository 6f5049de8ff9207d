"""`improve`: move the nodes of tetrahedra until they are well shaped and their outer faces lie on a surface."""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Elements, Nodes
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.surface import Solid
from hydrostat.kernel import INNER, Kernel, njit

_SAMPLES = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
"""Places of a facet that should lie on the surface, by their weights."""

_FACING = 0.3
"""Cosine of the angle between a facet and the surface near it, below which that is another part of the surface."""

_REGULAR = (np.sqrt(2) / 12) ** (2 / 3) / 6  # makes the shape of a regular tetrahedron 1


@dataclass(frozen=True)
class ImproveStage:
    """Rounds of improvement under the same weights."""

    rounds: int  # times that the outer faces look for their place on the surface
    sweeps: int  # times in each that every node moves
    power: float  # of the shape of a tetrahedron; the higher, the more the worst count
    pull: float  # of the surface, against shape, for a distance of one element size


def improve(mesh: Mesh, solid: Solid, *, element_size: float, stages: tuple[ImproveStage, ...]) -> Mesh:
    """The mesh with its nodes moved; no element is ever turned over.

    Least of the sum, over tetrahedra, of shape^power and, over points of the outer faces, of their squared distance
    from the surface. shape = (sum of squared edges) / (6 (6 sqrt(2) V)^(2/3)), the inverse of the mean ratio (Liu and
    Joe 1994): 1 for a regular tetrahedron, infinite for a flat one, convex in each node. The distance is that along
    the normal (as in registration, Chen and Medioni 1991), so that faces slide on the surface, sharp edges draw
    edges, and the mean of the distances, and with it the error of the volume, is about zero.
    """
    nodes = mesh.nodes / element_size
    star = _stars(mesh.elements, len(nodes))
    ring = _stars(mesh.boundary, len(nodes))
    for stage in stages:
        for _ in range(stage.rounds):
            normals, offsets = _planes(nodes, mesh.boundary, solid, element_size)
            for _ in range(stage.sweeps):
                _sweep(
                    nodes, mesh.elements, *star, mesh.boundary, *ring, normals, offsets, _SAMPLES,
                    stage.power, stage.pull / len(_SAMPLES),
                )  # fmt: skip
    return Mesh(nodes * element_size, mesh.elements)


def _stars(simplices: Elements, count: int) -> tuple[Int[np.ndarray, " _"], Int[np.ndarray, " _"]]:
    """Begin of the list of each node, and the lists: corners (corner count x simplex + corner) at the node."""
    start = np.concatenate([[0], np.cumsum(np.bincount(simplices.ravel(), minlength=count))])
    return start, np.argsort(simplices.ravel(), kind="stable")


def _planes(
    nodes: Nodes, facets: Elements, solid: Solid, element_size: float
) -> tuple[Float[np.ndarray, "facets samples 3"], Float[np.ndarray, "facets samples"]]:
    """The plane of the surface at each sample: normal and offset [element sizes]; normal 0 where none faces it.

    The normal is the way to the nearest place, outward as the facet is: so at an edge or a corner of the surface it is
    the one that a distance has there.
    """
    corners = nodes[facets]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across = np.repeat(across / np.linalg.norm(across, axis=1, keepdims=True), len(_SAMPLES), axis=0)
    samples = np.einsum("sc,fcd->fsd", _SAMPLES, corners).reshape(-1, 3)
    places, triangles = solid.nearest(samples * element_size)
    places = places / element_size
    away = samples - places
    gaps = np.linalg.norm(away, axis=1)
    own = solid.normals[triangles]
    normals = np.where((gaps > 1e-6)[:, None], away / np.maximum(gaps, 1e-6)[:, None], own)
    along = np.einsum("nd,nd->n", normals, across)
    normals *= np.sign(along)[:, None]
    normals[(np.abs(along) < _FACING) | (np.einsum("nd,nd->n", own, across) < -_FACING)] = 0.0
    offsets = np.einsum("nd,nd->n", normals, places)
    return normals.reshape(len(facets), -1, 3), offsets.reshape(len(facets), -1)


_OTHERS = ((1, 3, 2), (0, 2, 3), (0, 3, 1), (0, 1, 2))
"""The other corners p, q, r of a tetrahedron, so turned that (x - p) . ((q - p) x (r - p)) = 6 V."""


@njit(**INNER)
@no_type_check
def _shape(x, elements, nodes, corner, others):
    """Shape of a tetrahedron with a node at x, and what its derivatives need; infinite if it is turned over."""
    element, place = corner // 4, corner % 4
    p = nodes[elements[element, others[place, 0]]]
    q = nodes[elements[element, others[place, 1]]]
    r = nodes[elements[element, others[place, 2]]]
    px, py, pz = x[0] - p[0], x[1] - p[1], x[2] - p[2]
    qx, qy, qz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    rx, ry, rz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    nx, ny, nz = qy * rz - qz * ry, qz * rx - qx * rz, qx * ry - qy * rx
    volume = (px * nx + py * ny + pz * nz) / 6.0
    if not volume > 1e-12:
        return np.inf, 0.0, 0.0, nx, ny, nz, 0.0, 0.0, 0.0
    squares = px * px + py * py + pz * pz + qx * qx + qy * qy + qz * qz + rx * rx + ry * ry + rz * rz
    squares += (px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2
    squares += (px - rx) ** 2 + (py - ry) ** 2 + (pz - rz) ** 2
    squares += (qx - rx) ** 2 + (qy - ry) ** 2 + (qz - rz) ** 2
    root = volume ** (-2.0 / 3.0)
    sx, sy, sz = 2.0 * (3.0 * px - qx - rx), 2.0 * (3.0 * py - qy - ry), 2.0 * (3.0 * pz - qz - rz)
    return _REGULAR * squares * root, volume, squares, nx / 6.0, ny / 6.0, nz / 6.0, sx, sy, sz


@njit(**INNER)
@no_type_check
def _energy(x, node, nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull, others):
    """Sum over the tetrahedra and outer faces at a node when it is at x."""
    total = 0.0
    for place in range(start[node], start[node + 1]):
        value = _shape(x, elements, nodes, star[place], others)[0]
        if value == np.inf:
            return np.inf
        total += value**power
    for place in range(begin[node], begin[node + 1]):
        facet, own = ring[place] // 3, ring[place] % 3
        for sample in range(samples.shape[0]):
            gap = -offsets[facet, sample]
            for axis in range(3):
                there = 0.0
                for corner in range(3):
                    at = x[axis] if corner == own else nodes[facets[facet, corner], axis]
                    there += samples[sample, corner] * at
                gap += normals[facet, sample, axis] * there
            total += pull * gap * gap
    return total


@njit(**INNER)
@no_type_check
def _derivatives(
    node, nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull, others, slope, bend
):
    """Energy at a node where it is, with gradient and Hessian."""
    x = nodes[node]
    slope[:] = 0.0
    bend[:] = 0.0
    total = 0.0
    first = np.empty(3)
    for place in range(start[node], start[node + 1]):
        value, volume, squares, nx, ny, nz, sx, sy, sz = _shape(x, elements, nodes, star[place], others)
        if value == np.inf:
            return np.inf
        total += value**power
        n, s = (nx, ny, nz), (sx, sy, sz)
        for i in range(3):
            first[i] = value * (s[i] / squares - (2.0 / 3.0) * n[i] / volume)
        outer = power * value ** (power - 1.0)
        again = power * (power - 1.0) * value ** (power - 2.0)
        for i in range(3):
            slope[i] += outer * first[i]
            for j in range(3):
                second = (10.0 / 9.0) * n[i] * n[j] / (volume * volume)
                second -= (2.0 / 3.0) * (n[i] * s[j] + s[i] * n[j]) / (volume * squares)
                if i == j:
                    second += 6.0 / squares
                bend[i, j] += outer * value * second + again * first[i] * first[j]
    for place in range(begin[node], begin[node + 1]):
        facet, own = ring[place] // 3, ring[place] % 3
        for sample in range(samples.shape[0]):
            gap = -offsets[facet, sample]
            for axis in range(3):
                there = 0.0
                for corner in range(3):
                    there += samples[sample, corner] * nodes[facets[facet, corner], axis]
                gap += normals[facet, sample, axis] * there
            total += pull * gap * gap
            weight = samples[sample, own]
            for i in range(3):
                slope[i] += 2.0 * pull * gap * weight * normals[facet, sample, i]
                for j in range(3):
                    bend[i, j] += 2.0 * pull * weight * weight * normals[facet, sample, i] * normals[facet, sample, j]
    return total


@Kernel
@no_type_check
def _sweep(nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull):
    """Each node in turn takes a step of Newton on what it alone can change, halved until that falls."""
    others = np.array(_OTHERS)
    slope, bend, x = np.empty(3), np.empty((3, 3)), np.empty(3)
    for node in range(nodes.shape[0]):
        before = _derivatives(
            node, nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull, others,
            slope, bend,
        )  # fmt: skip
        if not before < np.inf:
            continue
        a, b, c = bend[0, 0], bend[0, 1], bend[0, 2]
        d, e, f = bend[1, 1], bend[1, 2], bend[2, 2]
        one, two, three = d * f - e * e, c * e - b * f, b * e - c * d
        size = a * one + b * two + c * three
        if not size > 0.0:
            continue
        sx = -(one * slope[0] + two * slope[1] + three * slope[2]) / size
        sy = -(two * slope[0] + (a * f - c * c) * slope[1] + (b * c - a * e) * slope[2]) / size
        sz = -(three * slope[0] + (b * c - a * e) * slope[1] + (a * d - b * b) * slope[2]) / size
        share = 1.0
        for _ in range(8):
            x[0] = nodes[node, 0] + share * sx
            x[1] = nodes[node, 1] + share * sy
            x[2] = nodes[node, 2] + share * sz
            after = _energy(
                x, node, nodes, elements, start, star, facets, begin, ring, normals, offsets, samples, power, pull,
                others,
            )  # fmt: skip
            if after < before:
                nodes[node] = x
                break
            share *= 0.5
