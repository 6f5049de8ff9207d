"""Labels of a panel: cable numbers, names, the grain of the cloth, each where there is room."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import shapely
from shapely import LineString, Point, Polygon, box, transform
from shapely.geometry.base import BaseGeometry

from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patterns.lettering import Lettering
from hydrostat.fabrication.patterns.marks import place
from hydrostat.fabrication.patterns.opening import Opening
from hydrostat.fabrication.patterns.shape import LaserLine, Layer, PatternPart, Place, Shape
from hydrostat.fabrication.patterns.stitches import CableStitches
from hydrostat.fabrication.winch_marks import marked_name
from hydrostat.robot import Robot

_CLEARANCE = 1.2  # empty cloth kept round whatever is placed [mm]
_ROOMY = 6.0  # empty cloth beyond which more is no better [mm]


class FreeSpace:
    """Room that is still empty inside an outline. Whatever is placed takes its room."""

    def __init__(self, inside: Polygon, shapes: Iterable[Shape]) -> None:
        self._inside = inside
        lines = [shapely.get_coordinates(shape.geometry) for shape in shapes]
        pairs = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
        self._taken: list[BaseGeometry] = np.asarray(shapely.linestrings(pairs), dtype=object).tolist()
        self._texts: list[BaseGeometry] = []
        shapely.prepare(inside)

    def beside(self, at: Place, width: float, height: float, *, gap: float) -> Place:
        """Middle of a box as near to a place as there is room, else where it crosses the least [mm]."""
        centers = _round(at, width, height, gap + np.arange(0, 14, 1.5))
        crossings = self._crossings(centers, _boxes(centers, width, height))
        leaders = np.asarray(shapely.linestrings(np.stack([np.broadcast_to(at, centers.shape), centers], axis=1)))
        through_text = 3  # so is a line to a label through another, for so many
        crossings += through_text * _hits(self._texts, leaders)
        x, y = centers[np.argmin(crossings)].tolist()
        return x, y

    def clear_beside(self, at: Place, width: float, height: float, *, gap: float) -> Place | None:
        """Middle of a box near to a place that crosses nothing [mm]; None if there is none."""
        centers = _round(at, width, height, gap + np.arange(0, 2.5, 0.5))
        tight = 1.05  # empty cloth kept round the small figures at holes [mm]
        crossings = self._crossings(centers, _boxes(centers, width, height, tight))
        if crossings.min():
            return None
        x, y = centers[np.argmin(crossings)].tolist()
        return x, y

    def anywhere(self, width: float, height: float) -> Place | None:
        """Middle of a box with most room, preferably near the middle of the panel [mm]; None if there is none."""
        left, bottom, right, top = self._inside.bounds
        x, y = np.meshgrid(np.arange(left, right, 3.0), np.arange(bottom, top, 3.0))
        centers = np.column_stack([x.ravel(), y.ravel()])
        centers = centers[shapely.contains_xy(self._inside, centers)]
        boxes = _boxes(centers, width, height)
        free = self._crossings(centers, boxes) == 0
        if not free.any():
            return None
        centers, boxes, middle = centers[free], boxes[free], self._inside.centroid
        far = np.hypot(centers[:, 0] - middle.x, centers[:, 1] - middle.y)
        x, y = centers[np.argmax(self._room(boxes) - 0.05 * far)].tolist()
        return x, y

    def take(self, middle: Place, width: float, height: float) -> None:
        """Keep what is placed later off a box."""
        box = _boxes(np.array([middle]), width, height)
        self._taken.extend(box)
        self._texts.extend(box)

    def take_line(self, line: LaserLine) -> None:
        """Keep what is placed later off a line to a label."""
        self._taken.append(line.geometry)

    def _crossings(self, centers: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        """Weighted number of objects that each box overlaps; another label weighs more, and a box outside most."""
        outside = ~shapely.contains_xy(self._inside, centers)
        over_text = 10  # a label over another is as bad as one over so many more lines
        return _hits(self._taken, boxes) + over_text * _hits(self._texts, boxes) + 1000 * outside

    def _room(self, boxes: np.ndarray) -> np.ndarray:
        """Distance from each box to what is next to it, up to `_ROOMY` [mm]."""
        room = np.full(len(boxes), _ROOMY)
        found, distances = shapely.STRtree(self._taken).query_nearest(
            boxes, max_distance=_ROOMY, return_distance=True, all_matches=False
        )
        room[found[0]] = distances
        return room


def _round(at: Place, width: float, height: float, gaps: np.ndarray) -> np.ndarray:
    """Middles of boxes in 16 directions about a place, at some gaps from it [mm]."""
    reach, angle = np.meshgrid(gaps, np.arange(0, 2 * np.pi, np.pi / 8), indexing="ij")
    x = at[0] + np.cos(angle) * (reach + width / 2)
    y = at[1] + np.sin(angle) * (reach + height / 2)
    return np.column_stack([x.ravel(), y.ravel()])


def _hits(taken: list[BaseGeometry], geometries: np.ndarray) -> np.ndarray:
    """Number of taken geometries that each geometry intersects."""
    found = shapely.STRtree(taken).query(geometries, predicate="intersects")[0]
    return np.bincount(found, minlength=len(geometries))


def _boxes(centers: np.ndarray, width: float, height: float, clearance: float = _CLEARANCE) -> np.ndarray:
    half = np.array([width / 2 + clearance, height / 2 + clearance])
    low, high = centers - half, centers + half
    return shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])


_NAMES = (4.0, 3.0)
_TITLES = (8.0, 6.0, 5.0, 4.0)  # heights of letters, the best first [mm]
_LETTER = 3.0  # height of the letter at a notch [mm]
_MAX_LABEL_DISTANCE = 4.0  # maximum distance of a label without a line to its place [mm]


class PanelLabels:
    """Puts labels on one panel; those that belong to a place come first, those that fit anywhere last.

    The seam is given as seen from the front; the shapes already on the panel, and the labels, are as they lie on it.
    """

    def __init__(self, seam: Polygon, shapes: tuple[Shape, ...], *, mirrored: bool) -> None:
        mirror = transform(seam, lambda points: points * [-1, 1])
        self._space = FreeSpace(mirror if mirrored else seam, shapes)
        self._seam = seam
        self._mirrored = mirrored
        self._shapes: list[Shape] = []

    def shapes(self) -> tuple[Shape, ...]:
        """All that was written so far."""
        return tuple(self._shapes)

    def cable_numbers(self, robot: Robot, *, first: int = 1) -> None:
        """Label cables C1, C2, ... from the first on, next to their stoppers and their exits from the winches."""
        for number, cable in enumerate(robot.cables, start=first):
            self.cable_name(number, place(cable.points[-1]))
        along = 15.0  # distance of a cable's number from its winch [mm]
        for number, cable in enumerate(robot.cables, start=first):
            begin = LineString([place(point) for point in cable.points[:2]]).intersection(self._seam)
            if not begin.is_empty:
                near = begin.interpolate(min(along, begin.length / 2))
                self._beside(f"C{number}", (near.x, near.y), gap=2.5)

    def cable_name(self, cable: int, at: Place) -> None:
        """Put a cable's number C1, C2, ... next to a place."""
        self._beside(f"C{cable}", at, gap=4.5)

    def winch_names(self, robot: Robot) -> None:
        """Label each winch with its mark and name."""
        for winch in robot.winches:
            if self._seam.contains(Point(place(winch.at))):
                self._beside(
                    marked_name(robot, winch.name), place(winch.at), gap=1e3 * robot.largest_spool(winch) + 1.5
                )

    def hole_numbers(self, stitches: Iterable[CableStitches]) -> None:
        """Number the holes of each cable in small figures, from 2 on, in stitch order, if there is room."""
        for sewn in stitches:
            for stitch in sewn.stitches[1:]:
                if self._seam.contains(Point(stitch.place)):
                    self.figure(f"{stitch.number}", stitch.place)

    def figure(self, text: str, at: Place) -> None:
        """Put a small number next to a hole if there is room."""
        at = (-at[0], at[1]) if self._mirrored else at
        figure = 2.5  # height of the figure at a hole [mm], the least that a laser writes on felt
        letters = Lettering(text, figure)
        figure_gap = 2.2  # from the middle of a hole to its figure [mm]
        middle = self._space.clear_beside(at, letters.width, figure, gap=figure_gap)
        if middle is not None:
            self._write(letters, middle)

    def notch_names(self, strokes: Iterable[tuple[str, LineString]], cloth: Polygon) -> None:
        """Label each notch with its letter, in the seam allowance if it is wide enough."""
        for name, stroke in strokes:
            letter = Lettering(name, _LETTER)
            if not name or stroke.length < _LETTER + 2:
                continue
            (x, y), (end_x, end_y) = stroke.coords
            along = np.array([end_y - y, x - end_x]) / stroke.length
            middles = [
                (float((x + end_x) / 2 + side * along[0]), float((y + end_y) / 2 + side * along[1]))
                for side in (-2.2 - letter.width / 2, 2.2 + letter.width / 2)
            ]
            free = cloth.difference(self._seam)
            best = max(middles, key=lambda middle: round(free.intersection(_letter_box(middle, letter)).area, 3))
            lines = letter.lines((-best[0], best[1]) if self._mirrored else best)
            self._shapes.extend(replace(line, layer=Layer.MARK) for line in lines)  # the seam hides them

    def edge_names(self, upper: str, lower: str) -> None:
        """Write along the edges of a strip what the upper and the lower are sewn to."""
        left, bottom, right, top = self._seam.bounds
        for text, y in ((upper, top - 4.0), (lower, bottom + 4.0)):
            letters = Lettering(text, _NAMES[-1])
            if top - bottom > 16 and letters.width < right - left:
                self._write(letters, ((left + right) / 2, y))

    def marker_names(self, robot: Robot, options: PatternOptions) -> None:
        """Label each marker with its name."""
        for marker in robot.markers if options.marker_names else ():
            self._beside(marker.name, place(marker.at), gap=3.5)

    def opening(self, opening: Opening) -> None:
        """Label the opening with its zipper."""
        middle = opening.slit.interpolate(0.5, normalized=True)
        self._beside(opening.label, (middle.x, middle.y), gap=6.5)

    def has_room(self, text: str) -> bool:
        """Return True if a title fits somewhere on the panel."""
        letters = Lettering(text, _TITLES[-1])
        return self._space.anywhere(letters.width, letters.height) is not None

    def title(self, text: str, *shorter: str) -> None:
        """The name of the panel, as large as there is room for; a shorter one where it has no room."""
        for words in (text, *shorter):
            for height in _TITLES:
                lettering = Lettering(words, height)
                middle = self._space.anywhere(lettering.width, height)
                if middle is not None:
                    self._write(lettering, middle)
                    return
        middle = self._seam.representative_point()
        self._beside((text, *shorter)[-1], (middle.x, middle.y), gap=0.0)

    def grain(self) -> None:
        """An arrow along the grain of the cloth, parallel to the y axis of the drawing."""
        grains = (40.0, 25.0, 15.0)  # lengths of the arrow, the best first [mm]
        for length in grains:
            middle = self._space.anywhere(4.0, length)
            if middle is not None:
                self._shapes.extend(_arrow(middle, length))
                return

    def _write(self, letters: Lettering, middle: Place) -> None:
        """Letters in a place, which what is placed later keeps off."""
        self._shapes.extend(letters.lines(middle))
        self._space.take(middle, letters.width, letters.height)

    def _beside(self, text: str, at: Place, *, gap: float) -> None:
        """Text as near to a place as there is room, smaller where it is crowded; led to it by a line from afar."""
        at = (-at[0], at[1]) if self._mirrored else at
        choices = []
        for height in _NAMES:
            lettering = Lettering(text, height)
            middle = self._space.beside(at, lettering.width, height, gap=gap)
            choices.append((lettering, middle, _to_label(at, middle, lettering)))
        near = (choice for choice in choices if np.linalg.norm(choice[2]) < gap + _MAX_LABEL_DISTANCE)
        lettering, middle, way = next(near, choices[-1])
        self._write(lettering, middle)
        if np.linalg.norm(way) >= gap + _MAX_LABEL_DISTANCE:
            leader = _leader(at, way, gap)
            self._shapes.append(leader)
            self._space.take_line(leader)


