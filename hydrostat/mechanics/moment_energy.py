"""`MomentEnergy`: a moment on a few elements of a body, which turns with nothing."""

from collections.abc import Mapping
from copy import copy
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class MomentEnergy(Energy):
    """-M phi with the angle phi by which some elements turn about the axis of the moment.

    phi is the polar angle of the mean deformation gradient F in the plane across the axis: tan phi = (F21 - F12) /
    (F11 + F22). A turn about the axis adds to phi what it turns by, so the moment about it is M in every pose. In space
    the moment has also components across the axis once the elements are tilted, as that of every energy has.

    Angles count on beyond half a turn, as `with_active_terms` follows them.
    """

    convex: ClassVar[bool] = False

    def __init__(
        self,
        rest: Nodes,
        elements: Int[np.ndarray, "terms corners"],
        moment: Float[np.ndarray, " axes"],
        *,
        index: int = 0,
    ) -> None:
        """Moment on simplices of the rest shape.

        Args:
            rest: nodes at rest [m].
            elements: corners of the elements that it turns.
            moment: moment [N m]: one number in the plane, counted from x to y, and one about each axis in space.
            index: index of the load, for `parameter_derivative`.
        """
        used, corners = np.unique(elements, return_inverse=True)
        self.stencils = used[None]
        self.size = float(np.linalg.norm(moment))
        self.index, self.middle = index, 0.0
        stretch, spin = _planes(np.asarray(moment, dtype=float) / self.size, rest.shape[1])
        spans = np.swapaxes(rest[elements[:, 1:]] - rest[elements[:, :1]], 1, 2)
        inverse = np.linalg.inv(spans)
        derivatives = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        volumes = np.linalg.det(spans)
        mean = np.zeros((len(used), rest.shape[1]))
        np.add.at(mean, corners.reshape(elements.shape), derivatives * (volumes / volumes.sum())[:, None, None])
        self._straight, self._turned = mean @ stretch.T, mean @ spin.T
        self._rest = rest[used]

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return -self.size * (self.middle + self._away(nodes))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        straight, turned, square = self._sides(nodes)
        return -self.size / square * (straight * self._turned - turned * self._straight)[None]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        straight, turned, square = self._sides(nodes)
        one, two = self._straight.ravel(), self._turned.ravel()
        mixed = np.outer(one, two)
        both = 2 * straight * turned * (np.outer(one, one) - np.outer(two, two))
        return -self.size / square**2 * (both + (turned**2 - straight**2) * (mixed + mixed.T))[None]

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return self.size * float(np.abs(self._turned).max()) / 2

    def with_active_terms(self, nodes: Nodes) -> "MomentEnergy":
        """Energy whose angles count from that at `nodes`, if it is far from where they count from now."""
        away = self._away(nodes)
        far = 0.5  # [rad]
        if abs(away) < far:
            return self
        other = copy(self)
        other.middle = self.middle + away
        return other

    def with_load(self, share: float) -> "MomentEnergy":
        other = copy(self)
        other.size = share * self.size
        return other

    def parameter_derivative(self, nodes: Nodes, field: Nodes) -> Mapping[str, Vector]:
        straight, turned, square = self._sides(nodes)
        by_angle = (straight * self._turned - turned * self._straight) / square
        work = -float(np.vdot(by_angle, field[self.stencils[0]]))
        return {"load": np.array([self.size * work]), "moment": np.bincount([self.index], [work])}

    def _sides(self, nodes: Nodes) -> tuple[float, float, float]:
        """F11 + F22, F21 - F12 and the sum of their squares."""
        moved = nodes[self.stencils[0]] - self._rest
        straight, turned = 2.0 + float(np.vdot(self._straight, moved)), float(np.vdot(self._turned, moved))
        return straight, turned, max(straight**2 + turned**2, np.finfo(float).tiny)

    def _away(self, nodes: Nodes) -> float:
        """Angle from the one at which angles begin to count, within half a turn."""
        straight, turned, _ = self._sides(nodes)
        return float(np.remainder(np.arctan2(turned, straight) - self.middle + np.pi, 2 * np.pi) - np.pi)


def _planes(axis: np.ndarray, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Projection on the plane across an axis, and a quarter turn in it."""
    if dim == 2:
        sign = float(np.sign(axis[0]))
        return np.eye(2), sign * np.array([[0.0, -1.0], [1.0, 0.0]])
    x, y, z = axis
    return np.eye(3) - np.outer(axis, axis), np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
