"""`QuadraticSolid`: the elastic energy of a body of quadratic simplices, which bend as they should."""

from collections.abc import Mapping
from copy import copy
from functools import cached_property
from itertools import combinations
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, ScatterMap, group_terms
from hydrostat.mechanics.plane_stress import thickening_works

MAX_POINTWISE_RATIO = {2: 8.0, 3: 4.0}
"""Lambda that counts at each point, at most, over mu, in the plane and in space; the rest counts for the mean volume.

With all of it at each point elements lock, with none they are too soft: `lab/locking/bending.py` and decision 0044.
"""

QuadraticElements = Int[np.ndarray, "elements corners"]
"""Nodes of quadratic simplices: corners, then the middles of the edges in the order of `combinations`."""


class QuadraticSolid(Energy):
    """Compressible Neo-Hookean solid on quadratic simplices: 6 nodes a triangle, 10 a tetrahedron.

    Psi(F) = mu/2 tr(F^T F - I) - mu ln J + p/2 (ln J)^2 at 3 or 4 points of quadrature, and (lambda - p)/2 (ln J)^2 of
    the mean J of the element, with p = min(lambda, c mu), c = `MAX_POINTWISE_RATIO`. Of a homogeneous deformation the
    sum is that of `NeoHookean`. In the plane this is plane strain, or plane stress (`as_plane_stress`).
    """

    convex: ClassVar[bool] = False
    thin = False

    def __init__(
        self,
        nodes: Nodes,
        elements: QuadraticElements,
        *,
        mu: float | Vector,
        lame: float | Vector | None,
        thickness: float | Vector = 1.0,
        materials: Int[np.ndarray, " elements"] | None = None,
        metrics: Float[np.ndarray, "points dim dim"] | None = None,
    ) -> None:
        """Material of Lame's parameters `mu` and `lame` [Pa] on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            elements: nodes of each element: corners, then middles of edges, which may lie off the straight line.
            mu: shear modulus, one number or one for each element.
            lame: Lame's first parameter, likewise; None where another energy resists a change of volume.
            thickness: thickness as of `NeoHookean`.
            materials: index of the material of each element, counted from 0, for `parameter_derivative`; all of one by
                default.
            metrics: A of each point, if tr(F A F^T) stands for tr(F^T F): F is counted from a rest shape that crept.
        """
        count, dim = len(elements), nodes.shape[1]
        self.stencils = np.ascontiguousarray(elements)
        self.mu, self.lame = np.broadcast_to(mu, count), np.broadcast_to(0.0 if lame is None else lame, count)
        self.volumetric = lame is not None
        self.materials = np.zeros(count, dtype=np.int64) if materials is None else materials
        derivatives, weights = _quadrature(dim)
        spans = np.einsum("ecd,qcr->eqdr", nodes[elements], derivatives)
        self._gradients = np.einsum("qcr,eqrd->eqcd", derivatives, np.linalg.inv(spans))
        self._weights = np.linalg.det(spans) * weights * np.reshape(thickness, (-1, 1))
        self._offsets = np.zeros((0, dim + 1, dim, dim))
        if metrics is not None:
            roots = np.linalg.cholesky(metrics).reshape(count, dim + 1, dim, dim)
            self._gradients = self._gradients @ roots
            self._offsets = roots - np.eye(dim)
        self._rest, self._thickness = nodes, thickness

    def with_metrics(self, metrics: Float[np.ndarray, "points dim dim"], modulus: float) -> "QuadraticSolid":
        """Solid of this shear modulus alone [Pa], whose rest shape has crept: c (tr(F A F^T) / 2 - ln J)."""
        return QuadraticSolid(
            self._rest, self.stencils, mu=modulus, lame=0.0, thickness=self._thickness, metrics=metrics
        )

    def as_plane_stress(self) -> "QuadraticSolid":
        """The same flat solid, free to become thicker or thinner at each point: see `mechanics/plane_stress.py`."""
        found = copy(self)
        found.thin = True
        vars(found).pop("_moduli", None)
        return found

    @property
    def point_gradients(self) -> Float[np.ndarray, "points corners dim"]:
        """Gradients of the shape functions at each point of quadrature [1/m]."""
        return self._gradients.reshape(-1, *self._gradients.shape[2:])

    @property
    def volumes(self) -> Float[np.ndarray, " points"]:
        """Volume that each point of quadrature stands for [m^3]."""
        return self._weights.ravel()

    def deformation_gradients(self, nodes: Nodes) -> Float[np.ndarray, "points dim dim"]:
        """F at each point of quadrature, element by element."""
        found = np.einsum("ecd,eqcr->eqdr", nodes[self.stencils], self._gradients)
        return found.reshape(-1, *found.shape[2:])

    def value(self, nodes: Nodes, controls: Vector) -> float:
        """Computed from the displacement gradient, so that little is lost to rounding near rest."""
        return native.quadratic_value(nodes - self._rest, *self._groups, self._moduli, self._packed_offsets, self.thin)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self._forces(nodes, self._moduli)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        (terms, corners), dim = self.stencils.shape, nodes.shape[1]
        size, blocks = corners * dim, np.zeros((terms, corners * dim, corners * dim))
        corner = dim * np.arange(corners)
        slots = size**2 * np.arange(terms)[:, None, None] + size * corner + corner[:, None]
        strides = np.full(terms * corners, size)
        given = *self._groups_apart, self._moduli, self._packed_offsets, self.thin
        native.quadratic_hessian(self._apart(nodes), *given, share, slots, strides, blocks.reshape(-1))
        return blocks

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        native.quadratic_gradient(
            nodes - self._rest, *self._groups, self._moduli, self._packed_offsets, self.thin, total
        )

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        given = *self._groups, self._moduli, self._packed_offsets, self.thin
        native.quadratic_hessian(nodes - self._rest, *given, share, *places)

    def min_volume_ratio(self, nodes: Nodes) -> float:
        return native.quadratic_least(nodes - self._rest, *self._groups, self._moduli, self._packed_offsets, self.thin)

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By mu and lame of each material, and by the thickness."""
        one, none = np.ones(len(self.stencils)), np.zeros(len(self.stencils))
        most = MAX_POINTWISE_RATIO[nodes.shape[1]]
        split = self.lame > most * self.mu
        apart = [
            self._work(nodes, field, *moduli) for moduli in ((one, none, none), (none, one, none), (none, none, one))
        ]
        shear, points, mean = apart
        by_mu = shear + np.where(split, most * (points - mean), 0.0)
        by_lame = np.where(split, mean, points)
        if self.thin:
            gradients = self.deformation_gradients(nodes), self.deformation_gradients(field)
            thickening, by_lame = thickening_works(self.mu, self.lame, self.volumes, *gradients)
            by_mu = shear + thickening
        own = self.mu > 0  # other energies stand for elements without moduli
        works = {"mu": np.bincount(self.materials, own * by_mu)}
        if self.volumetric:
            works["lame"] = np.bincount(self.materials, own * by_lame)
        return {**works, "thickness": np.array([float(self.mu @ by_mu + self.lame @ by_lame)])}

    def _work(self, nodes: Nodes, field: Nodes, mu: Vector, points: Vector, mean: Vector) -> Vector:
        """Work of the forces of each element along a field, were the moduli these."""
        forces = self._forces(nodes, np.stack([group_terms(moduli, float) for moduli in (mu, points, mean)]))
        return (forces * field[self.stencils]).sum(axis=(1, 2))

    def _forces(self, nodes: Nodes, moduli: Float[np.ndarray, "3 groups 8"]) -> Blocks:
        """Gradient of each element, were the moduli these."""
        total = np.zeros((self.stencils.size, nodes.shape[1]))
        native.quadratic_gradient(
            self._apart(nodes), *self._groups_apart, moduli, self._packed_offsets, self.thin, total
        )
        return total.reshape(*self.stencils.shape, -1)

    def _apart(self, nodes: Nodes) -> Nodes:
        """Displacements of the nodes of each element, as if no two had a node in common."""
        return (nodes - self._rest)[self.stencils].reshape(-1, nodes.shape[1])

    @cached_property
    def _groups_apart(self) -> tuple:
        own = np.arange(self.stencils.size).reshape(self.stencils.shape)
        return group_terms(own, np.int32), *self._groups[1:]

    @cached_property
    def _groups(self) -> tuple:
        packed = group_terms(self._gradients, float), group_terms(self._weights, float)
        return group_terms(self.stencils, np.int32), *packed, len(self.stencils)

    @cached_property
    def _packed_offsets(self) -> np.ndarray:
        return group_terms(self._offsets, float)

    @cached_property
    def _moduli(self) -> Float[np.ndarray, "3 groups 8"]:
        """Mu, and lambda in its two shares; in plane stress nothing locks, so all of it counts at the points."""
        points = self.lame if self.thin else np.minimum(self.lame, MAX_POINTWISE_RATIO[self._rest.shape[1]] * self.mu)
        return np.stack([group_terms(moduli, float) for moduli in (self.mu, points, self.lame - points)])


def _quadrature(dim: int) -> tuple[Float[np.ndarray, "points corners dim"], float]:
    """Derivatives of the shape functions at points that integrate quadratics exactly, and the weight of each point."""
    outer = 2 / 3 if dim == 2 else (5 + 3 * 5**0.5) / 20
    points = np.full((dim + 1, dim + 1), (1 - outer) / dim)
    np.fill_diagonal(points, outer)
    return shape_gradients(points), 1 / 6 if dim == 2 else 1 / 24


def shape_gradients(points: Float[np.ndarray, "points barycentric"]) -> Float[np.ndarray, "points corners dim"]:
    """Derivatives of the quadratic shape functions in the unit simplex, at points of barycentric coordinates."""
    dim = points.shape[1] - 1
    own = np.concatenate([-np.ones((1, dim)), np.eye(dim)])  # derivatives of the barycentric coordinates
    corners = (4 * points - 1)[:, :, None] * own
    pairs = [(points[:, [one]], own[two], points[:, [two]], own[one]) for one, two in combinations(range(dim + 1), 2)]
    middles = np.stack([4 * (a * b + c * d) for a, b, c, d in pairs], axis=1)
    return np.concatenate([corners, middles], axis=1)
