"""`node_strains`, `node_stresses`: stretch and stress of a body in a pose."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.geometry import Mesh
from hydrostat.mechanics import FoamLaw, solve_thickening
from hydrostat.robot import Body, Material, Plane, Robot


def node_strains(robot: Robot, nodes: Nodes) -> Vector:
    """Largest principal stretch of the body less 1, of the elements around each node by their volumes.

    It is what a thread drawn on the body along the worst direction would be lengthened by. A flat body in plane strain
    has the stretch 1 across the plane, so nothing is below 0 there.
    """
    grid = _operators(robot.body.mesh)
    shape = _Stretch(grid, nodes, robot.body)
    return grid.average(np.sqrt(shape.largest()) - 1.0)


def node_stresses(robot: Robot, nodes: Nodes) -> Vector:
    """Von Mises stress of the body [Pa], of the elements around each node by their volumes.

    Cauchy's stress of a Neo-Hookean material is mu/J (B - I) + lambda/J ln J I (Bonet 1998 and `NeoHookean`), so only
    B's deviator counts: it is mu/J sqrt(3/2) |dev B|. That of foam is the derivative of `FoamLaw` over J.
    """
    grid = _operators(robot.body.mesh)
    shape = _Stretch(grid, nodes, robot.body)
    mu = robot.body.lame()[0] * robot.body.stiffness_factors
    stresses = mu * np.sqrt(1.5 * shape.deviation) / shape.volume
    for index, material in enumerate(robot.body.materials):
        own = robot.body.element_materials == index
        if material.foam and own.any():
            stresses[own] = robot.body.stiffness_factors[own] * _foam_stresses(material, shape.squares(own))
    return grid.average(stresses)


def _foam_stresses(material: Material, squares: Float[np.ndarray, "elements 3 3"]) -> Vector:
    """Von Mises stress of foam [Pa] by C of its elements."""
    logs = 0.5 * np.log(np.maximum(np.linalg.eigvalsh(squares), 1e-300))
    mu, lame = material.lame
    shares, exponents = np.array([(term.share, term.exponent) for term in material.foam]).T
    stress = mu * FoamLaw(shares, exponents, lame / (2 * mu)).stresses(logs) * np.exp(-logs.sum(axis=1, keepdims=True))
    return np.sqrt(1.5 * ((stress - stress.mean(axis=1, keepdims=True)) ** 2).sum(axis=1))


WARNED_SHARE = 0.02
"""Share of the body that must leave the range of its material to be worth a warning: single elements at points do."""


def find_overstrain(robot: Robot, nodes: Nodes) -> str:
    """Warn of elements outside the range of stretch in which their material is known; empty if hardly any is."""
    body, grid = robot.body, _operators(robot.body.mesh)
    shape = _Stretch(grid, nodes, body)
    longest, shortest = np.sqrt(shape.largest()), np.sqrt(np.maximum(shape.smallest(), 0.0))
    ranges = [(one.largest_stretch or np.inf, 1 - (one.largest_squeeze or np.inf)) for one in body.materials]
    most, least = np.array(ranges)[body.element_materials].T
    beyond = np.maximum(longest / most, (1 - shortest) / np.maximum(1 - least, 1e-9))
    outside, volumes = beyond > 1, body.mesh.volumes
    share = float(volumes[outside].sum() / volumes.sum())
    if share < WARNED_SHARE:
        return ""
    worst = int(np.argmax(beyond))
    material = body.materials[body.element_materials[worst]]
    name, at = material.name or "the material", body.mesh.nodes[body.mesh.elements[worst]].mean(axis=0)
    place = ", ".join(f"{1e3 * value + 0.0:.0f}" for value in at)
    return (
        f"{100 * share:.0f} % of the body is strained beyond the known range of {name} "
        f"({-100 * (material.largest_squeeze or 1):.0f} to {100 * ((material.largest_stretch or np.inf) - 1):+.0f} %), "
        f"worst {100 * (shortest[worst] - 1):.0f} and {100 * (longest[worst] - 1):+.0f} % near [{place}] mm at rest"
    )


@dataclass(frozen=True, eq=False)
class _NodeOperators:
    """Operators of a mesh that do not depend on the pose; plain sums, as scipy.sparse takes 65 ms to load."""

    elements: Int[np.ndarray, "elements corners"]
    gradients: Float[
        np.ndarray, "elements dim corners"
    ]  # derivative along each axis at rest by the value at each corner
    weights: Float[np.ndarray, " corners"]  # share of each element in the value of each of its corners, in one row

    def deformation_gradients(self, nodes: Nodes) -> Float[np.ndarray, "elements dim dim"]:
        """Derivatives of places, a row for each coordinate at rest."""
        return self.gradients @ nodes[self.elements]

    def average(self, values: Float[np.ndarray, " elements"]) -> Vector:
        """Values of nodes by those of the elements around them."""
        corners = self.elements.shape[1]
        return np.bincount(self.elements.ravel(), self.weights * np.repeat(values, corners))


@lru_cache(maxsize=2)
def _operators(mesh: Mesh) -> _NodeOperators:
    corners = mesh.elements.shape[1]
    inverse = np.linalg.inv(np.swapaxes(mesh.nodes[mesh.elements[:, 1:]] - mesh.nodes[mesh.elements[:, :1]], 1, 2))
    gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
    weights = np.repeat(mesh.volumes, corners)
    total = np.maximum(np.bincount(mesh.elements.ravel(), weights, len(mesh.nodes)), np.finfo(float).tiny)
    across = np.ascontiguousarray(np.swapaxes(gradients, 1, 2))
    return _NodeOperators(mesh.elements, across, weights / total[mesh.elements.ravel()])


class _Stretch:
    """C = F^T F of all elements, by its invariants; in plane strain with the stretch 1 across the plane.

    Attributes:
        mean: a third of the trace of C.
        deviation: |dev C|^2, which is |dev B|^2 too.
        volume: volume ratio J.
    """

    def __init__(self, grid: _NodeOperators, nodes: Nodes, body: Body) -> None:
        derivatives, dim = grid.deformation_gradients(nodes), nodes.shape[1]
        rows = [derivatives[:, axis] for axis in range(dim)]
        stretch = np.zeros((3, 3, len(derivatives)))
        stretch[2, 2] = 1.0
        if body.plane is Plane.STRESS:
            stretch[2, 2] += _thickening(body, np.linalg.det(derivatives) - 1.0)
        for i in range(dim):
            for j in range(i, dim):
                stretch[i, j] = stretch[j, i] = np.einsum("ek,ek->e", rows[i], rows[j])
        self.mean = (stretch[0, 0] + stretch[1, 1] + stretch[2, 2]) / 3.0
        for i in range(3):
            stretch[i, i] -= self.mean
        self._off = stretch
        self.deviation: Float[np.ndarray, " elements"] = np.einsum("ije,ije->e", stretch, stretch)
        self.volume = np.sqrt(np.maximum(_determinant(stretch, self.mean), 1e-300))

    def squares(self, chosen: np.ndarray) -> Float[np.ndarray, "elements 3 3"]:
        """C of some elements."""
        return np.moveaxis(self._off[:, :, chosen], -1, 0) + self.mean[chosen, None, None] * np.eye(3)

    def largest(self) -> Float[np.ndarray, " elements"]:
        """Largest eigenvalue of C."""
        return self._eigenvalue(0.0)

    def smallest(self) -> Float[np.ndarray, " elements"]:
        """Smallest eigenvalue of C."""
        return self._eigenvalue(2.0 * np.pi / 3.0)

    def _eigenvalue(self, turn: float) -> Float[np.ndarray, " elements"]:
        """Eigenvalue of C by its angle, in closed form (Smith 1961)."""
        spread = np.sqrt(self.deviation / 6.0)
        cube = np.maximum(spread**3, 1e-300)
        turned = np.clip(0.5 * _determinant(self._off, 0.0 * self.mean) / cube, -1.0, 1.0)
        return self.mean + 2.0 * spread * np.cos(np.arccos(turned) / 3.0 + turn)


def _thickening(body: Body, change: Vector) -> Vector:
    """Return s^2 - 1 of the stretch s across a body in plane stress, at a change of area J - 1."""
    mu, lame = body.lame()
    ratios = lame / (2 * mu + lame)  # nu / (1 - nu)
    foam = np.expm1(-2 * ratios * np.log1p(np.maximum(change, -1.0 + 1e-12)))
    return np.where(body.element_foams, foam, solve_thickening(change, mu, lame))


def _determinant(off: Float[np.ndarray, "3 3 elements"], shift: Vector) -> Vector:
    """Determinant of the symmetric matrices `off` + `shift` I."""
    a, b, c = off[0, 0] + shift, off[1, 1] + shift, off[2, 2] + shift
    d, e, f = off[0, 1], off[0, 2], off[1, 2]
    return a * b * c + 2.0 * d * e * f - a * f * f - b * e * e - c * d * d
