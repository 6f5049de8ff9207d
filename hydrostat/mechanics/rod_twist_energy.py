"""`RodTwistEnergy`: resistance of an elastic rod in a body to twist."""

from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.geometry import Mesh, locate
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks

LARGEST_TWIST = 3.0
"""Twist of a segment from which on the energy is infinite [rad]; at pi its sense is lost."""

OFFSET = 0.5
"""Distance of the points beside the rod that follow its rotation, in mean edges of the mesh."""

Vectors = Float[np.ndarray, "segments 3 dim"]


class RodTwistEnergy(Energy):
    """Twist of a discrete elastic rod: E = sum over segments of GJ / (2 L) (a - a0)^2 (cf. Bergou et al. 2008).

    The directors of a rod lead from its points to points of the body beside it. a is the angle between the directors at
    both ends of a segment of length L, seen along the segment, and a0 the one at rest.
    """

    convex: ClassVar[bool] = False

    def __init__(self, nodes: Nodes, mesh: Mesh, points: Points, *, torsional_stiffness: float) -> None:
        """Rod through at least two points of a body in space [m], with GJ [N m^2]; `nodes` are the rest shape [m]."""
        ends = locate(mesh, points)
        spans = np.diff(points, axis=0)
        beside = locate(mesh, _points_beside(mesh, points))
        segments = np.arange(len(spans))
        pairs = [(anchors, segments + end) for anchors in (ends, beside) for end in (0, 1)]
        self.stencils = np.concatenate([anchors.stencils[which] for anchors, which in pairs], axis=1)
        corners = ends.stencils.shape[1]
        # Vectors of a segment are the directors at its ends and itself, from the points x0, x1, y0, y1.
        signs = np.array([[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0], [-1.0, 1.0, 0.0, 0.0]])
        weights = np.stack([anchors.weights[which] for anchors, which in pairs], axis=1)  # (segments, 4, corners)
        self._weights = (signs[None, :, :, None] * weights[:, None]).reshape(len(spans), 3, 4 * corners)
        rest = self._vectors(nodes)
        self._scales = 1.0 / np.linalg.norm(rest, axis=2)
        self._stiffness = torsional_stiffness * self._scales[:, 2]
        self._rest = _twist(rest * self._scales[:, :, None])
        self._whole = torsional_stiffness
        arms = 1.0 / self._scales[:, :2].max(axis=1)
        self.stiffest = float((self._stiffness / arms**2).max())

    def _vectors(self, nodes: Nodes) -> Vectors:
        return np.einsum("svc,scd->svd", self._weights, nodes[self.stencils])

    def _angles(self, nodes: Nodes) -> tuple[Vectors, Vector]:
        """Vectors of each segment, about 1 long, and its twist since rest, from -pi to pi [rad]."""
        vectors = self._vectors(nodes) * self._scales[:, :, None]
        return vectors, (_twist(vectors) - self._rest + np.pi) % (2 * np.pi) - np.pi

    def value(self, nodes: Nodes, controls: Vector) -> float:
        angles = self._angles(nodes)[1]
        if not (np.abs(angles) < LARGEST_TWIST).all():
            return np.inf
        return 0.5 * float(self._stiffness @ angles**2)

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        vectors, angles = self._angles(nodes)
        slopes = (self._stiffness * angles)[:, None, None] * _twist_gradient(vectors) * self._scales[:, :, None]
        return np.einsum("svc,svd->scd", self._weights, slopes)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        vectors, angles = self._angles(nodes)
        slopes, curvatures = _twist_gradient(vectors), _twist_hessian(vectors)
        blocks = slopes[:, :, :, None, None] * slopes[:, None, None]
        blocks = self._stiffness[:, None, None, None, None] * (blocks + angles[:, None, None, None, None] * curvatures)
        weights = self._weights * self._scales[:, :, None]
        found = np.einsum("sva,swb,svdwe->sadbe", weights, weights, blocks, optimize=True)
        size = self.stencils.shape[1] * nodes.shape[1]
        return found.reshape(len(found), size, size)

    def stiffness_work(self, nodes: Nodes, field: Nodes) -> float:
        """d(dE/dx . field) / dGJ."""
        vectors, angles = self._angles(nodes)
        moves = self._vectors(field) * self._scales[:, :, None]
        turns = (_twist_gradient(vectors) * moves).sum(axis=(1, 2))
        return float((self._stiffness * angles) @ turns) / self._whole


def _points_beside(mesh: Mesh, points: Points) -> Points:
    """A point beside each point of a rod, on the side where most of them are in the body."""
    spans = np.diff(points, axis=0)
    tangents = spans / np.linalg.norm(spans, axis=1)[:, None]
    tangents = np.concatenate([tangents[:1], tangents[1:] + tangents[:-1], tangents[-1:]])
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    normals = [np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])]
    for tangent in tangents[1:]:
        normals.append(normals[-1] - (normals[-1] @ tangent) * tangent)
    first = np.array(normals) / np.linalg.norm(normals, axis=1)[:, None]
    second = np.cross(tangents, first)
    edges = mesh.nodes[mesh.elements[:, 1:]] - mesh.nodes[mesh.elements[:, :1]]
    reach = OFFSET * float(np.linalg.norm(edges, axis=2).mean())
    sides = [points + reach * side for side in (first, second, -first, -second)]
    return min(sides, key=lambda side: float(locate(mesh, side).distances.max()))


