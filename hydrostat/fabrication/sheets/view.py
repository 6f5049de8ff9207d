"""`View`: from where a drawing is seen; all lines of sight are parallel."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, eq=False)
class View:
    """An eye far away.

    Attributes:
        axes: unit vectors to the right, up and towards the eye, (3, 3), one row each.
    """

    axes: Float[np.ndarray, "3 3"]

    @classmethod
    def at(cls, azimuth: float, elevation: float) -> Self:
        """From a compass direction about z, from x towards y, and a height over the horizon [degrees]; z is upright."""
        turn, rise = np.radians([azimuth, elevation])
        near = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
        right = np.array([-np.sin(turn), np.cos(turn), 0.0])
        return cls(np.array([right, np.cross(near, right), near]))

    @classmethod
    def upright(cls, up: Float[np.ndarray, " 3"], azimuth: float, elevation: float) -> Self:
        """The same with another direction upright."""
        up = up / np.linalg.norm(up)
        side = np.eye(3)[int(np.argmin(np.abs(up)))]
        one = np.cross(side, up) / np.linalg.norm(np.cross(side, up))
        return cls(cls.at(azimuth, elevation).axes @ np.array([one, np.cross(up, one), up]))

    @classmethod
    def isometric(cls) -> Self:
        """All three axes are equally short: a cube is a regular hexagon."""
        return cls.at(-45.0, float(np.degrees(np.arctan(np.sqrt(0.5)))))

    def see(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Points as they are seen: to the right, up and towards the eye [mm]."""
        return points @ self.axes.T
