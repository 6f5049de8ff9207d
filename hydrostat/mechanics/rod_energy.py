"""`RodEnergy`: an elastic rod through points of a body, with stretch and bending."""

from itertools import pairwise
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks


class RodEnergy(Energy):
    """Discrete elastic rod, straight or curved at rest, without twist (Bergou et al. 2008).

    E = sum over segments of EA/2 (l/L - 1)^2 L + sum over joints of EI / (2 D) |k - k0|^2, where l is the length of a
    segment and L that at rest, D the mean L of the segments at a joint, and |k|^2 = 4 (1 - c) / (1 + c) the square of
    its curvature times D, with c the cosine between the two segments. A joint that is bent at rest counts by the
    difference of the magnitudes alone, so that its mirrored bend costs nothing. Twist is `RodTwistEnergy`.
    """

    convex: ClassVar[bool] = False

    def __init__(self, nodes: Nodes, anchors: Anchors, *, axial_stiffness: float, bending_stiffness: float) -> None:
        """Rod through at least two anchors, with EA [N] and EI [N m^2]; `nodes` are the rest shape [m]."""
        count, corners = anchors.stencils.shape
        joints = np.arange(count - 2)[:, None] + np.arange(3)
        if count == 2:  # one segment, no joint: its first point stands for the third one
            joints = np.array([[0, 1, 0]])
        self.stencils = anchors.stencils[joints].reshape(len(joints), 3 * corners)
        weights = np.zeros((len(joints), 2, 3, corners))  # of the two segments at each joint
        for side in (0, 1):
            weights[:, side, side + 1] = anchors.weights[joints[:, side + 1]]
            weights[:, side, side] = -anchors.weights[joints[:, side]]
        self._weights = weights.reshape(len(joints), 2, 3 * corners)
        eye = np.eye(nodes.shape[1])
        by_corners = self._weights[:, :, None, :, None] * eye[:, None]  # of both spans by all corners
        self._by_corners = by_corners.reshape(len(joints), 2 * len(eye), 3 * corners * len(eye))
        spans = self._spans(nodes)
        self._lengths = np.linalg.norm(spans, axis=2)
        # Each segment stands at two joints, the first and the last one at one.
        shares = np.full(self._lengths.shape, 0.5)
        shares[0, 0] = 1.0
        shares[-1, 1] = 0.0 if count == 2 else 1.0
        self._axial = shares * axial_stiffness
        self._whole = axial_stiffness, bending_stiffness
        self._bending = np.full(len(joints), 0.0 if count == 2 else bending_stiffness) / self._lengths.mean(axis=1)
        self._bent = np.sqrt(_curvature(_cosine(spans))[0])
        self.stiffest = axial_stiffness / float(self._lengths.min())

    def _spans(self, nodes: Nodes) -> Float[np.ndarray, "joints 2 dim"]:
        """Both segments at each joint [m]."""
        return np.einsum("jsc,jcd->jsd", self._weights, nodes[self.stencils])

    def value(self, nodes: Nodes, controls: Vector) -> float:
        spans = self._spans(nodes)
        strains = np.linalg.norm(spans, axis=2) / self._lengths - 1.0
        cosine = _cosine(spans)
        if (cosine[self._bending > 0] <= -1.0 + 1e-9).any():
            return np.inf
        stretch = 0.5 * float((self._axial * self._lengths * strains**2).sum())
        return stretch + float(self._bend(cosine)[0].sum())

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        derivatives, _ = self._derivatives(nodes, second=False)
        return np.einsum("jsc,jsd->jcd", self._weights, derivatives)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        blocks = self._derivatives(nodes, second=True)[1]
        assert blocks is not None
        joints, spans, _ = self._by_corners.shape
        return np.swapaxes(self._by_corners, 1, 2) @ (blocks.reshape(joints, spans, spans) @ self._by_corners)

    def stiffness_work(self, nodes: Nodes, field: Nodes) -> tuple[float, float]:
        """d(dE/dx . field) / dEA and / dEI."""
        spans, moves = self._spans(nodes), self._spans(field)
        lengths = np.linalg.norm(spans, axis=2)
        units = spans / lengths[:, :, None]
        along = (moves * units).sum(axis=2)
        cosine = _cosine(spans)
        across = units[:, ::-1] - cosine[:, None, None] * units
        turns = ((moves * across).sum(axis=2) / lengths).sum(axis=1)  # change of the cosine
        stretch = (self._axial * (lengths / self._lengths - 1.0) * along).sum()
        axial, bending = self._whole
        return float(stretch) / axial, float(self._bend(cosine)[1] @ turns) / bending

    def _bend(self, cosine: Vector) -> tuple[Vector, Vector, Vector]:
        """Energy of each joint [J], and its first and second derivative by the cosine."""
        square, first, second = _curvature(cosine)
        straight = self._bent < 1e-6
        magnitude = np.sqrt(np.maximum(square, 1e-24))
        # f(q) = (sqrt q - k0)^2, whose derivative by q is 1 - k0 / sqrt q
        ratio = np.where(straight, 0.0, self._bent / magnitude)
        energy = np.where(straight, square, (magnitude - self._bent) ** 2)
        by_square, twice = 1.0 - ratio, 0.5 * ratio / np.maximum(square, 1e-24)
        half = 0.5 * self._bending
        return half * energy, half * by_square * first, half * (by_square * second + twice * first**2)

    def _derivatives(
        self, nodes: Nodes, *, second: bool
    ) -> tuple[Float[np.ndarray, "joints 2 dim"], Float[np.ndarray, "joints 2 dim 2 dim"] | None]:
        """Derivatives by the two segments of each joint."""
        spans = self._spans(nodes)
        lengths = np.linalg.norm(spans, axis=2)
        units, dim = spans / lengths[:, :, None], spans.shape[2]
        cosine = np.einsum("jd,jd->j", units[:, 0], units[:, 1])
        _, bend, bends = self._bend(cosine)
        across = units[:, ::-1] - cosine[:, None, None] * units  # of each segment: what is left of the other one
        by_cosine = across / lengths[:, :, None]
        tension = self._axial * (lengths / self._lengths - 1.0)
        derivatives = tension[:, :, None] * units + bend[:, None, None] * by_cosine
        if not second:
            return derivatives, None
        eye = np.eye(dim)
        blocks = bends[:, None, None, None, None] * by_cosine[:, :, :, None, None] * by_cosine[:, None, None]
        for side in (0, 1):
            own, other, length = units[:, side], units[:, 1 - side], lengths[:, side, None, None]
            along = own[:, :, None] * own[:, None]
            stiff = (self._axial[:, side] / self._lengths[:, side])[:, None, None] * along
            stiff += (tension[:, side])[:, None, None] * (eye - along) / length
            mixed = across[:, side, :, None] * own[:, None]
            curved = -(mixed + np.swapaxes(mixed, 1, 2) + cosine[:, None, None] * (eye - along)) / length**2
            blocks[:, side, :, side] += stiff + bend[:, None, None] * curved
            turned = np.einsum("jab,jbc->jac", eye - along, eye - other[:, :, None] * other[:, None])
            blocks[:, side, :, 1 - side] += bend[:, None, None] * turned / np.prod(lengths, axis=1)[:, None, None]
        return derivatives, blocks


