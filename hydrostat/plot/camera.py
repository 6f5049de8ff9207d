"""`Camera`: from where a body in space is seen, without perspective, so that lengths stay true."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float

from hydrostat.plot.sheet import MILLIMETRES

Spots = Float[np.ndarray, "_ 3"]
"""Points in space [m], or as a camera sees them: to the right, up and towards the eye [mm]."""

ELEVATION = 22.0
"""How far above the horizon the eye of a three-quarter view is [degree]; more for a body that lies flat."""

TURN = 58.0
"""Angle from the long axis of a body to the eye of a three-quarter view, from above [degree]: its sine is what is left
of the length, its cosine shows that there is depth."""


@dataclass(frozen=True, eq=False)
class Camera:
    """An eye far away; z is up in every picture, unless seen from above.

    Attributes:
        axes: unit vectors to the right, up and towards the eye, (3, 3), one row each.
    """

    axes: Float[np.ndarray, "3 3"]

    @classmethod
    def towards(cls, eye: Float[np.ndarray, " 3"]) -> Self:
        """A camera in the direction `eye` from the body; x runs to the right if that is straight above."""
        near = eye / np.linalg.norm(eye)
        right = np.array([-near[1], near[0], 0.0])
        right = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(right) < 1e-9 else right / np.linalg.norm(right)
        return cls(np.array([right, np.cross(near, right), near]))

    def see(self, points: Spots) -> Spots:
        """Points [m] as they are seen: to the right, up and towards the eye [mm]."""
        return MILLIMETRES * points @ self.axes.T


def three_quarter(shape: Spots, shown: Spots) -> Camera:
    """The camera that shows the length of a body, some of its depth, and that side of it where most is to be seen.

    Args:
        shape: points all over the body at rest [m].
        shown: winches, cable points and markers [m]; may be empty.
    """
    middle = (shape.min(axis=0) + shape.max(axis=0)) / 2
    sides = np.ptp(shape, axis=0)
    flat = np.clip(1 - 2 * sides[2] / max(min(sides[0], sides[1]), 1e-12), 0, 1)
    height = np.radians(ELEVATION + 20 * flat)
    long_way = _long_way(shape[:, :2])
    turns = np.radians([-TURN, TURN, 180 - TURN, 180 + TURN]) + long_way
    eyes = np.column_stack([np.cos(height) * np.cos(turns), np.cos(height) * np.sin(turns), np.full(4, np.sin(height))])
    facing = (shown - middle).mean(axis=0) @ eyes.T / max(sides.max(), 1e-12) if len(shown) else np.zeros(4)
    score = np.round(facing, 3) - 0.02 * np.round(eyes[:, 1], 3) + 0.005 * np.round(eyes[:, 0], 3)
    return Camera.towards(eyes[int(np.argmax(score))])


def along_an_axis(shape: Spots, shown: Spots, ways: Spots) -> Camera:
    """The camera along x, y or z that shows most of the body and of where its points go.

    Args:
        shape: points all over the body [m].
        shown: winches, cable points and markers [m], which decide from which side; may be empty.
        ways: how points of the body move [m].
    """
    sides = np.ptp(shape, axis=0)
    moved = (ways**2).sum(axis=0)
    scores = []
    for axis in range(3):
        others = [other for other in range(3) if other != axis]
        share = moved[others].sum() / moved.sum() if moved.sum() > 0 else 1.0
        scores.append(share * np.sqrt(np.prod(sides[others])))
    axis = int(np.argmax(np.round(np.array(scores) / max(scores), 4)))
    middle = (shape.min(axis=0) + shape.max(axis=0)) / 2
    lean = float((shown - middle).mean(axis=0)[axis]) if len(shown) else 0.0
    usual = (1.0, -1.0, 1.0)[axis]
    sign = np.sign(lean) if abs(lean) > 0.02 * sides.max() and axis != 2 else usual
    return Camera.towards(sign * np.eye(3)[axis])


def _long_way(points: Float[np.ndarray, "_ 2"]) -> float:
    """Angle of the longest direction of points seen from above [rad]; 0 where no direction is much longer."""
    spread, ways = np.linalg.eigh(np.cov(points.T))
    if spread[1] < 1.3 * spread[0] or spread[1] <= 0:
        return 0.0
    way = ways[:, 1] * (1 if ways[np.argmax(np.abs(ways[:, 1])), 1] > 0 else -1)
    return float(np.arctan2(way[1], way[0]))
