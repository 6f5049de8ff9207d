"""`PressureEnergy`: a pressure in a closed cavity, which follows its walls."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Int, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class PressureEnergy(Energy):
    """-p V with the volume V of a cavity: the walls are pushed along their normals wherever they go.

    V is a sum of determinants of the corners of each facet, so gradient and Hessian are exact. The sum over a closed
    surface does not depend on the origin; the middle of the cavity at rest keeps the terms small.
    """

    convex: ClassVar[bool] = False

    def __init__(self, rest: Nodes, facets: Int[np.ndarray, "terms dim"], pressure: float, thickness: float) -> None:
        """Take a closed surface and its pressure.

        Args:
            rest: nodes at rest [m].
            facets: facets of the surface, oriented with the body inside (left in the plane).
            pressure: pressure in the cavity [Pa], below 0 for a vacuum.
            thickness: thickness of a flat body [m]; 1 in space.
        """
        self.stencils = facets
        self.pressure, self._rest, self._thickness = pressure, rest, thickness
        self._dim = facets.shape[1]
        self._middle = rest[facets].mean(axis=(0, 1))
        self._factor = pressure * thickness / (2.0 if self._dim == 2 else 6.0)  # facets face away from the cavity

    def _corners(self, nodes: Nodes) -> Blocks:
        return nodes[self.stencils] - self._middle

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return self._factor * float(np.linalg.det(self._corners(nodes)).sum())

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        corners = self._corners(nodes)
        if self._dim == 2:
            one, two = corners[:, 0], corners[:, 1]
            return self._factor * np.stack(
                [np.stack([two[:, 1], -two[:, 0]], 1), np.stack([-one[:, 1], one[:, 0]], 1)], 1
            )
        one, two, three = corners[:, 0], corners[:, 1], corners[:, 2]
        return self._factor * np.stack([np.cross(two, three), np.cross(three, one), np.cross(one, two)], axis=1)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        count = len(self.stencils)
        blocks = np.zeros((count, self._dim, self._dim, self._dim, self._dim))
        if self._dim == 2:
            turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
            blocks[:, 0, :, 1], blocks[:, 1, :, 0] = turn, turn.T
        else:
            spins = _spins(self._corners(nodes))
            for one, two, third in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
                blocks[:, one, :, two] = -spins[:, third]
                blocks[:, two, :, one] = spins[:, third]
        return self._factor * blocks.reshape(count, self._dim**2, self._dim**2)

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        sides = self._rest[self.stencils]
        spans = sides[:, 1:] - sides[:, :1]
        sizes = np.sqrt(np.linalg.det(spans @ np.swapaxes(spans, 1, 2)).max())
        return abs(self.pressure) * self._thickness * float(sizes) / (1.0 if self._dim == 2 else 2.0)

    def with_load(self, share: float) -> "PressureEnergy":
        return PressureEnergy(self._rest, self.stencils, share * self.pressure, self._thickness)

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        work = np.array([float((self.gradient(nodes, np.zeros(0)) * field[self.stencils]).sum())])
        return {"load": work, "thickness": work} if self._dim == 2 else {"load": work}


def _spins(vectors: Blocks) -> np.ndarray:
    """Matrix [v] of v x w = [v] w for each vector, (terms, corners, 3, 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)
