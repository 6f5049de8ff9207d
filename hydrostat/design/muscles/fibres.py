"""`Fibres`: candidate muscles of a mesh, on its edges or one in each element (R37, E21)."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes
from hydrostat.geometry.mesh import Mesh
from hydrostat.mechanics import FibreEnergy


class FibreKind(StrEnum):
    """Where the candidate muscles are (E21)."""

    EDGES = "edges"
    ELEMENTS = "elements"


@dataclass(frozen=True, eq=False)
class Fibres:
    """Straight fibres between two points of the material each.

    Attributes:
        stencils: nodes that each fibre depends on, (fibres, corners).
        start: weights of those nodes at its first end, rows sum to one.
        end: weights at its second end.
    """

    stencils: Int[np.ndarray, "fibres corners"]
    start: Float[np.ndarray, "fibres corners"]
    end: Float[np.ndarray, "fibres corners"]

    def __len__(self) -> int:
        """Number of fibres."""
        return len(self.stencils)

    def ends(self, nodes: Nodes) -> Float[np.ndarray, "fibres 2 dim"]:
        """Both end points of every fibre when the nodes are at `nodes` [m]."""
        corners = nodes[self.stencils]
        return np.stack([np.einsum("fc,fcd->fd", weights, corners) for weights in (self.start, self.end)], axis=1)

    def energy(self) -> FibreEnergy:
        """The physics of the fibres; control f is the tension of fibre f."""
        return FibreEnergy(stencils=self.stencils, weights=self.end - self.start)


def edge_fibres(mesh: Mesh) -> Fibres:
    """One fibre on every edge of the mesh."""
    count = len(mesh.edges)
    return Fibres(mesh.edges, np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1)))


def element_fibres(mesh: Mesh, directions: Float[np.ndarray, "elements dim"]) -> Fibres:
    """One fibre through the centroid of every element, along `directions`, from face to face."""
    corners = mesh.nodes[mesh.elements]
    inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
    local = np.einsum("eij,ej->ei", inverse, directions)
    slopes = np.column_stack([-local.sum(axis=1), local])
    centre = 1.0 / (mesh.dim + 1)
    with np.errstate(divide="ignore"):
        reach = centre / np.abs(slopes)
    forward = np.where(slopes < 0, reach, np.inf).min(axis=1)
    backward = np.where(slopes > 0, reach, np.inf).min(axis=1)
    return Fibres(mesh.elements, centre - backward[:, None] * slopes, centre + forward[:, None] * slopes)
