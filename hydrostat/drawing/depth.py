"""`DepthBuffer`: the nearest surface at each pixel, for hidden-surface removal."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import shapely

from hydrostat.arrays import Float, Int
from hydrostat.kernel import native

Polyline = Float[np.ndarray, "_ 2"]  # a line on a picture: to the right, up [mm]


@dataclass(frozen=True, eq=False, kw_only=True)
class DepthBuffer:
    """Picture of depths (z-buffer)."""

    low: Float[np.ndarray, " 2"]  # place of the middle of pixel [0, 0] as seen: to the right, up [mm]
    pixel: float  # side of a pixel [mm]
    depth: Float[np.ndarray, "rows columns"]  # depth towards the eye [mm], rows upwards; -inf for empty pixels
    shown: Float[np.ndarray, "rows columns values"]  # values interpolated from the corners; 0 for empty pixels
    owner: Int[np.ndarray, "rows columns"]  # index of the visible triangle; -1 for empty pixels

    @classmethod
    def of(
        cls,
        corners: Float[np.ndarray, "triangles 3 3"],
        values: Float[np.ndarray, "triangles 3 values"],
        *,
        pixels: int,
    ) -> Self:
        """Buffer of triangles seen [mm] from both sides, with room round it and pixels along its longer side."""
        low, high = corners[:, :, :2].min(axis=(0, 1)), corners[:, :, :2].max(axis=(0, 1))
        pixel = max(float((high - low).max()) / pixels, 1e-9)
        rim = 4  # pixels of nothing round the picture
        low = low - rim * pixel
        columns, rows = (np.ceil((high - low) / pixel).astype(int) + 1 + rim).tolist()
        return cls.within(corners, values, low, pixel, (rows, columns), inside=True)

    @classmethod
    def within(
        cls,
        corners: Float[np.ndarray, "triangles 3 3"],
        values: Float[np.ndarray, "triangles 3 values"],
        low: Float[np.ndarray, " 2"],
        pixel: float,
        shape: tuple[int, int],
        *,
        inside: bool,
    ) -> Self:
        """Buffer of rows and columns of a pixel's size [mm] whose pixel [0, 0] has its middle at `low` [mm].

        The inside of triangles, where they turn clockwise, is seen too if asked for.
        """
        depth, owner = np.full(shape, -np.inf), np.full(shape, -1, dtype=np.int32)
        shown = np.zeros((*shape, values.shape[2]), dtype=values.dtype)
        spots = corners.copy()
        spots[:, :, :2] = (corners[:, :, :2] - low) / pixel
        native.rasterise(np.ascontiguousarray(spots), np.ascontiguousarray(values), inside, depth, shown, owner)
        return cls(low=low, pixel=pixel, depth=depth, shown=shown, owner=owner)

    def coarser(self, step: int) -> "DepthBuffer":
        """Return the buffer of pixels `step` times as large, each with the surface near its center."""
        near = slice(step // 2, None, step), slice(step // 2, None, step)
        parts = {name: getattr(self, name)[near].copy() for name in ("depth", "shown", "owner")}
        return DepthBuffer(low=self.low + (step - 1) / 2 * self.pixel, pixel=step * self.pixel, **parts)

    @cached_property
    def _deepest(self) -> tuple[Float[np.ndarray, "rows columns"], ...]:
        from scipy.ndimage import minimum_filter

        return (self.depth, *(minimum_filter(self.depth, size=size, mode="nearest") for size in (3, 5)))

    def behind(self, spots: Float[np.ndarray, "points 3"], reach: int = 0) -> Float[np.ndarray, " points"]:
        """Depth of points in front of the deepest surface seen within `reach` pixels, 0 to 2 [mm]."""
        deepest = self._deepest[reach] if reach else self.depth
        rows, columns = self.depth.shape
        column, row = np.rint((spots[:, :2] - self.low) / self.pixel).astype(int).T
        return spots[:, 2] - deepest[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]

    def rings(self, field: Float[np.ndarray, "rows columns"], level: float, *, tolerance: float) -> list[Polyline]:
        """Closed level lines of a value given at each pixel [mm], smooth to a tolerance [pixels]."""
        return [self.low + self.pixel * ring for ring in level_rings(field, level, tolerance=tolerance)]


def level_rings(field: Float[np.ndarray, "rows columns"], level: float, *, tolerance: float) -> list[Polyline]:
    """Closed lines where a field passes a level (contour lines): column and row of their points, the first repeated."""
    from contourpy import LineType, contour_generator

    lines = contour_generator(z=field, line_type=LineType.Separate).lines(level)
    smooth = [shapely.simplify(shapely.linestrings(np.asarray(line)), tolerance) for line in lines]
    return [ring for ring in map(shapely.get_coordinates, smooth) if len(ring) > 3]
