"""`Painter`: zones painted on the body, by hand."""

import math
from collections.abc import Callable
from dataclasses import replace

from hydrostat.design import Zone
from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.project import Paint
from hydrostat.studio.document import Document
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Area, Dot, Look, SceneItem, Strand, Stroke

COLORS = {Paint.KEEP_OUT: "#c8243f", Paint.WINCH_ZONES: "#00795f", Paint.STILL: "#5a3da6"}  # of each paint
LABELS = {Paint.KEEP_OUT: "no cable", Paint.WINCH_ZONES: "winches", Paint.STILL: "still"}  # written in a zone
LEAST = 0.015  # the smallest radius of a painted zone, as a share of the body


def disc(middle: Point, rim: Point, size: float) -> Zone:
    """A disc or ball from its middle to a point on its rim, not too small for a body of some size [m]."""
    return Zone(at=middle, radius=max(math.dist(middle, rim), LEAST * size))


def lasso(points: tuple[Point, ...], size: float) -> Zone:
    """The polygon of a line drawn by hand; its largest part where it crosses itself (InputError: it has none)."""
    from shapely import Polygon, make_valid
    from shapely.geometry.base import BaseMultipartGeometry

    whole = make_valid(Polygon(points)) if len(points) >= 3 else Polygon()
    parts = whole.geoms if isinstance(whole, BaseMultipartGeometry) else [whole]
    polygons = [part for part in parts if isinstance(part, Polygon) and not part.is_empty]
    if not polygons or max(part.area for part in polygons) < (LEAST * size) ** 2:
        raise InputError("the line encloses no area. Draw it around a part of the body")
    coarse = 0.006  # a line drawn by hand is made this much simpler, as a share of the body
    largest = max(polygons, key=lambda part: part.area).exterior.simplify(coarse * size)
    return Zone(outline=tuple((float(x), float(y)) for x, y in list(largest.coords)[:-1]))


def move_zone(zone: Zone, start: Point, end: Point) -> Zone:
    """Return a zone moved by the way from one point to another [m]."""

    def there(point: Point) -> Point:
        return tuple(value + last - first for value, first, last in zip(point, start, end, strict=True))

    return zone.move(there)


def with_corner(zone: Zone, index: int, place: Point) -> Zone:
    """A polygon with one corner elsewhere."""
    return Zone(outline=(*zone.outline[:index], place, *zone.outline[index + 1 :]))


def rim_handle(zone: Zone) -> Point:
    """Return the point at which a disc or ball is dragged to resize it [m]."""
    assert zone.at is not None
    assert zone.radius is not None
    return (zone.at[0] + zone.radius, *zone.at[1:])


WORDS = {Paint.KEEP_OUT: "no-cable zone", Paint.WINCH_ZONES: "winch zone", Paint.STILL: "rigid zone"}
"""Name of the zone of each paint, in the list of zones and for undo."""


