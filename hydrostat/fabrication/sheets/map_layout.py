"""Contents of a map: the shape of a body, its best views, the visible side of cables, free places for labels."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Self

import numpy as np
import shapely

from hydrostat.arrays import Bool, Float
from hydrostat.drawing import Box, Camera, DepthBuffer, DrawnSolid, Spot
from hydrostat.robot import Pin, Robot

_TURNS = tuple(range(0, 360, 30))  # compass directions that are tried [degrees]


@dataclass(frozen=True, eq=False)
class Visibility:
    """The near and the far side of a body."""

    front: DepthBuffer  # depths of the near side
    back: DepthBuffer  # depths of the far side, as seen from there: x and depth change their sign

    @classmethod
    def of(cls, body: DrawnSolid, camera: Camera) -> Self:
        """Look at a body."""
        seen = camera.see(body.vertices)[body.triangles]
        nothing = np.empty((len(seen), 3, 0))
        turned = seen * np.array([1.0, 1.0, -1.0])
        coarse = 160  # pixels along a body: enough to know its near and its far side
        return cls(*(DepthBuffer.of(corners, nothing, pixels=coarse) for corners in (seen, turned)))

    def in_front(self, seen: Float[np.ndarray, "points 3"]) -> Bool[np.ndarray, " points"]:
        """Return True for each point in the near half of the body, in front of it, or next to it."""
        before = -self.front.behind(seen)
        after = -self.back.behind(seen * np.array([1.0, 1.0, -1.0]))
        return ~((before > 0) & (before > after))


def best_views(robot: Robot, body: DrawnSolid) -> tuple[Camera, ...]:
    """Three views: from where most of the cables lie in front, and then from where most of the others do."""
    cables = [1e3 * np.array(cable.points)[1:] for cable in robot.cables]
    points = np.concatenate([(way[:-1] + way[1:]) / 2 for way in cables if len(way) > 1] or [np.zeros((1, 3))])
    rises = (15.0, 40.0)  # heights over the horizon that are tried [degrees]
    views = [Camera.at(float(turn), rise) for rise in rises for turn in _TURNS]
    seen = np.array([Visibility.of(body, view).in_front(view.see(points)) for view in views], dtype=float)
    # Of views that are as good, the one that shows most of the body, then the first.
    areas = np.array([np.prod(np.ptp(view.see(body.vertices)[:, :2], axis=0)) for view in views])
    chosen = [int(np.argmax(seen.mean(axis=1) + 0.4 * areas / areas.max()))]
    rest = seen
    for apart_counts in (0.1, 0.4):
        rest = rest * (1 - seen[chosen[-1]])
        apart = np.min([_apart(views, views[other]) for other in chosen], axis=0)
        worth = rest.mean(axis=1) + 0.3 * areas / areas.max() + apart_counts * np.minimum(apart, 1.0)
        chosen.append(int(np.argmax(worth)))
    return tuple(views[index] for index in chosen)


def _apart(views: list[Camera], one: Camera) -> Float[np.ndarray, " views"]:
    """Distance of views from one of them: 0 for itself, 1 for a right angle, 2 for the opposite."""
    return np.array([1 - float(view.axes[2] @ one.axes[2]) for view in views])


def flat_marks(robot: Robot) -> list[Float[np.ndarray, "_ 2"]]:
    """Lines drawn on a flat body, such as eyes, that mark its front [mm]."""
    return [1e3 * np.array(mark) for mark in robot.body.marks]


def flat_rings(robot: Robot) -> list[Float[np.ndarray, "_ 2"]]:
    """The outline of a flat body and its holes [m]; of a ready mesh, the rim of its triangles."""
    if robot.body.outline is not None:
        return list(robot.body.outline.rings)
    mesh = robot.body.mesh
    whole = shapely.union_all(shapely.polygons(mesh.nodes[mesh.elements]))
    polygons = [part for part in shapely.get_parts(whole) if isinstance(part, shapely.Polygon)]
    return [np.array(ring.coords)[:-1] for part in polygons for ring in (part.exterior, *part.interiors)]


def body_solid(robot: Robot) -> DrawnSolid:
    """The surface of a body in space [mm]."""
    sharp = 70.0  # on a body, edges are drawn that are sharper than this [degrees]: scans are rough
    if robot.body.healing is not None:
        surface = robot.body.healing.surface
        return DrawnSolid(vertices=1e3 * surface.vertices, triangles=surface.triangles, sharp=sharp)
    mesh = robot.body.mesh
    # Not `mesh.boundary`, whose order of corners would move the last digits of written sheets.
    faces = mesh.elements[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
    _, first, counts = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return DrawnSolid(vertices=1e3 * mesh.nodes, triangles=faces[np.sort(first[counts == 1])], sharp=sharp)


_WAYS = [(np.cos(turn), np.sin(turn)) for turn in np.radians(np.arange(0, 360, 30))]
"""Directions that are tried, to the right first."""

_RINGS = (0.0, 1.5, 3.5, 6.0, 9.0, 12.0)  # additional distances of a label, tried in turn [mm]


@dataclass
class LabelPlaces:
    """Occupied and free places of a picture."""

    room: Box  # nothing is put beyond it
    _points: list[np.ndarray] = field(default_factory=list)
    _boxes: list[Box] = field(default_factory=list)

    def take_line(self, way: Sequence[Spot], *, weight: int = 1) -> None:
        """A line is there: labels avoid it where they can, the more the heavier it is."""
        spots = np.array(way, dtype=float)
        step = 0.5  # between points that stand for a line [mm]
        for start, end in pairwise(spots):
            count = max(int(np.hypot(*(end - start)) / step), 1) + 1
            self._points += weight * [start + np.linspace(0, 1, count)[:, None] * (end - start)]

    def take_box(self, box: Box) -> None:
        """Something is there that no label may cover."""
        self._boxes.append(box)

    def beside(
        self, at: Spot, size: tuple[float, float], *, gap: float, most: int = 1000, rings: int = 4, led: bool = False
    ) -> Spot | None:
        """The middle of the best free place for a box near a spot, which is then taken; None if none is free.

        The box has this size and is a gap away [mm]; it may cover `most` points of lines; so many rings of places are
        tried. With `led` the line from the spot to the box crosses other boxes only if no place is without.
        """
        best, least = None, float("inf")
        points = self._points_about(at, gap + _RINGS[-1] + max(size))
        for ring, further in enumerate(_RINGS[:rings]):
            for turn, (x, y) in enumerate(_WAYS):
                reach = gap + further
                middle = (at[0] + x * (reach + size[0] / 2), at[1] + y * (reach + size[1] / 2))
                box = _round(middle, size, 0.15)
                if not self._free(box):
                    continue
                covered = int(_within(points, box).sum())
                price = covered + 2.5 * ring + 0.01 * turn
                if covered > most or price >= least:
                    continue
                price += 10 * self._measure_crossings(at, middle) if led else 0
                if price < least:
                    best, least = middle, price
        if best is not None:
            self.take_box(_round(best, size, 0.15))
        return best

    def lead(self, middle: Spot, size: tuple[float, float], spot: Spot) -> list[Spot]:
        """The line from the edge of a label to its spot, which later labels avoid."""
        way = np.subtract(spot, middle)
        share = min(0.5 * side / max(abs(step), 1e-9) for side, step in zip(size, way.tolist(), strict=True))
        x, y = np.add(middle, min(share, 1.0) * way).tolist()
        self.take_line([(x, y), spot], weight=4)
        return [(x, y), spot]

    def _points_about(self, at: Spot, reach: float) -> np.ndarray:
        """The points of lines that a label near a spot could cover."""
        if len(self._points) > 1:
            self._points = [np.concatenate(self._points)]
        points = self._points[0] if self._points else np.zeros((0, 2))
        return points[_within(points, (at[0] - reach, at[1] - reach, at[0] + reach, at[1] + reach))]

    def _measure_crossings(self, at: Spot, middle: Spot) -> float:
        """Sum the widths [mm] of boxes that a line between two spots crosses, without those at its first spot."""
        if not self._boxes:
            return 0.0
        x, y = (np.array(at) + np.linspace(0, 1, 40)[:, None] * np.subtract(middle, at)).T
        left, top, right, bottom = (side[:, None] for side in np.array(self._boxes).T)
        within = (x > left) & (x < right) & (y > top) & (y < bottom)
        crossed = within.any(axis=1) & ~within[:, 0]
        return sum(self._boxes[index][2] - self._boxes[index][0] for index in np.flatnonzero(crossed))

    def _free(self, box: Box) -> bool:
        left, top, right, bottom = self.room
        if box[0] < left or box[1] < top or box[2] > right or box[3] > bottom:
            return False
        return not any(
            box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3] for other in self._boxes
        )


def pin_ring(pin: Pin) -> Float[np.ndarray, "_ 2"]:
    """Outline of the region that a pin of a flat body holds [mm]."""
    if pin.box is not None:
        (x, y, *_), (right, high, *_) = pin.box
        return 1e3 * np.array([(x, y), (right, y), (right, high), (x, high)])
    turns = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    circle = max(pin.radius, 1e-3) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return 1e3 * (np.array(pin.at)[:2] + circle)


def box_round(middle: Spot, radius: float) -> Box:
    """The square round a circle [mm]."""
    return _round(middle, (2 * radius, 2 * radius), 0.0)


def _round(middle: Spot, size: tuple[float, float], more: float) -> Box:
    wide, high = size[0] / 2 + more, size[1] / 2 + more
    return middle[0] - wide, middle[1] - high, middle[0] + wide, middle[1] + high


def _within(points: np.ndarray, box: Box) -> np.ndarray:
    x, y = points.T
    return (x > box[0]) & (x < box[2]) & (y > box[1]) & (y < box[3])
