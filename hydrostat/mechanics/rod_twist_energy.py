"""`RodTwistEnergy`: resistance of an elastic rod in a body to twist."""

from typing import ClassVar

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.geometry import Mesh, locate
from hydrostat.mechanics.energy import Blocks, Energy, HessianBlocks

MAX_TWIST = 3.0
"""Twist of a segment from which on the energy is infinite [rad]; at pi its sense is lost."""

OFFSET = 0.5
"""Distance of the points of the body that follow the rotation of the rod, in mean edges of the mesh."""

Vectors = Float[np.ndarray, "terms 3 dim"]


class RodTwistEnergy(Energy):
    """Twist of a discrete elastic rod: E = sum over segments of GJ / (2 L) (a - a0)^2 (cf. Bergou et al. 2008).

    Two directors lead from each point of the rod to points of the body, at right angles to the rod and to one another
    at rest. a is the angle between the directors at the ends of a segment of length L, seen along the segment: the mean
    of both pairs, so that a shear of the section counts as no twist. a0 is the one at rest. As bending, twist needs two
    or more elements across the body.
    """

    convex: ClassVar[bool] = False

    def __init__(self, nodes: Nodes, mesh: Mesh, points: Points, *, torsional_stiffness: float) -> None:
        """Rod through at least two points of a body in space [m], with GJ [N m^2]; `nodes` are the rest shape [m]."""
        segments = np.arange(len(points) - 1)
        held = [locate(mesh, places) for places in (points, *_director_points(mesh, points))]
        pairs = [(anchors, segments + end) for anchors in held for end in (0, 1)]
        self.stencils = np.concatenate([anchors.stencils[which] for anchors, which in pairs], axis=1)
        weights = np.stack([anchors.weights[which] for anchors, which in pairs], axis=1)  # (segments, 6, corners)
        self._weights = np.einsum("pvk,skc->spvkc", _VECTORS, weights).reshape(len(segments), 2, 3, -1)
        rest = self._vectors(nodes)
        self._scales = 1.0 / np.linalg.norm(rest, axis=3)
        self._stiffness = torsional_stiffness * self._scales[:, 0, 2]
        self._rest = _twist(_flat(rest * self._scales[..., None]))
        self._whole = torsional_stiffness
        arms = 1.0 / self._scales[:, :, :2].max(axis=(1, 2))
        self.stiffest = float((self._stiffness / arms**2).max())

    def _vectors(self, nodes: Nodes) -> Float[np.ndarray, "segments 2 3 dim"]:
        """Directors at both ends of each segment and the segment, for the first and the second director [m]."""
        return np.einsum("spvc,scd->spvd", self._weights, nodes[self.stencils])

    def _angles(self, nodes: Nodes) -> tuple[Vectors, Vector, bool]:
        """Vectors of both directors, about 1 long, twists of segments since rest [rad], and if all are allowed."""
        vectors = _flat(self._vectors(nodes) * self._scales[..., None])
        angles = (_twist(vectors) - self._rest + np.pi) % (2 * np.pi) - np.pi
        return vectors, angles.reshape(-1, 2).mean(axis=1), bool((np.abs(angles) < MAX_TWIST).all())

    def value(self, nodes: Nodes, controls: Vector) -> float:
        _, angles, allowed = self._angles(nodes)
        return 0.5 * float(self._stiffness @ angles**2) if allowed else np.inf

    def gradient(self, nodes: Nodes, controls: Vector) -> Blocks:
        vectors, angles, _ = self._angles(nodes)
        slopes = (self._stiffness * angles)[:, None, None, None] * self._slopes(vectors)
        return np.einsum("spvc,spvd->scd", self._weights, slopes)

    def hessian(self, nodes: Nodes, controls: Vector) -> HessianBlocks:
        vectors, angles, _ = self._angles(nodes)
        by_corners = np.einsum("spvc,spvd->scd", self._weights, self._slopes(vectors))
        by_corners = by_corners.reshape(len(angles), -1)
        curvatures = 0.5 * _twist_hessian(vectors).reshape(-1, 2, 3, 3, 3, 3)
        weights = self._weights * self._scales[..., None]
        bent = np.einsum("spva,spwb,spvdwe->sadbe", weights, weights, curvatures, optimize=True)
        bent = bent.reshape(len(angles), by_corners.shape[1], by_corners.shape[1])
        outer = by_corners[:, :, None] * by_corners[:, None]
        return self._stiffness[:, None, None] * (outer + angles[:, None, None] * bent)

    def stiffness_work(self, nodes: Nodes, field: Nodes) -> float:
        """d(dE/dx . field) / dGJ."""
        vectors, angles, _ = self._angles(nodes)
        turns = (self._slopes(vectors) * self._vectors(field)).sum(axis=(1, 2, 3))
        return float((self._stiffness * angles) @ turns) / self._whole

    def _slopes(self, vectors: Vectors) -> Float[np.ndarray, "segments 2 3 dim"]:
        """Derivatives of the twist of each segment by its vectors [1/m]."""
        return 0.5 * _twist_gradient(vectors).reshape(-1, 2, 3, 3) * self._scales[..., None]


_SEGMENT = [-1.0, 1.0, 0.0, 0.0, 0.0, 0.0]
_VECTORS = np.array(
    [
        [[-1.0, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 1.0, 0.0, 0.0], _SEGMENT],
        [[-1.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0, 0.0, 1.0], _SEGMENT],
    ]
)
"""Vectors of each director, at both ends and the segment, from points at both ends: of the rod and both directors."""


def _flat(vectors: np.ndarray) -> Vectors:
    return vectors.reshape(-1, *vectors.shape[2:])


def _director_points(mesh: Mesh, points: Points) -> tuple[Points, Points]:
    """Points next to each point of a rod, in two directions across it, on the sides that lie deeper in the body."""
    spans = np.diff(points, axis=0)
    tangents = spans / np.linalg.norm(spans, axis=1)[:, None]
    tangents = np.concatenate([tangents[:1], tangents[1:] + tangents[:-1], tangents[-1:]])
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    normals = [np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])]
    for tangent in tangents[1:]:
        normals.append(normals[-1] - (normals[-1] @ tangent) * tangent)
    first = np.array(normals) / np.linalg.norm(normals, axis=1)[:, None]
    edges = mesh.nodes[mesh.elements[:, 1:]] - mesh.nodes[mesh.elements[:, :1]]
    reach = OFFSET * float(np.linalg.norm(edges, axis=2).mean())

    def deeper(side: Points) -> Points:
        sides = [points + reach * side, points - reach * side]
        return min(sides, key=lambda each: float(locate(mesh, each).distances.max()))

    return deeper(first), deeper(np.cross(tangents, first))


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
