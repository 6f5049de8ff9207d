"""`Colouring`: what the body is coloured by: felt, strain, stress, or the muscles that pull."""

from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from scipy.sparse import csr_array

from hydrostat.arrays import Nodes, Vector
from hydrostat.geometry.mesh import Mesh
from hydrostat.robot import Robot
from hydrostat.studio.view.things import RobotShape


class Colouring(StrEnum):
    """What the colours of the body mean."""

    FELT = "felt"
    STRAIN = "strain"
    STRESS = "stress"
    MUSCLES = "muscles"


@dataclass(frozen=True, kw_only=True)
class Scale:
    """What a legend says."""

    title: str  # what is shown, such as "strain"
    most: float  # value of the last colour, in SI; the first is 0. It does not change as the body moves.
    low: str  # the first as text, with its unit
    high: str  # the last as text, with its unit; more than that has the same colour


FULL = 0.5  # strain of the last colour, if the material does not say how far it can be stretched


def scale(robot: Robot, colouring: Colouring) -> Scale | None:
    """What the colours of a robot mean; None for plain felt.

    The last colour of the stress is what uniaxial tension of the last strain would be, were the body linear.
    """
    material = robot.body.material
    strain = FULL if material.largest_stretch is None else min(material.largest_stretch - 1.0, 1.0)
    if colouring is Colouring.STRAIN:
        return Scale(title="Strain", most=strain, low="0 %", high=f"{100 * strain:.3g} %")
    if colouring is Colouring.STRESS:
        stress = strain * material.young
        return Scale(title="Stress (von Mises)", most=stress, low="0 kPa", high=f"{1e-3 * stress:.3g} kPa")
    if colouring is Colouring.MUSCLES:
        return Scale(title="Muscles", most=1.0, low="none", high="strongest")
    return None


def node_values(robot: Robot, shape: RobotShape, colouring: Colouring) -> Vector | None:
    """A value from 0 to 1 for each node, as a share of the `scale`; None for plain felt, and where no muscle is."""
    if colouring is Colouring.MUSCLES:
        return shape.muscles
    legend, nodes = scale(robot, colouring), shape.nodes
    if legend is None:
        return None
    found = node_strains(robot, nodes) if colouring is Colouring.STRAIN else node_stresses(robot, nodes)
    return np.clip(found / legend.most, 0.0, 1.0)


def node_strains(robot: Robot, nodes: Nodes) -> Vector:
    """Largest principal stretch of the body less 1, of the elements around each node by their volumes.

    It is what a thread drawn on the body along the worst direction would be lengthened by. A flat body in plane strain
    has the stretch 1 across the plane, so nothing is below 0 there.
    """
    grid = _operators(robot.body.mesh)
    shape = _Stretch(grid, nodes)
    return grid.average @ (np.sqrt(shape.largest()) - 1.0)


def node_stresses(robot: Robot, nodes: Nodes) -> Vector:
    """Von Mises stress of the Neo-Hookean body [Pa], of the elements around each node by their volumes.

    Cauchy's stress is mu/J (B - I) + lambda/J ln J I (Bonet 1998 and `NeoHookean`), so only B's deviator counts: it is
    mu/J sqrt(3/2) |dev B|.
    """
    grid = _operators(robot.body.mesh)
    shape = _Stretch(grid, nodes)
    mu, _ = robot.body.material.lame
    return grid.average @ (mu * np.sqrt(1.5 * shape.deviation) / shape.volume)


@dataclass(frozen=True, eq=False)
class _NodeOperators:
    """What of a mesh does not change."""

    dim: int  # of the body
    slopes: csr_array  # gives F of all elements, a row for each element and coordinate of rest, from the nodes
    average: csr_array  # gives values of nodes from those of elements


@lru_cache(maxsize=2)
def _operators(mesh: Mesh) -> _NodeOperators:
    count, corners = mesh.elements.shape
    dim = mesh.dim
    inverse = np.linalg.inv(np.swapaxes(mesh.nodes[mesh.elements[:, 1:]] - mesh.nodes[mesh.elements[:, :1]], 1, 2))
    gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
    rows = np.broadcast_to(np.arange(count * dim).reshape(count, 1, dim), gradients.shape)
    columns = np.broadcast_to(mesh.elements[:, :, None], gradients.shape)
    entries = (gradients.ravel(), (rows.ravel(), columns.ravel()))
    slopes = csr_array(entries, shape=(count * dim, len(mesh.nodes)))
    weights = np.repeat(mesh.volumes, corners)
    total = np.maximum(np.bincount(mesh.elements.ravel(), weights, len(mesh.nodes)), np.finfo(float).tiny)
    places = (mesh.elements.ravel(), np.repeat(np.arange(count), corners))
    average = csr_array((weights / total[mesh.elements.ravel()], places), shape=(len(mesh.nodes), count))
    return _NodeOperators(dim, slopes, average)


class _Stretch:
    """C = F^T F of all elements, by its invariants; in the plane with the stretch 1 across it.

    Attributes:
        mean: a third of the trace of C.
        deviation: |dev C|^2, which is |dev B|^2 too.
        volume: J.
    """

    def __init__(self, grid: _NodeOperators, nodes: Nodes) -> None:
        slopes = (grid.slopes @ nodes).reshape(-1, grid.dim, grid.dim)
        rows = [slopes[:, axis] for axis in range(grid.dim)]
        stretch = np.zeros((3, 3, len(slopes)))
        stretch[2, 2] = 1.0
        for i in range(grid.dim):
            for j in range(i, grid.dim):
                stretch[i, j] = stretch[j, i] = np.einsum("ek,ek->e", rows[i], rows[j])
        self.mean = (stretch[0, 0] + stretch[1, 1] + stretch[2, 2]) / 3.0
        for i in range(3):
            stretch[i, i] -= self.mean
        self._off = stretch
        self.deviation: Float[np.ndarray, " elements"] = np.einsum("ije,ije->e", stretch, stretch)
        self.volume = np.sqrt(np.maximum(_determinant(stretch, self.mean), 1e-300))

    def largest(self) -> Float[np.ndarray, " elements"]:
        """The largest eigenvalue of C, in closed form (Smith 1961)."""
        spread = np.sqrt(self.deviation / 6.0)
        cube = np.maximum(spread**3, 1e-300)
        turned = np.clip(0.5 * _determinant(self._off, 0.0 * self.mean) / cube, -1.0, 1.0)
        return self.mean + 2.0 * spread * np.cos(np.arccos(turned) / 3.0)


def _determinant(off: Float[np.ndarray, "3 3 elements"], shift: Vector) -> Vector:
    """Determinant of the symmetric matrices `off` + `shift` I."""
    a, b, c = off[0, 0] + shift, off[1, 1] + shift, off[2, 2] + shift
    d, e, f = off[0, 1], off[0, 2], off[1, 2]
    return a * b * c + 2.0 * d * e * f - a * f * f - b * e * e - c * d * d
