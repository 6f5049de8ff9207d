"""Zones painted by gestures. Oracle: where the pointer went; every gesture is one step to undo."""

import math
from dataclasses import replace

import pytest
from builders import box_robot

from hydrostat.design import Zone
from hydrostat.errors import InputError
from hydrostat.project import Paint, Work
from hydrostat.studio.bell import Bell
from hydrostat.studio.designing.painter import Painter
from hydrostat.studio.document import Document
from hydrostat.studio.shape_draft import MIN_SHAPE, lasso
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.picture import Picture
from hydrostat.studio.view.scene_items import Area, Dot, Look, Strand


@pytest.fixture
def painter(document: Document) -> Painter:
    return Painter(document)


def on_body(*place: float, key: str = "body", shift: bool = False) -> Hit:
    return Hit(key=key, rest=place, world=place, shift=shift)


def beside(*place: float) -> Hit:
    return Hit(world=place)


def stroke(painter: Painter, *hits: Hit) -> bool:
    held = painter.grab(hits[0])
    for hit in hits[1:]:
        painter.drag(hit)
    painter.release()
    return held


def painted(document: Document) -> tuple[tuple[Paint, Zone], ...]:
    return document.work.wishes.zones


def test_without_a_paint_the_body_is_not_held(painter: Painter, document: Document) -> None:
    assert not stroke(painter, on_body(0.0, 0.0), on_body(0.02, 0.0))
    assert painted(document) == ()


@pytest.mark.parametrize("paint", Paint)
def test_a_drag_draws_a_disc_from_its_middle(painter: Painter, document: Document, paint: Paint) -> None:
    painter.take(paint)
    assert stroke(painter, on_body(0.01, 0.0), on_body(0.02, 0.0), on_body(0.04, 0.04))
    assert painted(document) == ((paint, Zone(at=(0.01, 0.0), radius=math.dist((0.01, 0.0), (0.04, 0.04)))),)
    assert painter.paint is None
    assert painter.chosen == 0
    document.undo()
    assert painted(document) == ()
    document.redo()
    assert len(painted(document)) == 1


def test_the_disc_is_seen_while_it_is_drawn(painter: Painter, document: Document) -> None:
    painter.take(Paint.STILL)
    painter.grab(on_body(0.0, 0.0))
    painter.drag(on_body(0.03, 0.0))
    assert [(area.at, area.radius) for area in painter.scene_items() if isinstance(area, Area)] == [((0.0, 0.0), 0.03)]
    assert painted(document) == ()


def test_a_disc_is_never_too_small_to_take_hold_of(painter: Painter, document: Document) -> None:
    painter.take(Paint.KEEP_OUT)
    stroke(painter, on_body(0.0, 0.0), on_body(1e-5, 0.0))
    assert painted(document)[0][1].radius == MIN_SHAPE * document.robot.body.mesh.size


def test_a_drag_that_begins_beside_the_body_paints_nothing(painter: Painter, document: Document) -> None:
    painter.take(Paint.KEEP_OUT)
    assert not stroke(painter, beside(0.5, 0.5), on_body(0.0, 0.0))
    assert painted(document) == ()


def test_with_shift_a_line_goes_round_a_part(painter: Painter, document: Document) -> None:
    painter.take(Paint.KEEP_OUT)
    corners = [(0.0, 0.0), (0.05, 0.0), (0.05, 0.03), (0.0, 0.03)]
    stroke(painter, *(on_body(*corner, shift=True) for corner in corners))
    (paint, zone), = painted(document)  # fmt: skip
    assert paint is Paint.KEEP_OUT
    assert set(zone.outline) == set(corners)


def test_a_line_that_crosses_itself_keeps_its_larger_part() -> None:
    """A bow with one wing twice as large as the other: 0.04 x 0.04 and 0.02 x 0.02 halves about a crossing."""
    zone = lasso(((-0.04, -0.04), (0.02, 0.02), (0.02, -0.02), (-0.04, 0.04)), 0.2)
    assert set(zone.outline) == {(-0.04, -0.04), (0.0, 0.0), (-0.04, 0.04)}


def test_clicked_sides_that_cross_keep_the_larger_part(painter: Painter, document: Document) -> None:
    painter.take(Paint.KEEP_OUT)
    for corner in ((-0.04, -0.04), (0.02, 0.02), (0.02, -0.02), (-0.04, 0.04)):
        painter.click(on_body(*corner))
    painter.key("enter")
    assert set(painted(document)[0][1].outline) == {(-0.04, -0.04), (0.0, 0.0), (-0.04, 0.04)}


def test_a_line_round_nothing_is_refused(painter: Painter, document: Document) -> None:
    painter.take(Paint.KEEP_OUT)
    with pytest.raises(InputError, match="encloses no area"):
        stroke(painter, on_body(0.0, 0.0, shift=True), on_body(0.02, 0.0))
    assert painted(document) == ()
    assert not [item for item in painter.scene_items() if isinstance(item, Strand)]


def test_clicks_set_corners_and_the_first_one_closes(painter: Painter, document: Document) -> None:
    painter.take(Paint.WINCH_ZONES)
    corners = ((0.0, 0.0), (0.04, 0.0), (0.02, 0.03))
    for corner in corners:
        painter.click(on_body(*corner))
    assert len([dot for dot in painter.scene_items() if isinstance(dot, Dot) and dot.look is Look.HANDLE]) == 3
    painter.click(on_body(0.001, 0.001))
    assert painted(document) == ((Paint.WINCH_ZONES, Zone(outline=corners)),)


