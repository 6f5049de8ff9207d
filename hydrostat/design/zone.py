"""`Zone`: a part of the plane or of space, at rest."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite
from numbers import Real
from typing import NamedTuple, TypeGuard

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points
from hydrostat.design.polyline import least_along
from hydrostat.errors import InputError
from hydrostat.given import Point


@dataclass(frozen=True, kw_only=True)
class Zone:
    """Zone: a disc or ball, a box, or a polygon in the plane [m].

    Attributes:
        at: center of the disc or ball.
        radius: radius of the zone [m].
        box: lowest and highest corner of the box.
        outline: corners of the polygon, in either direction.

    Raises:
        InputError: not exactly one of these, or an invalid shape.
    """

    at: Point | None = None
    radius: float | None = None
    box: tuple[Point, Point] | None = None
    outline: tuple[Point, ...] = ()

    def __post_init__(self) -> None:
        ball, box = self.at is not None or self.radius is not None, self.box is not None
        polygon = self.outline != ()
        if ball + box + polygon != 1:
            raise InputError("a zone is given by at and radius, by box, or by outline, and by one of these only")
        if ball:
            _check_ball(self.at, self.radius)
        elif box:
            _check_box(self.box)
        else:
            _check_outline(self.outline)

    @property
    def dim(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.at if self.at is not None else self.box[0] if self.box is not None else self.outline[0])

    def distances(self, points: Points) -> Float[np.ndarray, " points"]:
        """Return the distance of points from the border of the zone [m]; negative inside."""
        return self._measure(points)[0]

    def away(self, points: Points) -> Float[np.ndarray, "points dim"]:
        """Return the gradient of `distances` at points, as unit vectors."""
        return self._measure(points)[1]

    def least(
        self,
        starts: Float[np.ndarray, "segments dim"],
        ends: Float[np.ndarray, "segments dim"],
        *,
        limit: float = 0.0,
        resolution: float = 1e-4,
    ) -> Float[np.ndarray, " segments"]:
        """Return the least of `distances` along each straight segment [m], if it is below a limit (`least_along`)."""
        return least_along(self.distances, starts, ends, limit, resolution=resolution)

    def _measure(self, points: Points) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "points dim"]]:
        if self.at is not None and self.radius is not None:
            offsets = points - np.array(self.at)
            lengths = np.linalg.norm(offsets, axis=1)
            return lengths - self.radius, _units(offsets, np.eye(self.dim)[0])
        if self.box is not None:
            return _from_box(points, *np.array(self.box, dtype=float))
        return self._from_outline(points)

    def _from_outline(self, points: Points) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "points 2"]]:
        starts, ends, outward = self._sides
        return _Sides(starts, ends, outward, np.zeros(len(starts), dtype=np.int64)).measure(points)

    @cached_property
    def _sides(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """First and last point of each side, and its normal outward."""
        starts = np.array(self.outline, dtype=float)
        ends = np.roll(starts, -1, axis=0)
        turned = (starts[:, 0] * ends[:, 1] - ends[:, 0] * starts[:, 1]).sum()
        along = (ends - starts) * np.sign(turned)
        normals = np.column_stack([along[:, 1], -along[:, 0]])
        return starts, ends, normals / np.linalg.norm(normals, axis=1, keepdims=True)

    def move(self, move: Callable[[Point], Point]) -> "Zone":
        """Return the zone with its points moved."""
        at = None if self.at is None else move(self.at)
        box = None if self.box is None else (move(self.box[0]), move(self.box[1]))
        return replace(self, at=at, box=box, outline=tuple(map(move, self.outline)))


class _Sides(NamedTuple):
    """Sides of polygons: first and last points, normals outward, and number of the polygon, which rises."""

    starts: Points
    ends: Points
    outward: Points
    owner: Int[np.ndarray, " sides"]

    def measure(self, points: Points) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "points 2"]]:
        """Distance of points from the nearest polygon [m], negative inside, and its gradient."""
        along = self.ends - self.starts
        shares = np.einsum("psd,sd->ps", points[:, None] - self.starts, along) / (along**2).sum(axis=1)
        offsets = points[:, None] - (self.starts + np.clip(shares, 0.0, 1.0)[..., None] * along)
        lengths = np.linalg.norm(offsets, axis=2)
        begins = np.flatnonzero(np.append(True, self.owner[1:] != self.owner[:-1]))
        signs = np.where(self._inside(points, begins), -1.0, 1.0)
        nearest = (signs * np.minimum.reduceat(lengths, begins, axis=1)).argmin(axis=1)
        side = np.where(self.owner == nearest[:, None], lengths, np.inf).argmin(axis=1)
        rows = np.arange(len(points))
        sign = signs[rows, nearest]
        return sign * lengths[rows, side], _units(sign[:, None] * offsets[rows, side], self.outward[side])

    def _inside(self, points: Points, begins: Int[np.ndarray, " polygons"]) -> Bool[np.ndarray, "points polygons"]:
        """True in each polygon whose outline a ray to the right crosses an odd number of times."""
        starts, ends = self.starts, self.ends
        above = starts[:, 1] > points[:, None, 1]
        crosses = above != (ends[:, 1] > points[:, None, 1])
        rise = np.where(ends[:, 1] == starts[:, 1], 1.0, ends[:, 1] - starts[:, 1])
        where = starts[:, 0] + (points[:, None, 1] - starts[:, 1]) * (ends[:, 0] - starts[:, 0]) / rise
        return np.add.reduceat((crosses & (points[:, None, 0] < where)).astype(np.int64), begins, axis=1) % 2 == 1


@dataclass(frozen=True, eq=False)
class ZoneUnion:
    """Several zones together."""

    zones: tuple[Zone, ...]

    def measure(self, points: Points) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "points dim"]]:
        """Distance of points from the nearest zone [m], negative inside, and unit vectors in which it grows fastest."""
        if self._polygons is not None:
            return self._polygons.measure(points)
        distances, ways = zip(*(zone._measure(points) for zone in self.zones), strict=True)
        nearest, rows = np.argmin(distances, axis=0), np.arange(len(points))
        return np.array(distances)[nearest, rows], np.array(ways)[nearest, rows]

    @cached_property
    def _polygons(self) -> "_Sides | None":
        """Sides of all polygons; None if a zone is none."""
        if not all(zone.outline for zone in self.zones):
            return None
        parts = [zone._sides for zone in self.zones]
        counts = [len(zone.outline) for zone in self.zones]
        starts, ends, outward = (np.concatenate(part) for part in zip(*parts, strict=True))
        return _Sides(starts, ends, outward, np.repeat(np.arange(len(counts)), counts))


def _from_box(
    points: Points, low: Float[np.ndarray, " dim"], high: Float[np.ndarray, " dim"]
) -> tuple[Float[np.ndarray, " points"], Float[np.ndarray, "points dim"]]:
    """Distances from a box, negative inside, and their gradients."""
    beyond = np.maximum(low - points, points - high)
    axis, rows = beyond.argmax(axis=1), np.arange(len(points))
    sides = np.zeros(points.shape)
    sides[rows, axis] = np.where((points - high)[rows, axis] >= (low - points)[rows, axis], 1.0, -1.0)
    outside = points - np.clip(points, low, high)
    lengths = np.linalg.norm(outside, axis=1)
    is_out = lengths > 0
    directions = np.where(is_out[:, None], outside / np.where(is_out, lengths, 1.0)[:, None], sides)
    return np.where(is_out, lengths, beyond[rows, axis]), directions


def _units(vectors: Float[np.ndarray, "points dim"], otherwise: np.ndarray) -> Float[np.ndarray, "points dim"]:
    """Unit vectors, or something else where there is no direction."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.where(lengths > 1e-12, lengths, 1.0), otherwise)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)


