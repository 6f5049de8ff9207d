"""`PocketRoom`: places in a body of foam at which the pocket of a winch has room."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from manifold3d import Manifold

from hydrostat.arrays import Bool, Int, Points, Vector
from hydrostat.fabrication.kit_options import MoldOptions
from hydrostat.fabrication.moulds.pocket import MIN_SKIN, LyingWinch, WinchRoom, ways_to_turn
from hydrostat.fabrication.moulds.setting import mold_setting
from hydrostat.fabrication.moulds.stance import MoldOrientation
from hydrostat.fabrication.solids.construct import Cuboid
from hydrostat.robot import Robot
from hydrostat.units import MILLIMETERS

Number3 = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class PocketRoom:
    """Body of foam as small cubes along the axes of its mold, in which boxes are counted by a table of sums."""

    body: Manifold  # body in the coordinates of the mold [mm]
    stance: MoldOrientation  # axes of the mold
    clearance: float  # room between a winch and the foam, on each side [mm]

    def places(self, room: Cuboid, *, scale: float = 1.0) -> tuple[Points, Vector]:
        """Find places of a winch at which its pocket is in the body, with foam round it.

        Returns places in the coordinates of the robot [m], and the radius of the ball round each that has room [m];
        both of a body that is scaled by a factor.
        """
        from scipy.ndimage import distance_transform_edt

        fits = self._fits(room, scale)
        if not fits.any():
            return np.zeros((0, 3)), np.zeros(0)
        away = np.asarray(distance_transform_edt(np.pad(fits, 1)))[1:-1, 1:-1, 1:-1]
        radii = np.maximum(away[fits] - 0.5, 0.5) * _RULES.stride * self.step
        spots = self._low + self.step * (_RULES.stride * np.argwhere(fits) + 0.5)
        spots = (spots + np.array([0.0, 0.0, self.stance.height])) @ self.stance.axes
        return scale * spots / MILLIMETERS, scale * radii / MILLIMETERS

    @cached_property
    def step(self) -> float:
        """Side of a cube [mm]."""
        low, high = np.reshape(self.body.bounding_box(), (2, 3))
        return max(float((high - low).max()) / _RULES.num_cubes, _RULES.min_cube)

    @cached_property
    def _low(self) -> Vector:
        return np.reshape(self.body.bounding_box(), (2, 3))[0]

    @cached_property
    def _sums(self) -> Int[np.ndarray, "x y z"]:
        """Number of cubes inside the body before each corner of the grid."""
        low, high = np.reshape(self.body.bounding_box(), (2, 3))
        counts = np.maximum(np.ceil((high - low) / self.step).astype(int), 1)
        x, y = np.meshgrid(*(low[axis] + self.step * (np.arange(counts[axis]) + 0.5) for axis in (0, 1)), indexing="ij")
        inside = np.zeros(counts, dtype=bool)
        for layer in range(counts[2]):
            section = self.body.slice(float(low[2] + self.step * (layer + 0.5)))
            rings = [shapely.Polygon(ring) for ring in section.to_polygons() if len(ring) > 2]
            for ring in rings:  # rings of holes turn the inside round
                inside[:, :, layer] ^= shapely.contains_xy(ring, x, y)
        return np.pad(inside.astype(np.int32), ((1, 0),) * 3).cumsum(0).cumsum(1).cumsum(2)

    def _fits(self, room: Cuboid, scale: float) -> Bool[np.ndarray, "x y z"]:
        """Places on a coarser grid at which the pocket has room in the body, scaled by a factor."""
        shape = tuple((count - 2) // _RULES.stride + 1 for count in self._sums.shape)
        found = np.zeros(shape, dtype=bool)
        for way in ways_to_turn(WinchRoom(low=room.low, high=room.high)):
            within, total = self._count(way, scale, 0.0, None)
            inside = within >= _RULES.min_inside * total
            for sign in (1.0, -1.0) if inside.any() else ():
                found |= inside & self._has_skin(way, scale, sign)
        return found

    def _has_skin(self, way: LyingWinch, scale: float, sign: float) -> Bool[np.ndarray, "x y z"]:
        """Places at which a pocket open to one half has foam on its other five sides."""
        outer, total = self._count(way, scale, MIN_SKIN, sign)
        straight, hole = self._count(way, scale, 0.0, sign)
        return outer - straight >= _RULES.min_cover * (total - hole)

    def _count(
        self, way: LyingWinch, scale: float, more: float, sign: float | None
    ) -> tuple[Int[np.ndarray, "x y z"], int]:
        """Cubes of the box that are in the body, with its middle at each place, and all cubes of the box.

        The box is larger by `more` [mm] on each side but the open one, which a sign along the pull gives.
        """
        ends = []
        for axis in range(3):
            half = (way.sides[axis] / 2 + self.clearance) / scale
            low = way.middle[axis] / scale - half - more / scale
            high = way.middle[axis] / scale + half + more / scale
            if axis == 2 and sign is not None:
                low, high = (low, high - more / scale) if sign > 0 else (low + more / scale, high)
            first = round(low / self.step + 0.5)
            ends.append((first, max(round(high / self.step + 0.5), first + 1)))
        total = int(np.prod([last - first for first, last in ends]))
        return self._count_between(ends), total

    def _count_between(self, ends: list[tuple[int, int]]) -> Int[np.ndarray, "x y z"]:
        """Cubes inside between two offsets along each axis, from each place of the coarser grid."""
        found: Int[np.ndarray, "x y z"] | int = 0
        picks = [
            [np.clip(np.arange(0, count - 1, _RULES.stride) + end, 0, count - 1) for end in pair]
            for count, pair in zip(self._sums.shape, ends, strict=True)
        ]
        for corner in _corners():
            sign = 1 if sum(corner) % 2 else -1
            found = found + sign * self._sums[np.ix_(*(pick[side] for pick, side in zip(picks, corner, strict=True)))]
        return np.asarray(found)

    @staticmethod
    def of_robot(robot: Robot, options: MoldOptions | None = None) -> "PocketRoom":
        """Find the room for pockets in a robot's body of foam (InputError: the body is not closed)."""
        setting = mold_setting(robot)
        clearance = (options or MoldOptions()).pocket_clearance
        return PocketRoom(setting.stance.enter(setting.solid), setting.stance, clearance)


def _corners() -> Iterator[Number3]:
    """The eight corners of a box, 0 for its low and 1 for its high side."""
    yield from ((a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1))


@dataclass(frozen=True, kw_only=True)
class _PocketRules:
    """Grid and shares of the search for pockets.

    Attributes:
        num_cubes: number of cubes along the longest side of the body.
        min_cube: minimum side of a cube [mm].
        stride: number of cubes between two places.
        min_inside: minimum share of the box in the body: the kit asks for 98 %, the rest is for the size of cubes.
        min_cover: minimum share of the foam around it that is there: the kit asks for 90 %.
    """

    num_cubes: int = 200
    min_cube: float = 0.8
    stride: int = 2
    min_inside: float = 0.985
    min_cover: float = 0.93


_RULES = _PocketRules()
