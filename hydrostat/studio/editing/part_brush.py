"""`PartBrush`: paints regions of another material on the body; `add_body_part`."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from hydrostat.design import Zone
from hydrostat.drawing import Color
from hydrostat.project import fresh_name
from hydrostat.robot import Body, BodyPart, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.editing.body_parts import RIGID, fill, filling_of, own_parts, round_place, with_body_parts
from hydrostat.studio.editing.part import Mirror
from hydrostat.studio.shape_draft import Form, ShapeDraft, zone_area
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Area, SceneItem

COLORS = {RIGID: "#5a3da6", "stiffer": "#a4501c", "softer": "#00795f"}  # of a part beside the body


def add_body_part(robot: Robot, zone: Zone, filling: str, mirror: Mirror | None = None) -> Robot:
    """One more region, of a material of the table or rigid (InputError: it holds nothing, or overlaps another).

    With a mirror a region that lies on one side of the plane has a twin on the other.
    """
    parts = list(own_parts(robot.body))
    shape: dict[str, Any] = {"shape": "polygon", "points": tuple(map(round_place, zone.outline))}
    if zone.at is not None and zone.radius is not None:
        shape = {"shape": "sphere", "at": round_place(zone.at), "radius": round(zone.radius, 4)}
    elif zone.box is not None:
        shape = {"shape": "box", "at": round_place(zone.box[0]), "to": round_place(zone.box[1])}
    name = fresh_name("part", [part.name for part in parts])
    parts.append(BodyPart(name=name, **shape, **fill(filling)))
    if mirror is not None and not _crosses(zone, mirror.axis):
        name = fresh_name("part", [part.name for part in parts])
        parts.insert(-1, replace(parts[-1].with_transform(mirror.point), name=name))
    return with_body_parts(robot, parts)


def _crosses(zone: Zone, axis: int) -> bool:
    """True if a zone lies on both sides of the plane where a coordinate is 0."""
    if zone.at is not None and zone.radius is not None:
        return abs(zone.at[axis]) < zone.radius
    along = [point[axis] for point in (*(zone.box or ()), *zone.outline)]
    return min(along) < 0 < max(along)


class PartBrush:
    """Material, form and outline of the region that is painted next."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self.form = Form.DISC
        self.filling = RIGID
        self.drawn = ShapeDraft(document)

    def choose_form(self, form: Form) -> None:
        """Choose what a drag makes."""
        self.form = form
        self._document.bell.ring(Topic.SCENE)

    def grab(self, hit: Hit) -> bool:
        """Begin to draw on the body."""
        if hit.rest is None:
            return False
        self.drawn.begin(hit.rest, Form.FREE if hit.shift else self.form)
        return True

    def scene_items(self, chosen: Iterable[str], *, pickable: bool) -> list[SceneItem]:
        """All regions that can be shown, as their elements hold them, and what is being drawn."""
        chosen, body, items = set(chosen), self._document.robot.body, []
        rings = body.part_rings if body.mesh.dim == 2 else []
        for index, part in enumerate(own_parts(body)):
            key, filling = f"region:{index}", filling_of(part)
            given = {"color": region_color(body, part), "label": f"{part.name}: {filling}", "chosen": key in chosen}
            given["key"] = key if pickable else ""
            if body.mesh.dim == 2:
                outer = max(rings[index], key=len)
                items.append(Area(outline=tuple(map(tuple, body.mesh.nodes[outer].tolist())), **given))
            elif part.shape == "sphere" and part.at is not None:
                items.append(Area(at=part.at, radius=part.radius or 0.0, **given))
        color = COLORS[RIGID] if self.filling == RIGID else Color.INK
        if self.drawn.zone is not None:
            items.append(zone_area(self.drawn.zone, key="", color=color, label=self.filling, chosen=True))
        return [*items, *self.drawn.scene_items(color)]


def region_color(body: Body, part: BodyPart) -> str:
    """Color of a region: rigid, stiffer or softer than the body."""
    if part.material is None:
        return COLORS[RIGID]
    return COLORS["stiffer" if part.material.young > body.material.young else "softer"]
