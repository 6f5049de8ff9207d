"""Regions of another material, painted in "edit". Oracles: areas of drawn shapes, robot.toml read back, undo."""

from collections.abc import Iterator
from math import pi
from pathlib import Path

import numpy as np
import pytest
from builders import box_robot

from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.robot import Robot, load_robot, save_robot
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.editing.change import remesh
from hydrostat.studio.editing.editor import Editor, Tool
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.shape_draft import Form
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.picture import Picture
from hydrostat.studio.view.scene_items import Area

SOFT = "ecoflex 00-30"


@pytest.fixture
def editor(document: Document) -> Iterator[Editor]:
    yield from _editor(document)


def _editor(document: Document) -> Iterator[Editor]:
    jobs = Jobs(document.bell)
    yield Editor(document, jobs)
    jobs.close()


def on(*place: float, key: str = "body", shift: bool = False) -> Hit:
    return Hit(key=key, rest=place, world=place, shift=shift)


def paint(editor: Editor, *hits: Hit, form: Form = Form.DISC, filling: str = "rigid") -> None:
    editor.take(Tool.PART)
    editor.brush.form, editor.brush.filling = form, filling
    assert editor.grab(hits[0])
    for hit in hits[1:]:
        editor.drag(hit)
    editor.release()


def area(robot: Robot, number: int = 1) -> float:
    return float(robot.body.mesh.volumes[robot.body.element_materials == number].sum())


def test_a_painted_disc_is_a_part_that_is_saved_and_undone(
    editor: Editor, document: Document, starfish: Robot, tmp_path: Path
) -> None:
    paint(editor, on(0.0, 0.0), on(0.02, 0.0), filling=SOFT)
    (part,) = document.robot.body.parts
    assert (part.name, part.shape, part.at, part.radius) == ("part_1", "sphere", (0.0, 0.0), 0.02)
    assert part.material is not None
    assert part.material.name == SOFT
    assert area(document.robot) == pytest.approx(pi * 0.02**2, rel=0.15)
    assert editor.selected_key == "region:0"
    assert editor.tool is Tool.MOVE
    save_robot(document.robot, tmp_path / "robot")
    text = (tmp_path / "robot" / "robot.toml").read_text()
    assert f'[[body.part]]\nname = "part_1"\nshape = "sphere"\nat = [0, 0]\nradius = 20\nmaterial = "{SOFT}"' in text
    again = load_robot(tmp_path / "robot")
    assert again.body == document.robot.body
    assert np.array_equal(again.body.mesh.nodes, document.robot.body.mesh.nodes)
    assert document.undo_label == "paint region"
    document.undo()
    assert document.robot is starfish


def test_boxes_lines_and_clicks_make_parts(editor: Editor, document: Document) -> None:
    paint(editor, on(0.015, 0.012), on(-0.015, -0.01), form=Form.BOX)
    (part,) = document.robot.body.parts
    assert part.is_rigid
    assert (part.shape, part.at, part.to, part.density) == ("box", (-0.015, -0.01), (0.015, 0.012), 1240.0)
    document.undo()
    corners = ((-0.02, -0.02), (0.02, -0.02), (0.02, 0.0), (-0.02, 0.0))
    paint(editor, *(on(*corner) for corner in corners), form=Form.FREE)
    assert set(document.robot.body.parts[0].points) == set(corners)
    document.undo()
    editor.take(Tool.PART)
    for corner in corners:
        editor.click(on(*corner))
    assert editor.key("enter")
    assert document.robot.body.parts[0].points == corners


def test_a_part_is_moved_named_filled_copied_and_deleted(editor: Editor, document: Document, starfish: Robot) -> None:
    paint(editor, on(0.0, 0.0), on(0.012, 0.0))
    assert editor.grab(on(0.0, 0.0, key="region:0"))
    editor.drag(on(0.001, -0.004))
    editor.release()
    document.seal()
    assert document.robot.body.parts[0].at == (0.001, -0.004)
    editor.rename("region:0", "bone")
    editor.set("region:0", filling=SOFT)
    assert (document.robot.body.parts[0].name, document.robot.body.parts[0].density) == ("bone", None)
    with pytest.raises(InputError, match="overlaps"):
        paint(editor, on(0.0, 0.0), on(0.01, 0.0))
    editor.choose("region:0")
    editor.duplicate()
    assert [part.name for part in document.robot.body.parts] == ["bone", "bone_1"]
    editor.choose_all()
    editor.choose("region:0", also=True)
    editor.choose("region:0")
    editor.delete()
    assert [part.name for part in document.robot.body.parts] == ["bone_1"]
    editor.choose("region:0")
    editor.delete()
    assert document.robot.body == starfish.body
    assert np.array_equal(document.robot.body.mesh.nodes, starfish.body.mesh.nodes)


def test_a_mirror_paints_both_sides(editor: Editor, document: Document) -> None:
    editor.mirror_about("x")
    paint(editor, on(0.03, 0.0), on(0.04, 0.0))
    one, two = document.robot.body.parts
    assert (one.at, two.at) == ((-0.03, 0.0), (0.03, 0.0))
    editor.set("region:1", filling=SOFT)
    assert [part.is_rigid for part in document.robot.body.parts] == [False, False]
    editor.delete()
    assert document.robot.body.parts == ()
    paint(editor, on(0.0, 0.0), on(0.01, 0.0))
    assert len(document.robot.body.parts) == 1


def test_regions_are_shown_in_color_and_picked_only_to_be_moved(editor: Editor, document: Document) -> None:
    paint(editor, on(0.0, 0.0), on(0.02, 0.0))
    editor.set("region:0", filling=SOFT)

    def areas() -> list[Area]:
        return [item for item in editor.scene_items() if isinstance(item, Area)]

    soft = areas()[0]
    assert (soft.key, soft.label, soft.chosen) == ("region:0", f"part_1: {SOFT}", True)
    editor.set("region:0", filling="rigid")
    assert areas()[0].color != soft.color
    editor.take(Tool.CABLE)
    assert areas()[0].key == ""
    assert Picture(document.robot, editor.scene_items(), 1).scene()


def test_in_space_a_ball_is_painted() -> None:
    robot = box_robot()
    document = Document(Bell())
    document.open(Work(robot=robot))
    editor = next(made := _editor(document))
    place = tuple(robot.body.mesh.nodes.mean(axis=0).round(4).tolist())
    paint(editor, on(*place), on(place[0] + 0.4 * robot.body.mesh.size, *place[1:]), form=Form.BOX)
    assert document.robot.body.parts[0].shape == "sphere"
    assert isinstance(editor.scene_items()[0], Area)
    made.close()


def test_elements_of_another_size_keep_regions(editor: Editor, document: Document) -> None:
    paint(editor, on(0.0, 0.0), on(0.02, 0.0))
    finer = remesh(document.robot, element_size=0.008)
    assert finer.parts == document.robot.body.parts
    assert len(finer.mesh.nodes) > len(document.robot.body.mesh.nodes)
