"""`Camera`: from where a body in space is seen, without perspective, so that lengths stay true."""

from dataclasses import dataclass, field
from typing import Self

import numpy as np

from hydrostat.arrays import Float

Spots = Float[np.ndarray, "_ 3"]  # points in space, or as a camera sees them: to the right, up and towards the eye
TURN = 58.0
"""Angle from the long axis of a body to the eye of a three-quarter view, from above [degree]: its sine is what is left
of the length, its cosine shows that there is depth."""


@dataclass(frozen=True, eq=False)
class Camera:
    """Orthographic camera; upward stays upright in every picture, unless seen from above."""

    axes: Float[np.ndarray, "3 3"]  # unit vectors to the right, up and towards the eye, (3, 3), one row each
    up: Float[np.ndarray, " 3"] = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))  # upward direction

    @classmethod
    def towards(cls, eye: Float[np.ndarray, " 3"], *, up: Float[np.ndarray, " 3"] | None = None) -> Self:
        """Camera in the direction `eye` from the body; `up` is up, or z, with x to the right seen from there."""
        turn = Camera.upright(np.array([0.0, 0.0, 1.0]) if up is None else up)
        near = turn @ eye / np.linalg.norm(eye)
        right = np.array([-near[1], near[0], 0.0])
        right = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(right) < 1e-9 else right / np.linalg.norm(right)
        return cls(np.array([right, np.cross(near, right), near]) @ turn, turn[2])

    @classmethod
    def at(cls, azimuth: float, elevation: float, *, up: Float[np.ndarray, " 3"] | None = None) -> Self:
        """Camera in a compass direction, x towards y, over the horizon [degrees]; z, or `up`, is upright."""
        turn, rise = np.radians([azimuth, elevation])
        near = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
        right = np.array([-np.sin(turn), np.cos(turn), 0.0])
        axes = np.array([right, np.cross(near, right), near])
        if up is None:
            return cls(axes)
        up = up / np.linalg.norm(up)
        side = np.eye(3)[int(np.argmin(np.abs(up)))]
        one = np.cross(side, up) / np.linalg.norm(np.cross(side, up))
        return cls(axes @ np.array([one, np.cross(up, one), up]), up)

    @classmethod
    def isometric(cls) -> Self:
        """Camera that sees all three axes equally short: a cube is a regular hexagon."""
        return cls.at(-45.0, float(np.degrees(np.arctan(np.sqrt(0.5)))))

    @property
    def sky(self) -> Float[np.ndarray, " 3"]:
        """Upward direction as the camera sees it."""
        return self.axes @ self.up

    def see(self, points: Spots) -> Spots:
        """Points as they are seen: to the right, up and towards the eye, in the unit of the points."""
        return points @ self.axes.T

    @staticmethod
    def along_an_axis(shape: Spots, shown: Spots, ways: Spots, up: Float[np.ndarray, " 3"] | None = None) -> "Camera":
        """Camera along x, y or z that shows most of the body and of the paths of its points.

        The shape is points all over the body [m]; winches, cable points and markers that are shown [m], if any, decide
        from which side; ways are how points of the body move [m]. Of x, y and z, whichever is nearest to `up`, z if
        left out, stands upright.
        """
        turn = np.eye(3) if up is None else Camera.upright(_nearest_axis(up))
        shape, shown, ways = shape @ turn.T, shown @ turn.T, ways @ turn.T
        sides = np.ptp(shape, axis=0)
        moved = (ways**2).sum(axis=0)
        scores = []
        # worth of a view from above beside one from the side that shows as much: there, up is not seen
        from_above = 0.97
        for axis in range(3):
            others = [other for other in range(3) if other != axis]
            share = moved[others].sum() / moved.sum() if moved.sum() > 0 else 1.0
            scores.append(share * np.sqrt(np.prod(sides[others])) * (from_above if axis == 2 else 1.0))
        axis = int(np.argmax(np.round(np.array(scores) / max(scores), 4)))
        middle = (shape.min(axis=0) + shape.max(axis=0)) / 2
        lean = float((shown - middle).mean(axis=0)[axis]) if len(shown) else 0.0
        usual = (1.0, -1.0, 1.0)[axis]
        sign = np.sign(lean) if abs(lean) > 0.02 * sides.max() and axis != 2 else usual
        return Camera.towards(sign * np.eye(3)[axis] @ turn, up=turn[2])

    @staticmethod
    def three_quarter(
        shape: Spots, shown: Spots, up: Float[np.ndarray, " 3"] | None = None, asked: Spots | None = None
    ) -> "Camera":
        """Camera that shows the length of a body, some of its depth, and the side with the most visible detail.

        The shape is points all over the body at rest [m]; winches, cable points and markers are shown [m], if any; `up`
        is z if left out. Points that are asked to move so far [m] rather come towards the eye than go away from it.
        """
        turn = np.eye(3) if up is None else Camera.upright(up)
        shape, shown = shape @ turn.T, shown @ turn.T
        middle = (shape.min(axis=0) + shape.max(axis=0)) / 2
        sides = np.ptp(shape, axis=0)
        flat = np.clip(1 - 2 * sides[2] / max(min(sides[0], sides[1]), 1e-12), 0, 1)
        # angle of the eye of a three-quarter view above the horizon [degree]; more for a body that lies flat
        elevation = 22.0
        height = np.radians(elevation + 20 * flat)
        long_way = _long_way(shape[:, :2])
        turns = np.radians([-TURN, TURN, 180 - TURN, 180 + TURN]) + long_way
        eyes = np.column_stack(
            [np.cos(height) * np.cos(turns), np.cos(height) * np.sin(turns), np.full(4, np.sin(height))]
        )
        facing = (shown - middle).mean(axis=0) @ eyes.T / max(sides.max(), 1e-12) if len(shown) else np.zeros(4)
        if asked is not None and len(asked):
            facing = facing + asked.mean(axis=0) @ turn.T @ eyes.T / max(sides.max(), 1e-12)
        score = np.round(facing, 3) - 0.02 * np.round(eyes[:, 1], 3) + 0.005 * np.round(eyes[:, 0], 3)
        return Camera.towards(eyes[int(np.argmax(score))] @ turn, up=turn[2])

    @staticmethod
    def upright(up: Float[np.ndarray, " 3"]) -> Float[np.ndarray, "3 3"]:
        """Shortest turn that makes `up` point along z, as a matrix; about x where it is straight down."""
        way = up / np.linalg.norm(up)
        if way[2] < -1 + 1e-9:
            return np.diag([1.0, -1.0, -1.0])
        x, y, z = way
        share = 1 / (1 + z)
        return np.array([[1 - x * x * share, -x * y * share, -x], [-x * y * share, 1 - y * y * share, -y], [x, y, z]])


def _nearest_axis(way: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """Axis among +-x, +-y, +-z that is nearest to a direction; z if several are."""
    axis = 2 - int(np.argmax(np.round(np.abs(way[::-1]) / np.linalg.norm(way), 9)))
    return np.sign(way[axis]) * np.eye(3)[axis]


def _long_way(points: Float[np.ndarray, "_ 2"]) -> float:
    """Angle of the longest direction of points seen from above [rad]; 0 where no direction is much longer."""
    spread, ways = np.linalg.eigh(np.cov(points.T))
    if spread[1] < 1.3 * spread[0] or spread[1] <= 0:
        return 0.0
    way = ways[:, 1] * (1 if ways[np.argmax(np.abs(ways[:, 1])), 1] > 0 else -1)
    return float(np.arctan2(way[1], way[0]))