class Painter:
    """Paints, chooses, moves, resizes and deletes zones; each is one step to undo.

    With a paint in hand, a drag on the body draws a disc (a ball in space) from its middle outward. On a flat body a
    drag with shift draws round a part of any shape, and clicks set the corners of a polygon.
    """

    def __init__(self, document: Document) -> None:
        self._document = document
        self.paint: Paint | None = None  # in hand; None: zones are chosen and moved
        self.chosen: int | None = None  # number of the zone that is selected
        self._corners: tuple[Point, ...] = ()
        self._line: tuple[Point, ...] = ()
        self._draft: tuple[int | None, Paint, Zone] | None = None
        self._shaping: Callable[[Point], Zone] | None = None
        self._verb = ""

    @property
    def zones(self) -> tuple[tuple[Paint, Zone], ...]:
        """All that is painted, with what is being drawn just now."""
        zones = self._document.work.wishes.zones
        if self._draft is None:
            return zones
        index, paint, zone = self._draft
        if index is None:
            return (*zones, (paint, zone))
        return tuple((paint, zone) if number == index else other for number, other in enumerate(zones))

    @property
    def busy(self) -> bool:
        """True if a zone is being painted or reshaped, so that the body must be at rest."""
        return self.paint is not None or self._shaping is not None

    def take(self, paint: Paint | None) -> None:
        """Take a paint in hand, or none."""
        self.paint = paint
        self.chosen = None
        self._corners, self._line, self._draft, self._shaping = (), (), None, None

    def grab(self, hit: Hit) -> bool:
        """Begin to draw, or take hold of a zone or of its handle."""
        kind, _, rest = hit.key.partition(":")
        place = hit.rest or hit.world
        zones = self._document.work.wishes.zones
        if kind in ("zone-rim", "zone-corner"):
            return self._shape(rest)
        if self.paint is not None:
            return hit.rest is not None and self._draw(hit.rest, free=hit.shift)
        elif kind == "zone" and self._there(rest):
            self.chosen = int(rest)
            zone = zones[self.chosen][1]
            self._begin(self.chosen, "move", lambda end: move_zone(zone, place, end))
        else:
            return False
        return True

    def drag(self, hit: Hit) -> None:
        """Draw on, or carry on."""
        place = hit.rest or hit.world
        if self._line:
            self._line = (*self._line, place)
        elif self._shaping is not None and self._draft is not None:
            index, paint, _ = self._draft
            self._draft = (index, paint, self._shaping(place))
        elif self._shaping is not None and self.paint is not None:
            self._draft = (None, self.paint, self._shaping(place))

    def release(self) -> None:
        """Keep what was drawn."""
        line, draft, paint = self._line, self._draft, self.paint
        self._line, self._draft, self._shaping = (), None, None
        if line and paint is not None:
            self._add(paint, lasso(line, self._size))
        elif draft is not None and draft[0] is None:
            self._add(draft[1], draft[2])
        elif draft is not None:
            self._change(self._verb + " zone", draft)

    def click(self, hit: Hit) -> None:
        """Choose a zone, or set a corner of a polygon."""
        kind, _, rest = hit.key.partition(":")
        if self.paint is not None and hit.rest is not None:
            self._corner(hit.rest)
        elif self.paint is None:
            self.chosen = int(rest) if kind == "zone" and self._there(rest) else None

    def key(self, name: str) -> bool:
        """Delete removes the chosen zone, Escape puts the paint away."""
        if name == "delete" and self.chosen is not None:
            self.remove(self.chosen)
            return True
        if name == "enter" and len(self._corners) >= 3:
            self._close()
            return True
        if name == "escape" and (self._corners or self.paint is not None or self.chosen is not None):
            self.take(None if not self._corners else self.paint)
            return True
        return False

    def remove(self, index: int) -> None:
        """Delete a zone."""
        wishes = self._document.work.wishes
        if index >= len(wishes.zones):
            return
        zones = wishes.zones[:index] + wishes.zones[index + 1 :]
        self.chosen = None
        self._document.change("delete zone", wishes=replace(wishes, zones=zones))

    def scene_items(self) -> list[SceneItem]:
        """Zones, with handles on the chosen one, and what is being drawn."""
        things: list[SceneItem] = []
        zones = self.zones
        for index, (paint, zone) in enumerate(zones):
            things.append(_area(index, paint, zone, chosen=index == self.chosen))
        if self.chosen is not None and self.chosen < len(zones):
            things += _handles(self.chosen, *zones[self.chosen])
        open_line = self._line or self._corners
        if open_line and self.paint is not None:
            things.append(Strand(points=open_line, stroke=Stroke.PATH, color=COLORS[self.paint]))
        for corner in self._corners:
            things.append(Dot(at=corner, look=Look.HANDLE, color=COLORS[self.paint or Paint.KEEP_OUT]))
        return things

    @property
    def _size(self) -> float:
        return self._document.robot.body.mesh.size

    @property
    def _flat(self) -> bool:
        return self._document.robot.body.mesh.dim == 2

    def _there(self, number: str) -> bool:
        return number.isdecimal() and int(number) < len(self._document.work.wishes.zones)

    def _begin(self, index: int, verb: str, shaping: Callable[[Point], Zone]) -> None:
        paint, zone = self._document.work.wishes.zones[index]
        self._draft, self._shaping, self._verb = (index, paint, zone), shaping, verb

    def _shape(self, handle: str) -> bool:
        """Take hold of a handle; the number of a polygon's corner comes after that of the zone."""
        number, _, corner = handle.partition(":")
        if not self._there(number):
            return False
        zone = self._document.work.wishes.zones[int(number)][1]
        if zone.at is not None and not corner:
            middle = zone.at
            self._begin(int(number), "resize", lambda end: disc(middle, end, self._size))
        elif corner.isdecimal() and int(corner) < len(zone.outline):
            self._begin(int(number), "reshape", lambda end: with_corner(zone, int(corner), end))
        else:
            return False
        return True

    def _draw(self, place: Point, *, free: bool) -> bool:
        self._corners = ()
        if free and self._flat:
            self._line = (place,)
        else:
            self._shaping = lambda end: disc(place, end, self._size)
        return True

    def _corner(self, place: Point) -> None:
        """One more corner; near the first one the polygon is closed."""
        if not self._flat:
            raise InputError("zones of a body in space are balls. Drag on the body from the center of a ball outward")
        first = self._corners[0] if self._corners else None
        near = 0.02  # a click so near the first corner closes a polygon, as a share of the body
        if (
            first is not None
            and sum((a - b) ** 2 for a, b in zip(first, place, strict=True)) < (near * self._size) ** 2
        ):
            if len(self._corners) >= 3:
                self._close()
            return
        self._corners = (*self._corners, place)

    def _close(self) -> None:
        corners, self._corners = self._corners, ()
        assert self.paint is not None
        self._add(self.paint, Zone(outline=corners))

    def _add(self, paint: Paint, zone: Zone) -> None:
        """A new zone; it is chosen, and the paint put away."""
        wishes = self._document.work.wishes
        self.paint, self.chosen = None, len(wishes.zones)
        self._document.change(f"paint {WORDS[paint]}", wishes=replace(wishes, zones=(*wishes.zones, (paint, zone))))

    def _change(self, label: str, draft: tuple[int | None, Paint, Zone]) -> None:
        wishes = self._document.work.wishes
        index, paint, zone = draft
        if index is None or index >= len(wishes.zones) or wishes.zones[index] == (paint, zone):
            return
        zones = tuple((paint, zone) if number == index else other for number, other in enumerate(wishes.zones))
        self._document.change(label, wishes=replace(wishes, zones=zones))


def _area(index: int, paint: Paint, zone: Zone, *, chosen: bool) -> Area:
    key, color, label = f"zone:{index}", COLORS[paint], LABELS[paint]
    if zone.at is not None and zone.radius is not None:
        return Area(key=key, color=color, at=zone.at, radius=zone.radius, label=label, chosen=chosen)
    outline = zone.outline
    if zone.box is not None and zone.dim == 2:
        (left, low), (right, high) = zone.box
        outline = ((left, low), (right, low), (right, high), (left, high))
    return Area(key=key, color=color, outline=outline, label=label, chosen=chosen)


def _handles(index: int, paint: Paint, zone: Zone) -> list[SceneItem]:
    """Resize handles of the chosen zone, fixed in the world, as the body is at rest during painting."""
    if zone.at is not None:
        places = {f"zone-rim:{index}": rim_handle(zone)}
    else:
        places = {f"zone-corner:{index}:{number}": corner for number, corner in enumerate(zone.outline)}
    return [Dot(key=key, at=place, look=Look.HANDLE, color=COLORS[paint], stuck=False) for key, place in places.items()]
