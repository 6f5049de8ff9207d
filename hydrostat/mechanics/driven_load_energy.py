"""`DrivenLoadEnergy`: a load times a control of the robot."""

from collections.abc import Mapping
from copy import copy
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class DrivenLoadEnergy(Energy):
    """a E(x) with the energy E of a whole load, which reads no control, and the share a of it that acts."""

    convex: ClassVar[bool] = False

    def __init__(self, whole: Energy, control: int) -> None:
        """Whole load, and the index of the control that scales it."""
        self.whole, self._index = whole, control
        self.stencils = whole.stencils
        self.controls = np.full(len(whole.stencils), control)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return controls[self._index] * self.whole.value(nodes, controls)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return controls[self._index] * self.whole.gradient(nodes, controls)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        return controls[self._index] * self.whole.hessian(nodes, controls)

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self.whole.gradient(nodes, controls)

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return abs(controls[self._index]) * self.whole.largest_force(nodes, controls)

    def with_active_terms(self, nodes: Nodes) -> "DrivenLoadEnergy":
        whole = self.whole.with_active_terms(nodes)
        if whole is self.whole:
            return self
        other = copy(self)
        other.whole = whole
        return other

    def parameter_derivative_at(self, nodes: Nodes, field: Nodes, controls: Vector) -> Mapping[str, Vector]:
        """`parameter_derivative` of the share that acts."""
        works = self.whole.parameter_derivative(nodes, field)
        return {name: controls[self._index] * work for name, work in works.items()}
