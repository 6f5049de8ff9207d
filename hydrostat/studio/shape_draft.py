"""`ShapeDraft`: a disc, a box or a polygon that a person draws on the body."""

import math
from enum import StrEnum

from hydrostat.design import Zone
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.studio.document import Document
from hydrostat.studio.stage import SAME_CLICK
from hydrostat.studio.view.scene_items import Area, Dot, Look, SceneItem, Strand, Stroke

MIN_SHAPE = 0.015  # the smallest radius or half side of what is drawn, as a share of the body


class Form(StrEnum):
    """Shape that a drag makes."""

    DISC = "disc"  # from the center outward; a ball in space
    BOX = "box"  # from corner to corner
    FREE = "free"  # inside a line


def disc(middle: Point, rim: Point, size: float) -> Zone:
    """A disc or ball from its middle to a point on its rim, not too small for a body of some size [m]."""
    return Zone(at=middle, radius=max(math.dist(middle, rim), MIN_SHAPE * size))


def box(one: Point, other: Point, size: float) -> Zone:
    """A box between two corners, not too small for a body of some size [m]."""
    low, high = (tuple(map(end, one, other)) for end in (min, max))
    return Zone(box=(low, tuple(max(b, a + MIN_SHAPE * size) for a, b in zip(low, high, strict=True))))


def lasso(points: tuple[Point, ...], size: float) -> Zone:
    """The polygon of a line drawn by hand; its largest part where it crosses itself (InputError: it has none)."""
    from shapely import Polygon, make_valid
    from shapely.geometry.base import BaseMultipartGeometry

    whole = make_valid(Polygon(points)) if len(points) >= 3 else Polygon()
    parts = whole.geoms if isinstance(whole, BaseMultipartGeometry) else [whole]
    polygons = [part for part in parts if isinstance(part, Polygon) and not part.is_empty]
    if not polygons or max(part.area for part in polygons) < (MIN_SHAPE * size) ** 2:
        raise InputError("the line encloses no area. Draw it around a part of the body")
    coarse = 0.006  # a line drawn by hand is made this much simpler, as a share of the body
    largest = max(polygons, key=lambda part: part.area).exterior.simplify(coarse * size)
    return Zone(outline=tuple((float(x), float(y)) for x, y in list(largest.coords)[:-1]))


def zone_area(zone: Zone, *, key: str, color: str, label: str, chosen: bool) -> Area:
    """A zone as it is shown."""
    given = {"key": key, "color": color, "label": label, "chosen": chosen}
    if zone.at is not None and zone.radius is not None:
        return Area(at=zone.at, radius=zone.radius, **given)
    outline = zone.outline
    if zone.box is not None and zone.dim == 2:
        (left, low), (right, high) = zone.box
        outline = ((left, low), (right, low), (right, high), (left, high))
    return Area(outline=outline, **given)


class ShapeDraft:
    """Draws a zone: a drag makes a disc (in space a ball), a box or a line around a part; clicks set corners."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self.clear()

    def clear(self) -> None:
        """Drop what was begun."""
        self.zone: Zone | None = None  # disc or box as it is now
        self.corners: tuple[Point, ...] = ()  # that clicks have set [m]
        self._line: tuple[Point, ...] = ()
        self._start: Point | None = None
        self._form = Form.DISC

    def begin(self, place: Point, form: Form) -> None:
        """Begin a drag at a place of the body [m]."""
        self.clear()
        self._form, self._start = form if self._flat else Form.DISC, place
        self._line = (place,) if self._form is Form.FREE else ()

    def drag(self, place: Point) -> None:
        """Draw on to a place [m]."""
        if self._line:
            self._line = (*self._line, place)
        elif self._start is not None:
            self.zone = (box if self._form is Form.BOX else disc)(self._start, place, self._size)

    def end(self) -> Zone | None:
        """End the drag; None if it did not move (InputError: a line that encloses no area)."""
        line, zone = self._line, self.zone
        self.clear()
        return lasso(line, self._size) if line else zone

    def click(self, place: Point) -> Zone | None:
        """Set one more corner; at the first or last one the polygon is closed (InputError: the body is in space)."""
        if not self._flat:
            raise InputError("only balls can be drawn on a 3D body. Drag from the center of a ball outward")
        near = 0.02  # a click so near the first corner closes a polygon, as a share of the body
        if self.corners and math.dist(self.corners[0], place) < near * self._size:
            return self.close()
        if self.corners and math.dist(self.corners[-1], place) <= SAME_CLICK * self._size:
            return self.close()
        self.corners = (*self.corners, place)
        return None

    def close(self) -> Zone | None:
        """Close the polygon, its largest part where sides cross; None while it has fewer than three corners."""
        if len(self.corners) < 3:
            return None
        corners = self.corners
        self.clear()
        try:
            return Zone(outline=corners)
        except InputError:
            return lasso(corners, self._size)

    def scene_items(self, color: str) -> list[SceneItem]:
        """The open line and its corners."""
        open_line = self._line or self.corners
        line = [Strand(points=open_line, stroke=Stroke.PATH, color=color)] if open_line else []
        return [*line, *(Dot(at=corner, look=Look.HANDLE, color=color) for corner in self.corners)]

    @property
    def _size(self) -> float:
        return self._document.robot.body.mesh.size

    @property
    def _flat(self) -> bool:
        return self._document.robot.body.mesh.dim == 2
