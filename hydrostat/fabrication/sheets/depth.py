"""`DepthBuffer`: what is nearest to the eye at each pixel, by which a drawing knows what is hidden."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self, no_type_check

import numpy as np
from jaxtyping import Float, Int
from numba import njit
from scipy.ndimage import minimum_filter

from hydrostat.kernel import KERNEL

_RIM = 4
"""Pixels of nothing round the picture."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DepthBuffer:
    """A picture of depths.

    Attributes:
        low: place of the middle of pixel [0, 0] as seen: to the right, up [mm].
        pixel: side of a pixel [mm].
        depth: towards the eye [mm], one row for each height, upwards; -inf where nothing is.
        light: from -1, turned away from the lamp, to 1; 1 where nothing is.
        owner: index of the triangle that is seen; -1 where nothing is.
    """

    low: Float[np.ndarray, " 2"]
    pixel: float
    depth: Float[np.ndarray, "rows columns"]
    light: Float[np.ndarray, "rows columns"]
    owner: Int[np.ndarray, "rows columns"]

    @classmethod
    def of(
        cls,
        corners: Float[np.ndarray, "triangles 3 3"],
        lights: Float[np.ndarray, "triangles 3"],
        *,
        pixels: int,
    ) -> Self:
        """The buffer of triangles as they are seen [mm], with the light at each corner.

        Args:
            corners: of the triangles.
            lights: at them.
            pixels: along the longer side.
        """
        low, high = corners[:, :, :2].min(axis=(0, 1)), corners[:, :, :2].max(axis=(0, 1))
        pixel = max(float((high - low).max()) / pixels, 1e-9)
        low = low - _RIM * pixel
        columns, rows = (np.ceil((high - low) / pixel).astype(int) + 1 + _RIM).tolist()
        depth, light = np.full((rows, columns), -np.inf), np.ones((rows, columns))
        owner = np.full((rows, columns), -1)
        spots = corners.copy()
        spots[:, :, :2] = (corners[:, :, :2] - low) / pixel
        fill(np.ascontiguousarray(spots), np.ascontiguousarray(lights), depth, light, owner)
        return cls(low=low, pixel=pixel, depth=depth, light=light, owner=owner)

    @cached_property
    def _deepest_by_one(self) -> Float[np.ndarray, "rows columns"]:
        return minimum_filter(self.depth, size=3, mode="nearest")

    @cached_property
    def _deepest_by_two(self) -> Float[np.ndarray, "rows columns"]:
        return minimum_filter(self.depth, size=5, mode="nearest")

    def behind(self, spots: Float[np.ndarray, "points 3"], reach: int) -> Float[np.ndarray, " points"]:
        """How far points as they are seen lie before the deepest that is seen within `reach` pixels, 0 to 2 [mm]."""
        deepest = (self.depth, self._deepest_by_one, self._deepest_by_two)[reach]
        rows, columns = self.depth.shape
        column, row = np.rint((spots[:, :2] - self.low) / self.pixel).astype(int).T
        return spots[:, 2] - deepest[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]


@njit(**KERNEL)
@no_type_check
def fill(spots, lights, depth, light, owner):
    """Lay triangles into a depth buffer; x and y of the spots in pixels, z in millimetres."""
    rows, columns = depth.shape
    for index in range(len(spots)):
        x0, y0, z0 = spots[index, 0]
        x1, y1, z1 = spots[index, 1]
        x2, y2, z2 = spots[index, 2]
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if abs(area) < 1e-9:
            continue
        first = max(int(np.ceil(min(y0, y1, y2))), 0)
        last = min(int(np.floor(max(y0, y1, y2))), rows - 1)
        left = max(int(np.ceil(min(x0, x1, x2))), 0)
        right = min(int(np.floor(max(x0, x1, x2))), columns - 1)
        for row in range(first, last + 1):
            for column in range(left, right + 1):
                b = ((column - x0) * (y2 - y0) - (x2 - x0) * (row - y0)) / area
                c = ((x1 - x0) * (row - y0) - (column - x0) * (y1 - y0)) / area
                a = 1.0 - b - c
                if a < -1e-9 or b < -1e-9 or c < -1e-9:
                    continue
                z = a * z0 + b * z1 + c * z2
                if z > depth[row, column]:
                    depth[row, column] = z
                    owner[row, column] = index
                    light[row, column] = a * lights[index, 0] + b * lights[index, 1] + c * lights[index, 2]