def test_enter_closes_and_escape_gives_up(painter: Painter, document: Document) -> None:
    painter.take(Paint.STILL)
    for corner in ((0.0, 0.0), (0.04, 0.0), (0.02, 0.03)):
        painter.click(on_body(*corner))
    assert painter.key("escape")
    assert painter.paint is Paint.STILL
    assert painter.key("escape")
    assert painter.paint is None
    assert not painter.key("escape")
    painter.take(Paint.STILL)
    assert not painter.key("enter")
    for corner in ((0.0, 0.0), (0.04, 0.0), (0.02, 0.03)):
        painter.click(on_body(*corner))
    assert painter.key("enter")
    assert len(painted(document)) == 1


@pytest.fixture
def with_zones(document: Document) -> Document:
    zones = (
        (Paint.KEEP_OUT, Zone(at=(0.0, 0.0), radius=0.02)),
        (Paint.STILL, Zone(outline=((0.0, 0.0), (0.04, 0.0), (0.02, 0.03)))),
    )
    document.change("zones", wishes=replace(document.work.wishes, zones=zones))
    return document


def test_a_zone_is_chosen_by_a_click_and_moved_by_a_drag(painter: Painter, with_zones: Document) -> None:
    painter.click(on_body(0.01, 0.0, key="zone:0"))
    assert painter.chosen == 0
    painter.click(on_body(0.05, 0.05))
    assert painter.chosen is None
    stroke(painter, on_body(0.01, 0.0, key="zone:0"), on_body(0.02, 0.01), on_body(0.03, 0.02))
    assert painted(with_zones)[0][1].at == pytest.approx((0.02, 0.02))
    assert painted(with_zones)[0][1].radius == 0.02
    assert with_zones.undo_label == "move zone"
    stroke(painter, on_body(0.01, 0.0, key="zone:1"), on_body(0.02, 0.0))
    assert painted(with_zones)[1][1].outline[0] == pytest.approx((0.01, 0.0))


def test_a_press_without_a_move_changes_nothing(painter: Painter, with_zones: Document) -> None:
    stroke(painter, on_body(0.01, 0.0, key="zone:0"))
    assert with_zones.undo_label == "zones"


def test_handles_resize_and_reshape(painter: Painter, with_zones: Document) -> None:
    painter.chosen = 0
    assert [dot.key for dot in painter.scene_items() if isinstance(dot, Dot)] == ["zone-rim:0"]
    stroke(painter, on_body(0.02, 0.0, key="zone-rim:0"), on_body(0.0, 0.05))
    assert painted(with_zones)[0][1] == Zone(at=(0.0, 0.0), radius=0.05)
    painter.chosen = 1
    stroke(painter, on_body(0.04, 0.0, key="zone-corner:1:1"), on_body(0.05, 0.01))
    assert painted(with_zones)[1][1].outline == ((0.0, 0.0), (0.05, 0.01), (0.02, 0.03))
    assert with_zones.undo_label == "reshape zone"


def test_delete_removes_the_chosen_zone(painter: Painter, with_zones: Document) -> None:
    assert not painter.key("delete")
    painter.chosen = 0
    assert painter.key("delete")
    assert [paint for paint, _ in painted(with_zones)] == [Paint.STILL]
    assert painter.chosen is None
    with_zones.undo()
    assert len(painted(with_zones)) == 2


@pytest.mark.parametrize("key", ["zone:7", "zone:x", "zone-rim:9", "zone-corner:5:0", "zone-corner::", "zone:-1"])
def test_zones_that_are_gone_are_passed_over(painter: Painter, with_zones: Document, key: str) -> None:
    assert not painter.grab(on_body(0.0, 0.0, key=key))
    painter.click(on_body(0.0, 0.0, key=key))
    assert painter.chosen is None
    painter.remove(7)
    assert len(painted(with_zones)) == 2


@pytest.mark.parametrize("key", ["zone-rim:1", "zone-corner:0:0", "zone-corner:1:9", "zone-corner:1:x"])
def test_handles_that_a_zone_does_not_have_hold_nothing(painter: Painter, with_zones: Document, key: str) -> None:
    assert not painter.grab(on_body(0.0, 0.0, key=key))


def test_a_zone_that_is_undone_while_it_is_carried_is_let_go(painter: Painter, with_zones: Document) -> None:
    painter.grab(on_body(0.01, 0.0, key="zone:1"))
    painter.drag(on_body(0.02, 0.0))
    with_zones.undo()
    painter.drag(on_body(0.03, 0.0))
    assert painter.scene_items() is not None
    painter.release()
    assert painted(with_zones) == ()


def test_in_space_zones_are_balls() -> None:
    robot = box_robot()
    document = Document(Bell())
    document.open(Work(robot=robot))
    painter = Painter(document)
    painter.take(Paint.KEEP_OUT)
    place = tuple(robot.body.mesh.nodes[0].tolist())
    stroke(painter, on_body(*place, shift=True), beside(place[0] + 0.02, *place[1:]))
    zone = painted(document)[0][1]
    assert (zone.at, zone.radius) == (place, pytest.approx(0.02))
    painter.take(Paint.KEEP_OUT)
    with pytest.raises(InputError, match="only balls can be drawn"):
        painter.click(on_body(*place))


def test_what_is_painted_can_be_drawn(painter: Painter, with_zones: Document) -> None:
    painter.chosen = 1
    picture = Picture(with_zones.robot, painter.scene_items(), 1)
    assert picture.scene()
