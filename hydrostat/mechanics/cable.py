"""`CableEnergy`: one cable, taut or slack; and the tension law it follows."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


@dataclass(frozen=True, kw_only=True)
class TensionLaw:
    """The unilateral spring, shifted so that a cable at rest has no tension (R25, E1, E2, E3).

    T(s) = 0 for s <= 0; k s^2 / (4 eps) for 0 <= s <= 2 eps; k (s - eps) above. Its integral is C2.

    Attributes:
        stiffness: k [N/m], the thesis's 2K.
        smoothing: eps [m].
    """

    stiffness: float
    smoothing: float

    def energy(self, stretch: float) -> float:
        """Integral of the tension [J]."""
        k, eps = self.stiffness, self.smoothing
        if stretch <= 0:
            return 0.0
        if stretch <= 2 * eps:
            return k * stretch**3 / (12 * eps)
        return 0.5 * k * (stretch - eps) ** 2 + k * eps**2 / 6

    def tension(self, stretch: float) -> float:
        """T [N] (R26)."""
        k, eps = self.stiffness, self.smoothing
        if stretch <= 0:
            return 0.0
        return k * stretch**2 / (4 * eps) if stretch <= 2 * eps else k * (stretch - eps)

    def tangent(self, stretch: float) -> float:
        """dT/ds [N/m]."""
        k, eps = self.stiffness, self.smoothing
        if stretch <= 0:
            return 0.0
        return k * stretch / (2 * eps) if stretch <= 2 * eps else k


class CableEnergy(Energy):
    """U(s) of one frictionless cable, s = l(x) - l(X) + a - slack [m] (R23 to R27, E1, E11, E12).

    Its points are y = W x + c: anchors in the body (rows of W sum to one, c = 0) or fixed in the world (W = 0).
    Sheathed segments keep their rest length, so they are left out of l; the length of a segment is rounded off where
    its two ends meet, so that it has a derivative there. U rises with s and l is convex in x, hence the energy is
    convex.
    """

    def __init__(
        self,
        nodes: Nodes,
        *,
        stencil: Int[np.ndarray, " corners"],
        weights: Float[np.ndarray, "points corners"],
        offsets: Points,
        bare: np.ndarray,
        law: TensionLaw,
        control: int,
        slack: float = 0.0,
    ) -> None:
        """Cable on the rest shape `nodes`.

        Args:
            nodes: rest positions [m].
            stencil: the nodes it depends on, each once.
            weights: W restricted to the stencil.
            offsets: c [m].
            bare: which segments are not sheathed, (points - 1,) booleans.
            law: tension against stretch.
            control: index of its winch's contraction.
            slack: taken in before the cable begins to be taut [m].
        """
        self.stencils = stencil[None, :]
        self.controls = np.array([control])
        self.control = control
        self.law, self.slack = law, slack
        index = np.flatnonzero(bare)
        self._differences = weights[index + 1] - weights[index]
        self._offsets = offsets[index + 1] - offsets[index]
        self._pairs = np.einsum("sa,sb->sab", self._differences, self._differences).reshape(len(index), -1)
        self._roundings = np.zeros(len(index))
        self._roundings = np.maximum(_ROUNDING * self._segments(nodes)[1], np.finfo(float).tiny ** 0.5)
        self.rest_length = self.length(nodes)

    def length(self, nodes: Nodes) -> float:
        """Length of the segments that are not sheathed [m]."""
        return float(self._segments(nodes)[1].sum())

    def stretch(self, nodes: Nodes, controls: Vector) -> float:
        """S [m]: how much longer the cable is than it should be; negative when slack."""
        return self.length(nodes) - self.rest_length + float(controls[self.control]) - self.slack

    def tension(self, nodes: Nodes, controls: Vector) -> float:
        """T [N]."""
        return self.law.tension(self.stretch(nodes, controls))

    def value(self, nodes: Nodes, controls: Vector) -> float:
        return self.law.energy(self.stretch(nodes, controls))

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self.tension(nodes, controls) * self.length_gradient(nodes)[None]

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        stretch = self.stretch(nodes, controls)
        tension, tangent = self.law.tension(stretch), self.law.tangent(stretch)
        gradient = self.length_gradient(nodes).ravel()
        return (tangent * np.outer(gradient, gradient) + tension * self._length_hessian(nodes))[None]

    def control_gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        return self.law.tangent(self.stretch(nodes, controls)) * self.length_gradient(nodes)[None]

    def _segments(self, nodes: Nodes) -> tuple[Points, Float[np.ndarray, " segments"]]:
        spans = self._differences @ nodes[self.stencils[0]] + self._offsets
        return spans, np.sqrt(np.einsum("sd,sd->s", spans, spans) + self._roundings**2)

    def length_gradient(self, nodes: Nodes) -> Float[np.ndarray, "corners dim"]:
        """Dl/dx at the stencil's nodes."""
        spans, lengths = self._segments(nodes)
        return self._differences.T @ (spans / lengths[:, None])

    def _length_hessian(self, nodes: Nodes) -> Float[np.ndarray, "size size"]:
        """Sum over segments of (I - u u^T) / length, spread to the nodes by the weights."""
        spans, lengths = self._segments(nodes)
        dim, corners = spans.shape[1], self._differences.shape[1]
        lengths = lengths[:, None, None]
        directions = spans / lengths[:, 0]
        across = (np.eye(dim) - directions[:, :, None] * directions[:, None, :]) / lengths
        blocks = self._pairs.T @ across.reshape(len(spans), -1)
        return blocks.reshape(corners, corners, dim, dim).swapaxes(1, 2).reshape(corners * dim, corners * dim)


_ROUNDING = 1e-3
"""A segment d has the length sqrt(d^2 + r^2), with r this fraction of its rest length: 5e-7 of it too long.

A plain norm has a kink at d = 0, where a winch that pulls hard brings two via points together: the least energy lies in
the kink, no gradient vanishes there, and Newton stops without a descent.
"""