def _cosine(spans: Float[np.ndarray, "joints 2 dim"]) -> Vector:
    units = spans / np.linalg.norm(spans, axis=2, keepdims=True)
    return np.einsum("jd,jd->j", units[:, 0], units[:, 1])


def _curvature(cosine: Vector) -> tuple[Vector, Vector, Vector]:
    """4 (1 - c) / (1 + c) and its first two derivatives; at least 0."""
    below = np.maximum(1.0 + cosine, 1e-12)
    return np.maximum(4 * (1 - cosine) / below, 0.0), -8 / below**2, 16 / below**3


SAMPLES = 1000
"""Points along a straight part of a rod at which the element around it is asked."""


def rod_points(mesh: Mesh, corners: Points) -> Float[np.ndarray, "_ dim"]:
    """Points of a rod through some corners [m]: these, and all places where it goes from one element into the next.

    Within an element a rod stays straight, so it bends where these points are, and nowhere else.
    """
    found = [corners[:1]]
    for start, end in pairwise(corners):
        shares = _crossings(mesh, start, end)
        found.append(start + np.append(shares, 1.0)[:, None] * (end - start))
    return np.concatenate(found)


def _crossings(mesh: Mesh, start: Vector, end: Vector) -> Vector:
    """Shares of a line at which it enters another element; none near one another or near the ends."""
    shares = np.linspace(0.0, 1.0, SAMPLES + 1)
    anchors = locate(mesh, start + shares[:, None] * (end - start))
    around = [
        frozenset(nodes[weights > 1e-6]) for nodes, weights in zip(anchors.stencils, anchors.weights, strict=True)
    ]
    carrier, found = around[0], []
    for share, nodes in zip(shares, around, strict=True):
        if carrier <= nodes:
            carrier = nodes  # from a corner, an edge or a face into an element that has it
        elif not nodes <= carrier:
            carrier = nodes
            found.append(share - 0.5 / SAMPLES)
    ends = np.array([0.0, *found, 1.0])
    least = 0.1 * float(np.median(np.diff(ends)))
    kept = [0.0]
    for share in found:
        if share - kept[-1] > least and 1.0 - share > least:
            kept.append(share)
    return np.array(kept[1:])
