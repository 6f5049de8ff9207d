"""`Ease`: the body glides from one shape to the next."""

import numpy as np

from hydrostat.arrays import Nodes, Vector

DURATION = 0.45  # time from one shape to the next [s]


class Ease:
    """A shape, nodes [m] and tensions [N], on its way to another; what lies between is shown, not solved."""

    def __init__(self, nodes: Nodes, tensions: Vector) -> None:
        self.nodes, self.tensions = nodes, tensions
        self._start, self._goal, self._pulled = nodes, nodes, tensions
        self._began: float | None = None
        self.moving = False  # whether it is on its way

    def go(self, nodes: Nodes, tensions: Vector) -> None:
        """Set out for another shape of the same body; nothing happens if it goes there already."""
        if nodes is self._goal and np.array_equal(tensions, self._pulled):
            return
        far = nodes is not self._goal
        self._start, self._goal, self._pulled = self.nodes, nodes, tensions
        self._began, self.moving = None, far
        self.tensions = np.zeros_like(tensions) if far else tensions

    def step(self, now: float) -> bool:
        """Go on until a time [s]; whether there is more to do."""
        if not self.moving:
            return False
        if self._began is None:
            self._began = now
        share = min((now - self._began) / DURATION, 1.0)
        gentle = share * share * (3.0 - 2.0 * share)
        self.nodes = self._goal if share == 1.0 else (1.0 - gentle) * self._start + gentle * self._goal
        self.tensions = gentle * self._pulled
        self.moving = share < 1.0
        return self.moving