MAX_DISTANCE = 20.0
"""No zone is farther from the origin, or larger [m]: more was meant in another unit."""


def _check_corner(name: str, corner: object) -> None:
    if not isinstance(corner, tuple | list) or len(corner) not in (2, 3) or not all(map(_is_number, corner)):
        raise InputError(f"{name} of a zone must be two or three finite coordinates [m], not {corner!r:.60}")
    if max(map(abs, corner)) > MAX_DISTANCE:
        raise InputError(f"{name} of a zone is in meters, at most {MAX_DISTANCE:g}, not {corner!r:.60}; 30 mm is 0.03")


def _check_ball(at: object, radius: object) -> None:
    if at is None or radius is None:
        raise InputError("a zone about a point needs both at and radius; give the other too")
    _check_corner("at", at)
    if not (_is_number(radius) and radius > 0):
        raise InputError(f"radius of a zone must be finite and above 0 m, not {radius!r:.60}")
    if radius > MAX_DISTANCE:
        raise InputError(f"radius of a zone is in meters, at most {MAX_DISTANCE:g}, not {radius:g}; 8 mm is 0.008")


def _check_box(box: object) -> None:
    if not isinstance(box, tuple | list) or len(box) != 2:
        raise InputError(f"box of a zone must be two corners, the lowest and the highest, not {box!r:.60}")
    for place, corner in enumerate(box):
        _check_corner(f"box[{place}]", corner)
    if len(box[0]) != len(box[1]):
        raise InputError("box of a zone: its two corners must have equally many coordinates")
    for axis, low, high in zip("xyz", *box, strict=False):
        if not low < high:
            raise InputError(
                f"box of a zone: {axis} of the first corner, {low:g} m, must be below that of the second, {high:g} m"
            )


def _check_outline(outline: object) -> None:
    from shapely import Polygon, is_valid_reason

    if not isinstance(outline, tuple | list) or len(outline) < 3:
        raise InputError(f"outline of a zone must be at least 3 corners, not {outline!r:.60}")
    for place, corner in enumerate(outline):
        _check_corner(f"outline[{place}]", corner)
        if len(corner) != 2:
            raise InputError(f"outline[{place}] of a zone has {len(corner)} coordinates; a polygon lies in the plane")
        if tuple(corner) == tuple(outline[place - 1]):
            raise InputError(f"outline[{place}] of a zone is the same as the corner before it; remove one of them")
    polygon = Polygon(outline)
    if not polygon.is_valid or not polygon.area > 0:
        fault = is_valid_reason(polygon).lower()
        raise InputError(f"outline of a zone must not touch or cross itself ({fault}); put its corners in order")
