"""`Limb`: a soft limb along a curve, sections ellipses with their own back and belly; `Shape`: a body of limbs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from bodies.field import Field, Place, ellipsoidal
from hydrostat.arrays import Float, Int, Points, Vector
from hydrostat.geometry import Surface, contour


@dataclass(frozen=True, eq=False)
class Limb:
    """Finger, an arm, a trunk: sections across a spine."""

    spine: Float[np.ndarray, "stations 3"]  # stations from the root to the tip [m], (stations, 3)
    # unit vector across the limb at each station; back = direction of the spine x side
    sides: Float[np.ndarray, "stations 3"]
    breadths: Vector  # distance from the spine to the side [m], (stations,)
    backs: Vector  # distance from the spine to the back [m]
    bellies: Vector  # distance from the spine to the belly, the side to which the limb bends [m]
    caps: tuple[float, float]  # length of the rounded ends at root and tip [m]
    joints: Float[np.ndarray, "joints 3"]  # landmarks along the limb from root to tip [m], (joints, 3)

    @cached_property
    def stations(self) -> Vector:
        """Arc length of each station from the root [m]."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.spine, axis=0), axis=1))])

    @property
    def length(self) -> float:
        """Length of the spine [m]; the rounded ends come on top."""
        return float(self.stations[-1])

    @property
    def tip(self) -> Float[np.ndarray, " 3"]:
        """Outermost place at the tip [m]."""
        return self.spine[-1] + self.caps[1] * self._directions[-1]

    def at(self, share: float, across: float = 0.0, up: float = 0.0) -> tuple[float, float, float]:
        """Point in the limb [m]: a share of the spine from its root, and offsets from there.

        `across` counts half breadths, `up` half depths towards the back, negative towards the belly.
        """
        station = share * self.length
        side, back = self._frame(np.array([station]))
        depth = np.interp(station, self.stations, self.backs if up > 0 else self.bellies)
        breadth = np.interp(station, self.stations, self.breadths)
        middle = [np.interp(station, self.stations, column) for column in self.spine.T]
        x, y, z = middle + across * breadth * side[0] + up * depth * back[0]
        return float(x), float(y), float(z)

    def share_of(self, joint: int) -> float:
        """Share of the length at which a landmark lies."""
        segments, shares = self._feet(self.joints[[joint]])
        return float(self._stations_at(segments, shares)[0] / self.length)

    def distance(self, points: Points) -> Vector:
        """Approximate signed distance from the limb [m]; accurate close to its surface if it tapers gently."""
        segments, shares = self._feet(points)
        stations = self._stations_at(segments, shares)
        middles = np.stack([np.interp(stations, self.stations, column) for column in self.spine.T], axis=1)
        side, back = self._frame(stations)
        offset = points - middles
        along = np.where(stations > 0, offset @ self._directions[-1], -offset @ self._directions[0])
        ends = (stations <= 0) | (stations >= self.length)
        beyond = np.where(ends, np.maximum(along, 0.0), 0.0)
        up = (offset * back).sum(axis=1)
        depths = np.where(up > 0, *(np.interp(stations, self.stations, half) for half in (self.backs, self.bellies)))
        axes = np.stack(
            [np.interp(stations, self.stations, self.breadths), depths, np.where(stations > 0, *self.caps[::-1])],
            axis=1,
        )
        local = np.stack([(offset * side).sum(axis=1), up, beyond], axis=1) / axes
        return ellipsoidal(local, axes)

    @cached_property
    def _directions(self) -> Float[np.ndarray, "stations 3"]:
        """Unit direction of the spine at each station."""
        steps = np.diff(self.spine, axis=0)
        steps = steps / np.linalg.norm(steps, axis=1, keepdims=True)
        means = np.concatenate([steps[:1], steps[:-1] + steps[1:], steps[-1:]])
        return means / np.linalg.norm(means, axis=1, keepdims=True)

    def _frame(self, stations: Vector) -> tuple[Points, Points]:
        """Unit vectors to the side and to the back at stations."""
        side, way = (
            np.stack([np.interp(stations, self.stations, column) for column in vectors.T], axis=1)
            for vectors in (self.sides, self._directions)
        )
        way = way / np.linalg.norm(way, axis=1, keepdims=True)
        side = side - (side * way).sum(axis=1, keepdims=True) * way
        side = side / np.linalg.norm(side, axis=1, keepdims=True)
        return side, np.cross(way, side)

    def _feet(self, points: Points) -> tuple[Int[np.ndarray, " points"], Vector]:
        """Segment of the spine nearest to each point, and where on it, from 0 to 1."""
        best = np.full(len(points), np.inf)
        segments, shares = np.zeros(len(points), dtype=np.int64), np.zeros(len(points))
        for segment, (start, end) in enumerate(pairwise(self.spine)):
            axis = end - start
            share = np.clip((points - start) @ axis / (axis @ axis), 0.0, 1.0)
            away = ((points - start - share[:, None] * axis) ** 2).sum(axis=1)
            nearer = away < best
            best[nearer], segments[nearer], shares[nearer] = away[nearer], segment, share[nearer]
        return segments, shares

    def _stations_at(self, segments: Int[np.ndarray, " points"], shares: Vector) -> Vector:
        return self.stations[segments] + shares * np.diff(self.stations)[segments]


