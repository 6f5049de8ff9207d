"""`FibreEnergy`: muscle fibres, each pulling its two ends together with a commanded tension."""

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks, Stencils


class FibreEnergy(Energy):
    """Sum of t_f l_f(x), t_f >= 0 the tension [N] of fibre f (R36, R38).

    The span of a fibre is d = sum of weights x nodes, with weights that sum to zero: (-1, 1) on a mesh edge, the
    difference of two anchors inside an element. A tension as control, rather than the contraction of a small
    spring, needs no fibre stiffness (M8) and has a derivative even where a fibre is idle (E15).
    """

    def __init__(self, *, stencils: Stencils, weights: Float[np.ndarray, "terms corners"]) -> None:
        """Fibre f depends on `stencils[f]` and is control f."""
        self.stencils = stencils
        self.controls = np.arange(len(stencils))
        self.weights = weights

    def spans(self, nodes: Nodes) -> Points:
        """Vector from end to end of each fibre [m]."""
        return np.einsum("tc,tcd->td", self.weights, nodes[self.stencils])

    def lengths(self, nodes: Nodes) -> Float[np.ndarray, " terms"]:
        """Length of each fibre [m]."""
        return np.linalg.norm(self.spans(nodes), axis=1)

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return float(controls @ self.lengths(nodes))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return controls[:, None, None] * self.control_gradient(nodes, controls)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        spans = self.spans(nodes)
        terms, dim = spans.shape
        size = self.weights.shape[1] * dim
        lengths = np.linalg.norm(spans, axis=1)[:, None]
        directions = spans / lengths
        across = np.eye(dim) - directions[:, :, None] * directions[:, None, :]
        across *= (controls / lengths[:, 0])[:, None, None]
        return np.einsum("ta,tb,tij->taibj", self.weights, self.weights, across, optimize=True).reshape(
            terms, size, size
        )

    def largest_force(self, nodes: Nodes, controls: Vector) -> float:
        return float(controls.max(initial=0.0))

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        spans = self.spans(nodes)
        directions = spans / np.linalg.norm(spans, axis=1)[:, None]
        return self.weights[:, :, None] * directions[:, None, :]
