"""Physics that the house does not know: a magnet, a floor, magnets that come into reach, a spring that yields."""

from copy import copy
from typing import ClassVar

import numpy as np

from hydrostat.mechanics import Energy


class Magnet(Energy):
    """-c / d^2 between two nodes, times 1 + a of a winch: it is not convex, and it pulls the harder the nearer."""

    convex: ClassVar[bool] = False

    def __init__(self, first: int, second: int, *, strength: float, control: int) -> None:
        self.stencils, self.controls = np.array([[first, second]]), np.array([control])
        self.strength = strength

    def _span(self, nodes):
        return nodes[self.stencils[:, 1]] - nodes[self.stencils[:, 0]]

    def _scale(self, controls):
        return self.strength * (1.0 + controls[self.controls[0]])

    def value(self, nodes, controls):
        return -self._scale(controls) * float((1.0 / (self._span(nodes) ** 2).sum(axis=1)).sum())

    def gradient(self, nodes, controls):
        return self._scale(controls) * self._unit(nodes)

    def _unit(self, nodes):
        span = self._span(nodes)
        pull = 2.0 * span / (span**2).sum(axis=1, keepdims=True) ** 2
        return np.stack([-pull, pull], axis=1)

    def hessian(self, nodes, controls):
        span = self._span(nodes)
        square = (span**2).sum(axis=1)[:, None, None]
        dim = span.shape[1]
        block = 2.0 * np.eye(dim) / square**2 - 8.0 * span[:, :, None] * span[:, None, :] / square**3
        signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
        blocks = signs[None, :, None, :, None] * block[:, None, :, None, :]
        return self._scale(controls) * blocks.reshape(len(span), 2 * dim, 2 * dim)

    def control_gradient(self, nodes, controls):
        return self.strength * self._unit(nodes)

    def largest_force(self, nodes, controls):
        return float(np.abs(self.gradient(nodes, controls)).max())


class Floor(Energy):
    """A barrier under the body: c (h - reach)^2 ln(h / reach)^2 for nodes nearer than `reach`; it counts only these.

    A step goes nine tenths of the way to the first touch.
    """

    convex: ClassVar[bool] = False

    def __init__(self, level: float, *, reach: float, stiffness: float, every: bool = False, count: int = 0) -> None:
        self.level, self.reach, self.stiffness, self.every = level, reach, stiffness, every
        self.stencils = np.arange(count if every else 0)[:, None]
        self.asked = 0

    def with_active_terms(self, nodes):
        found = np.flatnonzero(nodes[:, 1] - self.level < self.reach)[:, None]
        if self.every or np.array_equal(found, self.stencils):
            return self
        other = copy(self)
        other.stencils = found
        return other

    def largest_step(self, nodes, move):
        falls = np.maximum(-move[:, 1], 1e-300)
        self.asked += 1
        return float(min(1.0, 0.9 * ((nodes[:, 1] - self.level) / falls).min()))

    def _parts(self, nodes):
        height = (nodes[self.stencils[:, 0], 1] - self.level) / self.reach
        inside = height < 1.0
        height = np.where(inside, height, 1.0)
        gap, log = height - 1.0, np.log(np.maximum(height, 1e-300))
        value = gap**2 * log**2
        slope = 2 * gap * log**2 + 2 * gap**2 * log / height
        bend = 2 * log**2 + 8 * gap * log / height + 2 * gap**2 * (1 - log) / height**2
        return height, value, slope / self.reach, bend / self.reach**2

    def value(self, nodes, controls):
        height, value, *_ = self._parts(nodes)
        return float(self.stiffness * value.sum()) if (height > 0).all() else np.inf

    def gradient(self, nodes, controls):
        blocks = np.zeros((len(self.stencils), 1, nodes.shape[1]))
        blocks[:, 0, 1] = self.stiffness * self._parts(nodes)[2]
        return blocks

    def hessian(self, nodes, controls):
        dim = nodes.shape[1]
        blocks = np.zeros((len(self.stencils), dim, dim))
        blocks[:, 1, 1] = self.stiffness * self._parts(nodes)[3]
        return blocks


class YieldingTie(Energy):
    """A spring from a node to where it was at rest, k/2 |x - X - p|^2, that yields: |k (x - X - p)| <= limit.

    While a step is sought the slip p is held; then it follows, as friction does.
    """

    has_constant_hessian: ClassVar[bool] = True
    has_history: ClassVar[bool] = True

    def __init__(self, rest: np.ndarray, node: int, *, stiffness: float, limit: float) -> None:
        self.stencils, self.rest = np.array([[node]]), rest[node]
        self.stiffness, self.limit, self.slip = stiffness, limit, np.zeros(rest.shape[1])

    def _off(self, nodes):
        return nodes[self.stencils[0, 0]] - self.rest - self.slip

    def value(self, nodes, controls):
        return 0.5 * self.stiffness * float(self._off(nodes) @ self._off(nodes))

    def gradient(self, nodes, controls):
        return self.stiffness * self._off(nodes)[None, None]

    def hessian(self, nodes, controls):
        return self.stiffness * np.eye(len(self.rest))[None]

    @property
    def history(self):
        return self.slip

    def _with(self, slip):
        other = copy(self)
        other.slip = slip
        return other

    def with_history(self, history, nodes, controls):
        return self._with(history)

    def history_residual(self, nodes, controls):
        return max(self.stiffness * float(np.linalg.norm(self._off(nodes))) - self.limit, 0.0)

    def with_corrected_history(self, nodes, controls, compliance, response=None):
        off = self._off(nodes)
        size = float(np.linalg.norm(off))
        return self._with(self.slip + off * max(1.0 - self.limit / (self.stiffness * size), 0.0) if size else self.slip)


class SluggishTie(YieldingTie):
    """The same, but its slip stays for a number of corrections before it follows, as contact friction may do."""

    idle = 10

    def with_corrected_history(self, nodes, controls, compliance, response=None):
        if not self.idle:
            return super().with_corrected_history(nodes, controls, compliance, response)
        other = copy(self)
        other.idle -= 1
        return other
