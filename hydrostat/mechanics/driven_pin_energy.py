"""`DrivenPinEnergy`: work of drives that move pins from their places at rest."""

from copy import copy

import numpy as np

from hydrostat.arrays import Bool, Int, Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks
from hydrostat.mechanics.nodal_energies import PinEnergy


class DrivenPinEnergy(Energy):
    """Energy that moves targets p of a `PinEnergy` to t(a), a being the control of each term.

    The energy k/2 |y - t|^2 - k/2 |y - p|^2 of a pin is linear in the anchor y, so the Hessian of the body, of its
    pins and its factors at rest serve for all values of a drive. A turn by an angle a moves p by
    sin(a) D + (1 - cos a) E with D = n x (p - c), E = n x D; a slide by a D.
    """

    has_constant_hessian = True

    def __init__(
        self,
        pins: PinEnergy,
        *,
        terms: Int[np.ndarray, " terms"],
        controls: Int[np.ndarray, " terms"],
        directions: tuple[Points, Points],
        turns: Bool[np.ndarray, " terms"],
    ) -> None:
        """Drives of some terms of pins: their controls, directions D and E, and whether they turn."""
        self.stencils, self.controls = pins.stencils[terms], controls
        self._pins, self._weights = pins, pins.weights[terms]
        self._places, self._stiffness = pins.targets[terms], pins.stiffness[terms]
        self._first, self._second = directions
        self._turns = turns
        self._owners = self.supports = pins.support_of[terms]
        size = self.stencils.shape[1] * self._places.shape[1]
        self._blocks = np.zeros((len(terms), size, size))

    def _shifts(self, controls: Vector) -> Points:
        values = controls[self.controls]
        along = np.where(self._turns, np.sin(values), values)
        across = np.where(self._turns, 1 - np.cos(values), 0.0)
        return along[:, None] * self._first + across[:, None] * self._second

    def _anchors(self, nodes: Nodes) -> Points:
        return np.matmul(self._weights[:, None, :], nodes.take(self.stencils, axis=0))[:, 0]

    def value(self, nodes: Nodes, controls: Vector) -> float:
        shifts = self._shifts(controls)
        offsets = self._anchors(nodes) - self._places - 0.5 * shifts
        return -float(self._stiffness @ (shifts * offsets).sum(axis=1))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return -(self._stiffness[:, None] * self._weights)[:, :, None] * self._shifts(controls)[:, None, :]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return self._blocks

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        values = controls[self.controls]
        along = np.where(self._turns, np.cos(values), 1.0)
        across = np.where(self._turns, np.sin(values), 0.0)
        speeds = along[:, None] * self._first + across[:, None] * self._second
        return -(self._stiffness[:, None] * self._weights)[:, :, None] * speeds[:, None, :]

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        pulls = self._stiffness[:, None] * (self._anchors(nodes) - self._places - self._shifts(controls))
        return float(np.abs(pulls).max(initial=0.0)) if controls[self.controls].any() else 0.0

    def with_supports_moved(self, shifts: Points) -> "DrivenPinEnergy":
        other = copy(self)
        other._places = self._places + shifts[self._owners]
        return other

    def support_work(self, field: Nodes, controls: Vector) -> Vector:
        """d(dE/dx . field) / dk of each support of the pins, to be added to the `parameter_derivative` of these."""
        works = (self.gradient(field, controls) * field[self.stencils]).sum(axis=(1, 2))
        wholes = np.bincount(self._pins.support_of, self._pins.stiffness)
        return np.bincount(self._owners, works, len(wholes)) / wholes
