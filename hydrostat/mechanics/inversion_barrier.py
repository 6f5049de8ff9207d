"""`InversionBarrier`: energy that keeps quadratic elements from inverting away from their points of quadrature."""

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations, permutations, product
from typing import ClassVar, NamedTuple

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.kernel import native
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, ScatterMap, nearest_semidefinite
from hydrostat.mechanics.quadratic_solid import QuadraticElements, shape_gradients

BARRIER_START = 0.3
"""Ratio of volumes from which on the barrier is 0."""

Coefficients = Float[np.ndarray, "elements coefficients"]


class InversionBarrier(Energy):
    """Sum of V mu phi(c) / m over m ratios c of each quadratic element: the Bernstein coefficients of J and its parts.

    phi(c) = -ln(c / c0)^3 below c0 = `BARRIER_START`, 0 above; it has two continuous derivatives. J is a polynomial,
    quadratic in a triangle and cubic in a tetrahedron, nowhere less than its least coefficient, so no element can
    invert. Nor can its linear parts, by which pictures, cables and contact see it: their ratios are volume over volume
    at rest.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        nodes: Nodes,
        elements: QuadraticElements,
        *,
        mu: Vector,
        volumes: Float[np.ndarray, " elements"],
        materials: Int[np.ndarray, " elements"],
    ) -> None:
        """Elements on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            elements: nodes of each element: corners, then middles of edges.
            mu: shear modulus of each element [Pa].
            volumes: volume of each element [m^3].
            materials: index of the material of each element, for `parameter_derivative`.
        """
        self.stencils, self.mu, self.materials = np.ascontiguousarray(elements), mu, materials
        self.rest, self._at_rest = nodes, _coefficients(nodes[elements])
        self._volumes = volumes / self._at_rest.shape[1]
        self._last = nodes[:0], self._at_rest, self._find_low(self._at_rest)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        low = self._low(nodes)
        if not low.values.min(initial=1.0) > 0.0:
            return np.inf
        return float(self._stiffness(low) @ -(low.logs**3))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        blocks, low = np.zeros((*self.stencils.shape, nodes.shape[1])), self._low(nodes)
        np.add.at(blocks, low.elements, self._forces(nodes, low))
        return blocks

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        size = self.stencils.shape[1] * nodes.shape[1]
        blocks = np.zeros((len(self.stencils), size, size))
        chosen, found = self._blocks(nodes, share)
        blocks[chosen] = found
        return blocks

    def add_gradient(self, nodes: Nodes, controls: Vector, total: Nodes) -> None:
        """Add the forces of the elements that the barrier pushes, which are few."""
        low = self._low(nodes)
        if low.elements.size:
            np.add.at(total, self.stencils[low.elements], self._forces(nodes, low))

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: ScatterMap) -> None:
        """Add the blocks of these elements."""
        chosen, found = self._blocks(nodes, share)
        if chosen.size:
            native.add_blocks(
                np.ascontiguousarray(self.stencils[chosen]),
                np.ascontiguousarray(places.slots[chosen]),
                places.strides,
                np.ascontiguousarray(found),
                places.data,
            )

    def min_volume_ratio(self, nodes: Nodes) -> float:
        """Least coefficient of J, at most 1."""
        return float(self._shares(nodes)[0].min(initial=1.0))

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        """By mu of each material, and by the thickness."""
        low = self._low(nodes)
        along = (self._gradients(nodes, low) * field[self.stencils[low.elements]]).sum(axis=(1, 2))
        works = self._volumes[low.elements] * low.derivatives * along
        count = int(self.materials.max(initial=-1)) + 1
        return {
            "mu": np.bincount(self.materials[low.elements], works, count).astype(float),  # of none: integers
            "thickness": np.array([float(self.mu[low.elements] @ works)]),
        }

    def _shares(self, nodes: Nodes) -> tuple[Coefficients, "_Low"]:
        """Coefficients of J, and the low ones; the last are kept, as value, forces and Hessian follow one another."""
        last, found, low = self._last
        if not np.array_equal(last, nodes):
            found = _coefficients(nodes[self.stencils]) / self._at_rest
            low = self._find_low(found)
            self._last = nodes.copy(), found, low  # in one assignment, so that threads may share the energy
        return found, low

    def _low(self, nodes: Nodes) -> "_Low":
        """Coefficients that the barrier pushes."""
        return self._shares(nodes)[1]

    @staticmethod
    def _find_low(found: Coefficients) -> "_Low":
        if found.min(initial=BARRIER_START) >= BARRIER_START:
            return _NO_LOW
        elements, places = np.nonzero(~(found >= BARRIER_START))
        values = found[elements, places]
        with np.errstate(invalid="ignore", divide="ignore"):  # an inverted element has no forces, but infinite energy
            return _Low(elements, places, values, np.log(values / BARRIER_START))

    def _stiffness(self, low: "_Low") -> Vector:
        return (self.mu * self._volumes)[low.elements]

    def _forces(self, nodes: Nodes, low: "_Low") -> Blocks:
        """Derivative of the energy of each low coefficient by the nodes of its element [N]."""
        return (self._stiffness(low) * low.derivatives)[:, None, None] * self._gradients(nodes, low)

    def _gradients(self, nodes: Nodes, low: "_Low") -> Blocks:
        """Derivative of each low coefficient by the nodes of its element [1/m]: c is homogeneous in these."""
        corners = nodes[self.stencils[low.elements]]
        corners = corners - corners[:, :1]
        bends = self._bends(corners, low)
        flat = np.matmul(bends, corners.reshape(*bends.shape[:2], 1)) / (nodes.shape[1] - 1)
        return flat.reshape(corners.shape)

    def _bends(self, corners: Float[np.ndarray, "low corners dim"], low: "_Low") -> HessianBlocks:
        """Second derivative of each low coefficient by the nodes of its element."""
        dim, forms = corners.shape[2], _forms(corners.shape[2])[low.places]
        if dim == 2:
            found = 2 * np.einsum("pcd,ab->pcadb", forms, _permutation_signs(2))
        else:
            found = 6 * np.einsum("pcde,pek,abk->pcadb", forms, corners, _permutation_signs(3), optimize=True)
        size = dim * corners.shape[1]
        return found.reshape(len(corners), size, size) / self._at_rest[low.elements, low.places, None, None]

    def _blocks(self, nodes: Nodes, share: float) -> tuple[Int[np.ndarray, " chosen"], HessianBlocks]:
        """Elements that the barrier pushes, and the Hessian of each."""
        low, size = self._low(nodes), self.stencils.shape[1] * nodes.shape[1]
        chosen, owners = np.unique(low.elements, return_inverse=True)
        blocks = np.zeros((len(chosen), size, size))
        if chosen.size:
            corners = nodes[self.stencils[low.elements]]
            derivatives = self._gradients(nodes, low).reshape(len(low.elements), size)
            each = low.curvatures[:, None, None] * derivatives[:, :, None] * derivatives[:, None, :]
            each += low.derivatives[:, None, None] * self._bends(corners - corners[:, :1], low)
            np.add.at(blocks, owners, self._stiffness(low)[:, None, None] * each)
            if share:
                blocks += share * (nearest_semidefinite(blocks) - blocks)
        return chosen, blocks


def pushed_elements(rest: Nodes, elements: QuadraticElements, nodes: Nodes) -> Int[np.ndarray, " pushed"]:
    """Return the quadratic elements that a barrier pushes at `nodes` [m], by their numbers."""
    return np.flatnonzero((_coefficients(nodes[elements]) / _coefficients(rest[elements]) < BARRIER_START).any(axis=1))


class _Low(NamedTuple):
    """Coefficients below `BARRIER_START`: their element, place in it, value c, and ln(c / c0)."""

    elements: Int[np.ndarray, " low"]
    places: Int[np.ndarray, " low"]
    values: Vector
    logs: Vector

    @property
    def derivatives(self) -> Vector:
        """First derivative of phi."""
        return -3 * self.logs**2 / self.values

    @property
    def curvatures(self) -> Vector:
        """Second derivative of phi."""
        return (3 * self.logs**2 - 6 * self.logs) / self.values**2


_NO_LOW = _Low(*[np.zeros(0, dtype=np.int64)] * 2, *[np.zeros(0)] * 2)


def _coefficients(corners: Float[np.ndarray, "elements corners dim"]) -> Coefficients:
    """Bernstein coefficients of det(dx / d xi), xi in the unit simplex, and d! times the volume of each part."""
    count, _, dim = corners.shape
    spans, mixes = _spans(dim)
    columns = (spans @ corners.transpose(1, 2, 0).reshape(spans.shape[1], -1)).reshape(-1, dim, dim, count)
    columns = columns.transpose(2, 0, 1, 3)  # axis, corner or part, column, element
    at_corners, of_parts = columns[:, : dim + 1], columns[:, dim + 1 :]
    mixed = [at_corners[(slice(None), *_only(place, dim), place)] for place in range(dim)]
    parts = _determinants([of_parts[:, :, place] for place in range(dim)])
    return np.concatenate([mixes.T @ _determinants(mixed).reshape(-1, count), parts]).T


def _only(place: int, dim: int) -> tuple[slice | None, ...]:
    """An index that gives a corner an axis of its own, the one at `place` of `dim`."""
    return tuple(slice(None) if other == place else None for other in range(dim))


def _determinants(columns: Sequence[np.ndarray]) -> np.ndarray:
    """Determinants of matrices, by their columns, each (axes, ...)."""
    if len(columns) == 2:
        one, two = columns
        return one[0] * two[1] - one[1] * two[0]
    one, two, three = columns
    terms = [three[axis] * (one[axis - 2] * two[axis - 1] - one[axis - 1] * two[axis - 2]) for axis in range(3)]
    return terms[0] + terms[1] + terms[2]


@cache
def _spans(dim: int) -> tuple[Float[np.ndarray, "columns corners"], Float[np.ndarray, "mixed coefficients"]]:
    """Columns of dx / d xi at the corners and edges of the parts by the nodes, and each coefficient as a mean.

    It is that of determinants, which take their first column from one corner, their second from another, and so on.
    """
    derivatives = shape_gradients(np.eye(dim + 1)).swapaxes(1, 2).reshape(dim * (dim + 1), -1)
    one = np.eye(derivatives.shape[1])[PARTS[dim]]
    edges = (one[:, 1:] - one[:, :1]).reshape(-1, derivatives.shape[1])
    mixed = [tuple(sorted(chosen)) for chosen in product(range(dim + 1), repeat=dim)]
    found = sorted(set(mixed))
    mixes = np.array([[float(one == other) for other in found] for one in mixed])
    return np.concatenate([derivatives, edges]), mixes / mixes.sum(axis=0)


@cache
def _forms(dim: int) -> np.ndarray:
    """Each coefficient and part as an alternating form of the nodes, (coefficients, corners, ..., corners)."""
    spans, mixes = _spans(dim)
    columns = spans.reshape(-1, dim, spans.shape[1]).swapaxes(0, 1)
    axes, edges = columns[:, : dim + 1], columns[:, dim + 1 :]
    mixes = mixes.reshape(*[dim + 1] * dim, -1)
    if dim == 2:
        form, parts = np.einsum("ijm,ic,jd->mcd", mixes, *axes), np.einsum("mc,md->mcd", *edges)
    else:
        form = np.einsum("ijkm,ic,jd,ke->mcde", mixes, *axes, optimize=True)
        parts = np.einsum("mc,md,me->mcde", *edges)
    form, signs = np.concatenate([form, parts]), _permutation_signs(dim)
    orders = list(permutations(range(dim)))
    turned = [signs[order] * form.transpose(0, *(1 + place for place in order)) for order in orders]
    return np.sum(turned, axis=0) / len(orders)


@cache
def _permutation_signs(dim: int) -> np.ndarray:
    """Levi-Civita's symbol."""
    found = np.zeros([dim] * dim)
    for order in permutations(range(dim)):
        found[order] = np.linalg.det(np.eye(dim)[list(order)])
    return found


def _parts_in_space() -> np.ndarray:
    """Tetrahedra at the corners, then those around each of the three diagonals of the octahedron in between."""
    middle = {pair: 4 + place for place, pair in enumerate(combinations(range(4), 2))}
    parts = [
        [own, *(middle[min(own, other), max(own, other)] for other in range(4) if other != own)] for own in range(4)
    ]
    for first, last in ((4, 9), (5, 8), (6, 7)):
        sides = [node for node in range(4, 10) if node not in (first, last)]
        parts += [[first, last, one, two] for one, two in combinations(sides, 2) if one + two != 13]  # 13: opposite
    place = np.concatenate([np.eye(4), [(np.eye(4)[a] + np.eye(4)[b]) / 2 for a, b in middle]])[:, 1:]
    found = np.array(parts)
    flipped = np.linalg.det(place[found[:, 1:]] - place[found[:, :1]]) < 0
    found[flipped, -2:] = found[flipped, :-3:-1]
    return found


PARTS = {2: np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2], [3, 5, 4]]), 3: _parts_in_space()}
"""Linear parts of an element, by their nodes; in space, where its mesh has one diagonal, those of all three."""