def _twist(vectors: Vectors) -> Vector:
    """Angle from the first to the second director about the segment [rad]."""
    return np.arctan2(*_sine_cosine(vectors))


def _sine_cosine(vectors: Vectors) -> tuple[Vector, Vector]:
    """Sine and cosine of the twist, both times the same number."""
    u, v, t = np.moveaxis(vectors, 1, 0)
    sine = np.linalg.norm(t, axis=1) * _dot(np.cross(u, v), t)
    return sine, _dot(u, v) * _dot(t, t) - _dot(u, t) * _dot(v, t)


def _sine_cosine_gradients(vectors: Vectors) -> tuple[Vectors, Vectors]:
    u, v, t = np.moveaxis(vectors, 1, 0)
    length = np.linalg.norm(t, axis=1)[:, None]
    volume = _dot(np.cross(u, v), t)[:, None]
    uv, ut, vt, tt = (_dot(a, b)[:, None] for a, b in ((u, v), (u, t), (v, t), (t, t)))
    sine = [length * np.cross(v, t), length * np.cross(t, u), length * np.cross(u, v) + volume * t / length]
    cosine = [v * tt - t * vt, u * tt - t * ut, 2 * t * uv - u * vt - v * ut]
    return np.stack(sine, axis=1), np.stack(cosine, axis=1)


def _twist_gradient(vectors: Vectors) -> Vectors:
    sine, cosine = (part[:, None, None] for part in _sine_cosine(vectors))
    by_sine, by_cosine = _sine_cosine_gradients(vectors)
    return (cosine * by_sine - sine * by_cosine) / (sine**2 + cosine**2)


def _twist_hessian(vectors: Vectors) -> Float[np.ndarray, "segments 3 dim 3 dim"]:
    sine, cosine = (part[:, None, None, None, None] for part in _sine_cosine(vectors))
    square = sine**2 + cosine**2
    by_sine, by_cosine = _sine_cosine_gradients(vectors)

    def product(one: Vectors, other: Vectors) -> np.ndarray:
        return one[:, :, :, None, None] * other[:, None, None]

    sines, cosines = _sine_cosine_hessians(vectors)
    found = (cosine * sines - sine * cosines) / square
    found -= 2 * sine * cosine * (product(by_sine, by_sine) - product(by_cosine, by_cosine)) / square**2
    mixed = product(by_sine, by_cosine) + product(by_cosine, by_sine)
    return found + (sine**2 - cosine**2) * mixed / square**2


def _sine_cosine_hessians(vectors: Vectors) -> tuple[np.ndarray, np.ndarray]:
    u, v, t = np.moveaxis(vectors, 1, 0)
    length = np.linalg.norm(t, axis=1)[:, None, None]
    volume = _dot(np.cross(u, v), t)[:, None, None]
    uv, ut, vt, tt = (_dot(a, b)[:, None, None] for a, b in ((u, v), (u, t), (v, t), (t, t)))
    sine, cosine = np.zeros((2, len(u), 3, 3, 3, 3))
    along, eye, cross = t / length[:, 0], np.eye(3), np.cross(u, v)
    sine[:, 0, :, 1] = -length * _skew(t)
    sine[:, 0, :, 2] = length * _skew(v) + _outer(np.cross(v, t), along)
    sine[:, 1, :, 2] = -length * _skew(u) + _outer(np.cross(t, u), along)
    stretch = (eye - _outer(along, along)) / length
    sine[:, 2, :, 2] = _outer(cross, along) + _outer(along, cross) + volume * stretch
    cosine[:, 0, :, 1] = tt * eye - _outer(t, t)
    cosine[:, 0, :, 2] = 2 * _outer(v, t) - vt * eye - _outer(t, v)
    cosine[:, 1, :, 2] = 2 * _outer(u, t) - ut * eye - _outer(t, u)
    cosine[:, 2, :, 2] = 2 * uv * eye - _outer(u, v) - _outer(v, u)
    for part in (sine, cosine):
        for one, other in ((0, 1), (0, 2), (1, 2)):
            part[:, other, :, one] = np.swapaxes(part[:, one, :, other], 1, 2)
    return sine, cosine


def _dot(one: Points, other: Points) -> Vector:
    return np.einsum("sd,sd->s", one, other)


def _outer(one: Points, other: Points) -> np.ndarray:
    return one[:, :, None] * other[:, None]


def _skew(vectors: Points) -> np.ndarray:
    """Matrices [a] with [a] b = a x b."""
    return np.cross(vectors[:, None], np.eye(3)[None]).swapaxes(1, 2)