def _letter_box(middle: Place, letter: Lettering) -> Polygon:
    """The box of a text."""
    x, y = middle
    return box(x - letter.width / 2, y - letter.height / 2, x + letter.width / 2, y + letter.height / 2)


def _to_label(at: Place, middle: Place, lettering: Lettering) -> np.ndarray:
    """Way from a place to the nearest point of its label [mm]."""
    half = np.array([lettering.width, lettering.height]) / 2
    offset = np.subtract(middle, at)
    return np.sign(offset) * np.maximum(np.abs(offset) - half, 0.0)


def _leader(at: Place, way: np.ndarray, gap: float) -> LaserLine:
    """A thin line from a place, a gap off, almost to its label."""
    length = np.linalg.norm(way)
    ends = [np.add(at, way * (distance / length)) for distance in (gap - 1.5, length - 1.0)]
    points = tuple((float(x), float(y)) for x, y in ends)
    return LaserLine(layer=Layer.GUIDE, part=PatternPart.LEADER, points=points)


def _arrow(middle: Place, length: float) -> tuple[LaserLine, ...]:
    """A line with a head at both ends."""
    x, y = middle
    low, high = y - length / 2, y + length / 2
    strokes = (
        ((x, low), (x, high)),
        ((x - 2, high - 4), (x, high), (x + 2, high - 4)),
        ((x - 2, low + 4), (x, low), (x + 2, low + 4)),
    )
    return tuple(LaserLine(layer=Layer.GUIDE, part=PatternPart.GRAIN, points=points) for points in strokes)
