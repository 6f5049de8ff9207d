"""`Painter`: zones painted on the body, by hand."""

from collections.abc import Callable
from dataclasses import replace

from hydrostat.design import Zone
from hydrostat.given import Point
from hydrostat.project import Paint
from hydrostat.studio.document import Document
from hydrostat.studio.shape_draft import Form, ShapeDraft, disc, zone_area
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Dot, Look, SceneItem

COLORS = {Paint.KEEP_OUT: "#c8243f", Paint.WINCH_ZONES: "#00795f", Paint.STILL: "#5a3da6"}  # of each paint
LABELS = {Paint.KEEP_OUT: "no cable", Paint.WINCH_ZONES: "winches", Paint.STILL: "still"}  # written in a zone


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
        self._drawn = ShapeDraft(document)
        self._draft: tuple[int, Paint, Zone] | None = None
        self._shaping: Callable[[Point], Zone] | None = None
        self._verb = ""

    @property
    def zones(self) -> tuple[tuple[Paint, Zone], ...]:
        """All that is painted, with what is being drawn just now."""
        zones = self._document.work.wishes.zones
        if self._drawn.zone is not None and self.paint is not None:
            return (*zones, (self.paint, self._drawn.zone))
        if self._draft is None:
            return zones
        index, paint, zone = self._draft
        return tuple((paint, zone) if number == index else other for number, other in enumerate(zones))

    @property
    def busy(self) -> bool:
        """True if a zone is being painted or reshaped, so that the body must be at rest."""
        return self.paint is not None or self._shaping is not None

    def take(self, paint: Paint | None) -> None:
        """Take a paint in hand, or none."""
        self.paint = paint
        self.chosen = None
        self._drawn.clear()
        self._draft, self._shaping = None, None

    def grab(self, hit: Hit) -> bool:
        """Begin to draw, or take hold of a zone or of its handle."""
        kind, _, rest = hit.key.partition(":")
        place = hit.rest or hit.world
        zones = self._document.work.wishes.zones
        if kind in ("zone-rim", "zone-corner"):
            return self._shape(rest)
        if self.paint is not None:
            if hit.rest is None:
                return False
            self._drawn.begin(hit.rest, Form.FREE if hit.shift else Form.DISC)
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
        if self._shaping is not None and self._draft is not None:
            index, paint, _ = self._draft
            self._draft = (index, paint, self._shaping(place))
        else:
            self._drawn.drag(place)

    def release(self) -> None:
        """Keep what was drawn."""
        draft, self._draft, self._shaping = self._draft, None, None
        if draft is not None:
            self._change(self._verb + " zone", draft)
        else:
            self._add(self._drawn.end())

    def click(self, hit: Hit) -> None:
        """Choose a zone, or set a corner of a polygon."""
        kind, _, rest = hit.key.partition(":")
        if self.paint is not None and hit.rest is not None:
            self._add(self._drawn.click(hit.rest))
        elif self.paint is None:
            self.chosen = int(rest) if kind == "zone" and self._there(rest) else None

    def key(self, name: str) -> bool:
        """Delete removes the chosen zone, Escape puts the paint away."""
        if name == "delete" and self.chosen is not None:
            self.remove(self.chosen)
            return True
        corners = self._drawn.corners
        if name == "enter" and (zone := self._drawn.close()) is not None:
            self._add(zone)
            return True
        if name == "escape" and (corners or self.paint is not None or self.chosen is not None):
            self.take(self.paint if corners else None)
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
        items: list[SceneItem] = []
        zones = self.zones
        for index, (paint, zone) in enumerate(zones):
            chosen = index == self.chosen
            key, color, label = f"zone:{index}", COLORS[paint], LABELS[paint]
            items.append(zone_area(zone, key=key, color=color, label=label, chosen=chosen))
        if self.chosen is not None and self.chosen < len(zones):
            items += _handles(self.chosen, *zones[self.chosen])
        return [*items, *self._drawn.scene_items(COLORS[self.paint or Paint.KEEP_OUT])]

    @property
    def _size(self) -> float:
        return self._document.robot.body.mesh.size

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

    def _add(self, zone: Zone | None) -> None:
        """Add a zone, if one was drawn; it is chosen, and the paint put away."""
        wishes, paint = self._document.work.wishes, self.paint
        if zone is None or paint is None:
            return
        self.paint, self.chosen = None, len(wishes.zones)
        self._document.change(f"paint {WORDS[paint]}", wishes=replace(wishes, zones=(*wishes.zones, (paint, zone))))

    def _change(self, label: str, draft: tuple[int, Paint, Zone]) -> None:
        wishes = self._document.work.wishes
        index, paint, zone = draft
        if index >= len(wishes.zones) or wishes.zones[index] == (paint, zone):
            return
        zones = tuple((paint, zone) if number == index else other for number, other in enumerate(wishes.zones))
        self._document.change(label, wishes=replace(wishes, zones=zones))


def _handles(index: int, paint: Paint, zone: Zone) -> list[SceneItem]:
    """Resize handles of the chosen zone, fixed in the world, as the body is at rest during painting."""
    if zone.at is not None:
        places = {f"zone-rim:{index}": rim_handle(zone)}
    else:
        places = {f"zone-corner:{index}:{number}": corner for number, corner in enumerate(zone.outline)}
    return [Dot(key=key, at=place, look=Look.HANDLE, color=COLORS[paint], stuck=False) for key, place in places.items()]
