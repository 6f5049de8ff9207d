"""`improve`: move the nodes of tetrahedra until they are well shaped and their outer faces lie on a surface."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Elements, Nodes
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.surface import Solid
from hydrostat.kernel import native

_SAMPLES = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
"""Places of a facet that should lie on the surface, by their weights."""

_FACING = 0.3
"""Cosine of the angle between a facet and the surface near it, below which that is another part of the surface."""


@dataclass(frozen=True)
class ImproveStage:
    """Rounds of improvement under the same weights."""

    rounds: int  # number of projections of the outer faces onto the surface
    sweeps: int  # number of moves of every node in each round
    power: float  # exponent of the shape measure; the higher, the more the worst elements count
    pull: float  # weight of the surface distance relative to shape, at one element size


def improve(mesh: Mesh, solid: Solid, *, element_size: float, stages: tuple[ImproveStage, ...]) -> Mesh:
    """Mesh with its nodes moved; no element is ever turned over.

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
                native.sweep(
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
    """Plane of the surface at each sample: normal and offset [element sizes]; normal 0 where none faces it.

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
