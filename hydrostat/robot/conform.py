"""`conform`: a mesh whose nodes are moved onto the borders of regions."""

from collections.abc import Sequence

import numpy as np

from hydrostat.arrays import Float, Int, Nodes
from hydrostat.geometry import Mesh
from hydrostat.robot.part import BodyPart

PASSES = 3
MIN_QUALITY = 0.25
"""Least shape of an element that a move may leave, 1 for a regular one; or what it was before."""


def conform(mesh: Mesh, parts: Sequence[BodyPart]) -> Mesh:
    """Mesh with nodes moved onto the borders of parts, where an edge crosses one; nodes on the boundary stay.

    A node moves to the nearest place of the border if it is nearer to it than the other end of an edge that crosses,
    and no element becomes flatter than `MIN_QUALITY`. Elements keep their nodes.
    """
    nodes = mesh.nodes.copy()
    free = np.ones(len(nodes), dtype=bool)
    free[mesh.boundary_nodes] = False
    around = _elements_around(mesh)
    quality = _qualities(nodes, mesh.elements)
    for _ in range(PASSES):
        for part in parts:
            if part.label is not None:
                continue  # its border is one of elements already
            for node, place in _candidates(mesh, nodes, part, free):
                before, touched = nodes[node].copy(), around[node]
                nodes[node] = place
                found = _qualities(nodes, mesh.elements[touched])
                if (found < np.minimum(MIN_QUALITY, quality[touched])).any():
                    nodes[node] = before
                    continue
                quality[touched] = found
                free[node] = False
    return Mesh(nodes, mesh.elements)


def _candidates(
    mesh: Mesh, nodes: Nodes, part: BodyPart, free: np.ndarray
) -> list[tuple[int, Float[np.ndarray, " dim"]]]:
    """Nodes that should move, with their places on the border; those that are nearest to it first."""
    depths, places = part.border(nodes)
    one, two = mesh.edges.T
    crossing = depths[one] * depths[two] < 0
    one, two = one[crossing], two[crossing]
    nearer = np.where(np.abs(depths[one]) <= np.abs(depths[two]), one, two)
    chosen = np.unique(nearer[free[nearer]])
    chosen = chosen[np.argsort(np.abs(depths[chosen]), kind="stable")]
    return [(int(node), places[node]) for node in chosen]


def _elements_around(mesh: Mesh) -> list[Int[np.ndarray, " _"]]:
    """Elements at each node."""
    corners = mesh.elements.ravel()
    owners = np.repeat(np.arange(len(mesh.elements)), mesh.elements.shape[1])[np.argsort(corners, kind="stable")]
    return np.split(owners, np.cumsum(np.bincount(corners, minlength=len(mesh.nodes)))[:-1])


def _qualities(nodes: Nodes, elements: Int[np.ndarray, "elements corners"]) -> Float[np.ndarray, " elements"]:
    """Volume over that of the regular simplex with the same mean square of its edges; below 0 if turned over."""
    corners, dim = nodes[elements], nodes.shape[1]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / (2.0 if dim == 2 else 6.0)
    spans = corners[:, :, None] - corners[:, None]
    squares = (spans**2).sum(axis=(1, 2, 3)) / (dim * (dim + 1))  # each edge stands there twice
    regular = np.sqrt(3.0) / 4 if dim == 2 else np.sqrt(2.0) / 12
    return volumes / (regular * squares ** (dim / 2))
