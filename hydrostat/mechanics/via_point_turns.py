"""`ViaPointTurns`: turning angles of cables at their via points."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Nodes


@dataclass(frozen=True, kw_only=True, eq=False)
class ViaPointTurns:
    """Corners of cables in the body, by the directions of the two segments that meet there.

    Attributes:
        stencils: nodes of the segments before, then of those after, (2, corners of cables, nodes of a segment).
        weights: signed weights of those nodes.
        offsets: contribution of points fixed in the world to the segments [m].
        points: index of the friction point that a corner belongs to; a sheath is one point with two corners, its ends.
    """

    stencils: Int[np.ndarray, "2 turns corners"]
    weights: Float[np.ndarray, "2 turns corners"]
    offsets: Float[np.ndarray, "2 turns dim"]
    points: Int[np.ndarray, " turns"]

    def angles(self, nodes: Nodes) -> Float[np.ndarray, " turns"]:
        """Turning angle of the cable at each corner [rad], 0 to pi."""
        before, after = self._directions(nodes)[0]
        return 2 * np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))

    def gradients(self, nodes: Nodes, count: int) -> Float[np.ndarray, "dofs points"]:
        """Derivative of the sum of the angles at each of `count` points of friction [rad/m].

        A straight run has none: its angle has a kink there.
        """
        slopes = self.slopes(nodes)
        columns = np.zeros((*nodes.shape, count))
        spread = self.weights[..., None] * slopes[:, :, None, :]
        axes = np.arange(nodes.shape[1])
        np.add.at(columns, (self.stencils[..., None], axes, self.points[:, None, None]), spread)
        return columns.reshape(nodes.size, count)

    def slopes(self, nodes: Nodes) -> Float[np.ndarray, "2 turns dim"]:
        """Derivative of each angle by the vectors along the segments before and after it [rad/m]; as above."""
        (before, after), lengths = self._directions(nodes)
        cosine = np.einsum("td,td->t", before, after)[:, None]
        sine = np.maximum(np.sin(self.angles(nodes)), _STRAIGHT)[:, None]
        return np.stack([(cosine * before - after) / sine, (cosine * after - before) / sine]) / lengths[..., None]

    def _directions(self, nodes: Nodes) -> tuple[Float[np.ndarray, "2 turns dim"], Float[np.ndarray, "2 turns"]]:
        spans = np.einsum("stc,stcd->std", self.weights, nodes[self.stencils]) + self.offsets
        lengths = np.maximum(np.linalg.norm(spans, axis=2), np.finfo(float).tiny ** 0.5)
        return spans / lengths[..., None], lengths


_STRAIGHT = 1e-9
"""A turn of less [rad] counts as none."""