def limb(
    joints: Iterable[Place],
    *,
    side: Place,
    breadths: Sequence[float],
    backs: Sequence[float],
    bellies: Sequence[float] | None = None,
    caps: tuple[float, float] | None = None,
    bend: float = 8e-3,
) -> Limb:
    """Limb through joints [m], with its half breadth and depths given at each of them [m].

    Args:
        joints: landmarks from the root to the end of the spine [m].
        side: approximate direction across the limb; its component along the spine does not count.
        breadths: half the breadth at each joint.
        backs: depth of the back at each joint.
        bellies: depth of the belly; as the back if left out.
        caps: length of the rounded ends; as round as the belly if left out.
        bend: distance from a joint at which the spine leaves the straight line [m].
    """
    corners = np.array(list(joints), dtype=float)
    bellies = backs if bellies is None else bellies
    spine = _smooth(corners, bend)
    stations = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(spine, axis=0), axis=1))])
    at = [stations[np.argmin(((spine - corner) ** 2).sum(axis=1))] for corner in corners]
    # Imported here: only shapes need it.
    from scipy.interpolate import PchipInterpolator

    halves = [PchipInterpolator(at, half)(stations) for half in (breadths, backs, bellies)]
    return Limb(
        spine,
        np.tile(np.array(side, dtype=float), (len(spine), 1)),
        *halves,
        caps=(bellies[0], bellies[-1]) if caps is None else caps,
        joints=corners,
    )


def _smooth(corners: Float[np.ndarray, "joints 3"], bend: float) -> Float[np.ndarray, "stations 3"]:
    """Stations along a polyline whose corners are rounded by parabolas that begin `bend` [m] from them."""
    places = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:], strict=False):
        ways = [before - corner, after - corner]
        lengths = [float(np.linalg.norm(way)) for way in ways]
        start, end = (corner + min(bend / length, 0.45) * way for way, length in zip(ways, lengths, strict=True))
        places.extend(
            (1 - share) ** 2 * start + 2 * share * (1 - share) * corner + share**2 * end
            for share in np.linspace(0, 1, 5)
        )
    places.append(corners[-1])
    stations = [places[0]]
    spacing = 4e-3  # stations along the spine of a limb are about this far apart [m]
    for start, end in pairwise(places):
        count = max(round(float(np.linalg.norm(end - start)) / spacing), 1)
        stations.extend(start + share * (end - start) for share in np.arange(1, count + 1) / count)
    return np.array(stations)


@dataclass(frozen=True, eq=False)
class Shape:
    """Body in space."""

    field: Field  # approximate signed distance of points [m], negative inside
    box: Float[np.ndarray, "2 3"]  # lowest and highest coordinates that hold the whole body [m]
    limbs: Mapping[str, Limb]  # limbs by name; their landmarks are the joints

    def surface(self, spacing: float) -> Surface:
        """Closed surface, drawn on a grid [m]; details smaller than the spacing are lost.

        Raises SurfaceError: the spacing is not above 0, too fine for the memory or so coarse that nothing is left.
        """
        # Halved, for the distance from a flat section can change by more than the way, though by less than twice.
        return contour(lambda points: self.field(points) / 2, self.box, spacing, distance=True)
