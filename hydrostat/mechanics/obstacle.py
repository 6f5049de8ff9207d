"""`ObstacleEnergy`: a body does not pass through a rigid obstacle."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.geometry.boundary_tree import facet_areas
from hydrostat.geometry.distance_field import DistanceField, Distances
from hydrostat.geometry.mesh import Mesh
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Places, Stencils, add_blocks


class ObstacleEnergy(Energy):
    """Barrier between samples of a body's boundary and a rigid obstacle.

    A term is a sample: a node of the boundary, the middle of an edge, in space of a facet too. Its energy at distance d
    is W h phi(d^2/h), phi(r) = -(r - 1)^2 ln r below r = 1, with h the square of the distance at which it is felt.
    """

    convex: ClassVar[bool] = False
    lifts_early: ClassVar[bool] = True

    def __init__(
        self, mesh: Mesh, field: DistanceField, *, distance: float, young: float, thickness: float | None = None
    ) -> None:
        """Barrier of a body at rest.

        Args:
            mesh: of the body.
            field: distance of points from the obstacle.
            distance: at which it begins to be felt [m].
            young: pressure at half that distance: Young's modulus [Pa].
            thickness: of a flat body [m].
        """
        self.field, self.distance = field, distance
        self.stencils, self.shares, areas = _samples(mesh)
        self.weights = young * areas * (thickness or 1.0) / (_HALF_WAY * distance)

    def places(self, nodes: Nodes) -> Points:
        """Where the samples are [m]."""
        return np.einsum("tc,tcd->td", self.shares, nodes[self.stencils])

    def gap(self, nodes: Nodes) -> float:
        """Distance of the nearest sample [m]; negative inside the obstacle."""
        return float(self.field(self.places(nodes)).values.min())

    def value(self, nodes: Nodes, controls: Vector) -> float:
        distances = self.field(self.places(nodes)).values
        if not (distances > 0).all():
            return np.inf
        r = np.minimum((distances / self.distance) ** 2, 1.0)
        return float(self.distance**2 * (self.weights * (r - 1.0) ** 2) @ -np.log(r))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        found = self.field(self.places(nodes))
        forces = self._derivatives(found)[0][:, None] * found.normals
        return self.shares[:, :, None] * forces[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self.projected_hessian(nodes, controls, 0.0)

    def projected_hessian(self, nodes: Nodes, controls: Vector, share: float) -> HessianBlocks:
        return self._blocks(self.shares, self.field(self.places(nodes)), self.weights, share)

    def add_hessian(self, nodes: Nodes, controls: Vector, share: float, places: Places) -> None:
        values = self.field(self.places(nodes))
        felt = values.values < self.distance
        if felt.any():
            near = Distances(*(part[felt] for part in values))
            blocks = self._blocks(self.shares[felt], near, self.weights[felt], share)
            add_blocks(self.stencils[felt], places.slots[felt], places.strides, blocks, places.data)

    def largest_step(self, nodes: Nodes, move: Nodes) -> float:
        """By conservative advancement: a sample cannot meet the obstacle before distance / speed."""
        at = self.places(nodes)
        way = np.einsum("tc,tcd->td", self.shares, move[self.stencils])
        speeds = np.linalg.norm(way, axis=1)
        distances = self.field(at).values
        least, done = _KEPT * distances, np.zeros(len(at))
        going = np.flatnonzero(distances - least < speeds)
        for _ in range(_ADVANCES):
            if not len(going):
                break
            step = (distances[going] - least[going]) / speeds[going]
            done[going] += step
            distances[going] = self.field(at[going] + done[going, None] * way[going]).values
            going = going[(done[going] < 1.0) & (distances[going] > 1.1 * least[going])]
        met = distances <= 1.1 * least
        return float(np.clip(done[met & (done > 0)].min(initial=1.0), _LEAST_STEP, 1.0))

    def _derivatives(self, found: Distances, weights: Vector | None = None) -> tuple[Vector, Vector]:
        """First two derivatives of each term by its distance."""
        d = found.values
        r = (d / self.distance) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            log, below = -np.log(r), r - 1.0
            slope = 2.0 * below * log - below**2 / r
            curve = 2.0 * log - 4.0 * below / r + (below / r) ** 2
        scale = (self.weights if weights is None else weights) * (r < 1.0)
        one = np.where(r < 1.0, 2.0 * scale * slope * d, 0.0)
        two = np.where(r < 1.0, scale * (2.0 * slope + 4.0 * r * curve), 0.0)
        return one, two

    def _blocks(
        self, shares: Float[np.ndarray, "terms corners"], found: Distances, weights: Vector, share: float
    ) -> HessianBlocks:
        slope, curve = self._derivatives(found, weights)
        inner = curve[:, None, None] * (found.normals[:, :, None] * found.normals[:, None, :])
        inner = inner + ((1.0 - share) * slope)[:, None, None] * found.curvatures
        blocks = np.einsum("ta,tb,tij->taibj", shares, shares, inner)
        size = shares.shape[1] * found.normals.shape[1]
        return blocks.reshape(len(shares), size, size)


def _samples(mesh: Mesh) -> tuple[Stencils, Float[np.ndarray, "terms corners"], Vector]:
    """Samples of the boundary: corners of a facet that has each, their shares, the area that it stands for [m^dim-1].

    Areas are the weights of Simpson's rule in the plane, and of the rule of seven points of degree 3 in space.
    """
    dim, areas = mesh.dim, facet_areas(mesh)[0]
    rules = [(np.eye(dim), 1 / 6 if dim == 2 else 1 / 20)]
    if dim == 3:
        rules.append((0.5 * (1 - np.eye(3)), 2 / 15))
    rules.append((np.full((1, dim), 1 / dim), 2 / 3 if dim == 2 else 9 / 20))
    points, shares = np.concatenate([rule for rule, _ in rules]), np.concatenate([[w] * len(r) for r, w in rules])
    facets = np.sort(mesh.boundary, axis=1)
    stencils = np.repeat(facets, len(points), axis=0)
    weights = np.tile(points, (len(facets), 1))
    used = np.where(weights > 0, stencils, -1)  # what two facets share is one sample
    _, firsts, whose = np.unique(np.sort(used, axis=1), axis=0, return_index=True, return_inverse=True)
    area = np.bincount(whose.ravel(), np.outer(areas, shares).ravel())
    return np.ascontiguousarray(stencils[firsts]), np.ascontiguousarray(weights[firsts]), area


_HALF_WAY = 4.329
"""Force of the barrier at half its distance, where its factor and distance are 1: 2 phi'(1/4) x 1/2, phi' its slope."""

_KEPT = 0.1
"""No step takes more than 1 less this share of the gap."""

_ADVANCES = 200
"""Steps of a conservative advancement."""

_LEAST_STEP = 1e-12
"""Steps are above 0."""
