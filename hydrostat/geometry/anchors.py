"""`Anchors`: points stuck to the material of a mesh."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import csr_array

from hydrostat.arrays import Nodes, Points
from hydrostat.geometry.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Anchors:
    """Points held by an element and barycentric weights (R24, E10).

    Attributes:
        stencils: nodes of the element that holds each point, (points, dim + 1).
        weights: barycentric weights, rows sum to one.
        distances: how far each asked point was from the body [m]; 0 where it was inside.
    """

    stencils: Int[np.ndarray, "points corners"]
    weights: Float[np.ndarray, "points corners"]
    distances: Float[np.ndarray, " points"]

    def positions(self, nodes: Nodes) -> Points:
        """Where the anchors are when the nodes are at `nodes` [m]."""
        return np.einsum("pc,pcd->pd", self.weights, nodes[self.stencils])

    def matrix(self, node_count: int) -> csr_array:
        """Sparse interpolation matrix W, (points, nodes): positions = W @ nodes."""
        rows = np.repeat(np.arange(len(self.stencils)), self.stencils.shape[1])
        entries = (self.weights.ravel(), (rows, self.stencils.ravel()))
        return csr_array(entries, shape=(len(self.stencils), node_count))

    @property
    def inside(self) -> Bool[np.ndarray, " points"]:
        """Whether each point lay in the body (a hair outside, 1e-9 of an element, counts as inside)."""
        return self.distances == 0.0


def locate(mesh: Mesh, points: Points) -> Anchors:
    """Stick points to the rest shape of a mesh.

    A point outside is stuck to the nearest place of the body; `distances` says how far that was.
    """
    corners = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    stencils, weights, distances = [], [], []
    for point in points:
        local = np.einsum("eij,ej->ei", inverse, point - corners[:, 0])
        barycentric = np.column_stack([1.0 - local.sum(axis=1), local])
        element = int(np.argmax(barycentric.min(axis=1)))
        if barycentric[element].min() >= -1e-9:
            weight, distance = np.clip(barycentric[element], 0.0, None), 0.0
        else:
            element, weight = _nearest(corners, point)
            distance = float(np.linalg.norm(weight @ corners[element] - point))
        stencils.append(mesh.elements[element])
        weights.append(weight / weight.sum())
        distances.append(distance)
    count, width = len(points), mesh.dim + 1
    return Anchors(
        np.array(stencils, dtype=mesh.elements.dtype).reshape(count, width),
        np.array(weights, dtype=float).reshape(count, width),
        np.array(distances, dtype=float),
    )


def _nearest(corners: Float[np.ndarray, "elements corners dim"], point: Float[np.ndarray, " dim"]) -> tuple[int, np.ndarray]:
    """Element and weights of the place of the body nearest to a point outside it (active-set projection)."""
    reach = np.linalg.norm(corners - point, axis=2)
    candidates = np.argsort(reach.min(axis=1), kind="stable")[:64]
    best_weight, best_element, best = np.ones(corners.shape[1]), 0, np.inf
    for element in candidates:
        weight = _project(corners[element], point)
        distance = float(np.linalg.norm(weight @ corners[element] - point))
        if distance < best:
            best_weight, best_element, best = weight, int(element), distance
    return best_element, best_weight


def _project(corners: Float[np.ndarray, "corners dim"], point: Float[np.ndarray, " dim"]) -> np.ndarray:
    """Barycentric weights of the point of a simplex nearest to `point`: drop negative corners and solve again."""
    keep = np.arange(len(corners))
    while True:
        base = corners[keep]
        spans = (base[1:] - base[0]).T
        local = np.linalg.lstsq(spans, point - base[0], rcond=None)[0] if len(keep) > 1 else np.zeros(0)
        weight = np.concatenate([[1.0 - local.sum()], local])
        if weight.min() >= 0.0:
            full = np.zeros(len(corners))
            full[keep] = weight
            return full
        keep = np.delete(keep, int(np.argmin(weight)))
