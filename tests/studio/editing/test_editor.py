"""The stage "edit", by its pointer and its panel. The oracle is the robot of the document, and undo."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.project import Work
from hydrostat.robot import Body, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.editing.change import remesh
from hydrostat.studio.editing.editor import Editor, Tool
from hydrostat.studio.editing.tools import look_over
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.judge import QUIET
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.picture import Picture
from hydrostat.studio.view.scene_items import Dot, Strand

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture
def editor(document: Document) -> Iterator[Editor]:
    jobs = Jobs(document.bell)
    yield Editor(document, jobs)
    jobs.close()


def on(at: Point, key: str = "body") -> Hit:
    return Hit(key=key, rest=at, world=at)


def beside(at: Point) -> Hit:
    return Hit(world=at)


def drag(editor: Editor, document: Document, key: str, *places: Point, start: Point) -> None:
    """What a session does with a pointer that goes through some places."""
    assert editor.grab(on(start, key))
    for place in places:
        editor.drag(on(place, key))
    editor.release()
    document.seal()


def test_a_drag_is_one_step_back(editor: Editor, document: Document, starfish: Robot) -> None:
    drag(editor, document, "marker:top", (0.012, 0.115), (0.012, 0.11), start=(0.011, 0.121))
    assert document.robot.markers[0].at == (0.012, 0.11)
    assert document.undo_label == "move marker top"
    assert editor.selected_key == "marker:top"
    document.undo()
    assert document.robot is starfish


def test_what_is_held_by_its_edge_does_not_jump(editor: Editor, document: Document) -> None:
    drag(editor, document, "marker:top", (0.012, 0.111), start=(0.012, 0.121))
    assert document.robot.markers[0].at == pytest.approx((0.011, 0.111))


def test_outside_the_body_it_stays_at_the_nearest_place_inside(editor: Editor, document: Document) -> None:
    drag(editor, document, "marker:top", (0.011, 0.3), start=(0.011, 0.121))
    at = document.robot.markers[0].at
    assert not document.robot.body.distances(np.array([at])).any()
    assert at[1] > 0.121


def test_where_it_cannot_be_it_stays_where_it_was_last(editor: Editor, document: Document) -> None:
    assert editor.grab(on((0.0, -0.016), "pin:0"))
    editor.drag(on((0.0, -0.02)))
    editor.drag(on((0.5, 0.5)))
    assert document.robot.pins[0].at == (0.0, -0.02)
    assert "pin" in editor.shape().notes[0]
    editor.release()
    assert not editor.shape().notes


def test_a_via_point_is_drawn_out_of_a_cable_in_one_step(editor: Editor, document: Document, starfish: Robot) -> None:
    first, second = (np.array(point) for point in starfish.cables[0].points[2:4])
    middle = tuple(((first + second) / 2).tolist())
    goal = (middle[0], round(middle[1] + 0.004, 4))
    assert editor.grab(on(middle, "cable:0"))
    assert document.robot is starfish
    editor.drag(on((middle[0], middle[1] + 0.002)))
    editor.drag(on(goal))
    editor.release()
    document.seal()
    assert len(document.robot.cables[0].points) == len(starfish.cables[0].points) + 1
    assert document.robot.cables[0].points[3] == pytest.approx(goal, abs=1e-4)
    assert editor.selected_key == "via:0:3"
    document.undo()
    assert document.robot is starfish


@pytest.mark.parametrize(
    ("tool", "count"),
    [(Tool.PIN, lambda robot: len(robot.pins)), (Tool.MARKER, lambda robot: len(robot.markers)),
     (Tool.WINCH, lambda robot: len(robot.winches))],
)  # fmt: skip
@pytest.mark.parametrize("mirrored", [False, True])
def test_tools_place_parts(editor: Editor, document: Document, starfish: Robot, tool: Tool, count, mirrored) -> None:
    editor.mirror_about("x" if mirrored else "")
    editor.take(tool)
    editor.click(on((0.03, 0.015)))
    assert count(document.robot) == count(starfish) + 1 + mirrored
    assert document.undo_label == f"add {tool}"
    assert editor.selected_key.startswith(tool)
    editor.click(on((0.001, 0.03)))
    assert count(document.robot) == count(starfish) + 2 + mirrored
    document.undo()
    document.undo()
    assert document.robot is starfish
    assert editor.selected_key == ""
    with pytest.raises(InputError, match=f"place a {tool}"):
        editor.click(beside((0.5, 0.5)))


@pytest.mark.parametrize("end", ["enter", "escape", "done", "double click"])
def test_a_cable_is_laid_click_by_click(editor: Editor, document: Document, starfish: Robot, end: str) -> None:
    editor.take(Tool.CABLE)
    editor.click(on((-0.02, -0.008), "winch:left"))
    for at in ((-0.04, 0.002), (-0.06, 0.01)):
        editor.click(on(at))
    assert document.robot is starfish
    drawn = [item for item in editor.scene_items() if isinstance(item, Strand)]
    assert drawn[-1].points == ((-0.02, -0.008), (-0.04, 0.002), (-0.06, 0.01))
    if end == "done":
        editor.finish()
    elif end == "double click":
        editor.click(on((-0.06, 0.01)))
    else:
        assert editor.key(end)
    assert document.robot.cables[-1].points == drawn[-1].points
    assert document.undo_label == "add cable"
    assert editor.selected_key == f"cable:{len(starfish.cables)}"
    assert editor.draft is None
    document.undo()
    assert document.robot is starfish


def test_delete_takes_back_the_last_point_of_a_cable_that_is_laid(editor: Editor, document: Document) -> None:
    editor.take(Tool.CABLE)
    editor.click(on((0.0, 0.03)))
    editor.click(on((0.0, 0.05)))
    assert editor.key("delete")
    assert editor.draft is not None
    with pytest.raises(InputError, match="stopper"):
        editor.finish()
    editor.key("delete")
    assert editor.draft is None
    assert not document.undo_label


def test_what_was_begun_is_dropped_when_one_leaves(editor: Editor, document: Document, starfish: Robot) -> None:
    editor.take(Tool.CABLE)
    editor.click(on((0.0, 0.03)))
    editor.click(on((0.0, 0.05)))
    editor.leave()
    assert editor.draft is None
    assert document.robot is starfish


def test_twins_move_and_go_together(editor: Editor, document: Document, starfish: Robot) -> None:
    editor.mirror_about("x")
    drag(editor, document, "via:0:3", (0.07, 0.023), start=starfish.cables[0].points[3])
    assert document.robot.cables[0].points[3] == (0.07, 0.023)
    assert document.robot.cables[1].points[3] == (-0.07, 0.023)
    drag(editor, document, "winch:right", (0.022, -0.006), start=(0.02, -0.008))
    assert document.robot.winch("left").at == (-0.022, -0.006)
    drag(editor, document, "winch:feet", (0.01, -0.04), start=(0.0, -0.037))
    assert document.robot.winch("feet").at == (0.0, -0.04)
    first, second = (np.array(point) for point in starfish.cables[0].points[4:6])
    drag(editor, document, "cable:0", (0.1, 0.03), start=tuple(((first + second) / 2).tolist()))
    right, left = document.robot.cables[:2]
    assert len(left.points) == len(right.points) == len(starfish.cables[0].points) + 1
    assert np.allclose(np.array(left.points) * [-1, 1], right.points)
    editor.choose("cable:0")
    assert {item.key for item in editor.scene_items() if isinstance(item, Strand) and item.chosen} == {
        "cable:0",
        "cable:1",
    }
    editor.key("delete")
    assert len(document.robot.cables) == len(starfish.cables) - 2
    editor.set("winch:right", travel=0.05)
    assert document.robot.winch("left").travel == 0.05
    while document.undo():
        pass
    assert document.robot is starfish


def test_a_winch_is_deleted_with_its_cables_in_one_step(editor: Editor, document: Document, starfish: Robot) -> None:
    editor.click(on((-0.02, -0.008), "winch:left"))
    editor.key("delete")
    assert [cable.winch for cable in document.robot.cables] == ["right", "feet", "feet"]
    document.undo()
    assert document.robot is starfish


def test_what_is_refused_changes_nothing(editor: Editor, document: Document, starfish: Robot) -> None:
    refused = [
        lambda: editor.place("marker:top", (0.5, 0.5)),
        lambda: editor.rename("winch:left", "right"),
        lambda: editor.set("winch:left", spool_radius=-1.0),
        lambda: editor.set_gravity("-z"),
        lambda: editor.set_body(element_size=10.0),
        lambda: editor.set_body(material="cheese"),
        lambda: editor.mirror_about("z"),
    ]
    for action in refused:
        with pytest.raises(InputError):
            action()
        assert document.robot is starfish
    editor.choose("pin:0")
    with pytest.raises(InputError, match="last pin"):
        editor.key("delete")
    assert document.robot is starfish


def test_the_panel_changes_what_it_says(editor: Editor, document: Document, starfish: Robot) -> None:
    editor.rename("winch:left", "west")
    assert editor.selected_key == "winch:west"
    editor.place("marker:top", (0.01, 0.12))
    editor.set("cable:0", slack=0.003, friction=0.1)
    editor.set_gravity("-y")
    editor.set_body(thickness=0.03)
    robot = document.robot
    assert (robot.cables[1].winch, robot.markers[0].at, robot.cables[0].slack) == ("west", (0.01, 0.12), 0.003)
    assert (robot.gravity, robot.body.thickness) == ((0.0, -9.80665), 0.03)
    editor.set_body(element_size=0.016)
    assert len(document.robot.body.mesh.nodes) < len(starfish.body.mesh.nodes)
    assert document.undo_label == "change element size"
    assert document.robot.cables == robot.cables


@pytest.mark.parametrize("meanwhile", ["part", "body", "robot"])
def test_a_slow_mesh_loses_nothing(
    editor: Editor, document: Document, starfish: Robot, monkeypatch: pytest.MonkeyPatch, meanwhile: str
) -> None:
    """Oracle: what was changed while the mesh was made is there after it; another body stays as it is."""
    thick = replace(starfish, body=replace(starfish.body, thickness=0.05))

    def slowly(robot: Robot, **values: Any) -> Body:
        made = remesh(robot, **values)
        if meanwhile == "part":
            editor.place("marker:top", (0.01, 0.12))
        elif meanwhile == "body":
            editor._document.change("thicker", robot=thick)
        else:
            document.open(Work(robot=thick))
        return made

    monkeypatch.setattr("hydrostat.studio.editing.editor.remesh", slowly)
    if meanwhile == "part":
        editor.set_body(element_size=0.016)
        assert document.robot.markers[0].at == (0.01, 0.12)
        assert len(document.robot.body.mesh.nodes) < len(starfish.body.mesh.nodes)
    else:
        with pytest.raises(InputError, match="the body changed meanwhile"):
            editor.set_body(element_size=0.016)
        assert document.robot is thick


@pytest.mark.parametrize("number", [-1.0, 0.0, 1e-9, 1e9, float("nan"), float("inf")])
def test_absurd_numbers_are_refused_in_one_line(editor: Editor, document: Document, number: float) -> None:
    """Oracle: one short line, and the robot as it was."""
    before = document.robot
    asked = [
        lambda: editor.set_body(element_size=number),
        lambda: editor.set_body(thickness=number),
        lambda: editor.set("winch:left", spool_radius=number),
        lambda: editor.place("marker:top", (number, 1e3)),
        lambda: editor.set("cable:0", stiffness=-abs(number)),
    ]
    for action in asked:
        with pytest.raises(InputError) as refused:
            action()
        assert "\n" not in str(refused.value)
        assert len(str(refused.value)) < 300
        assert document.robot is before


def test_the_check_waits_until_the_robot_rests(editor: Editor, document: Document, starfish: Robot) -> None:
    heard: list[Topic] = []
    document.bell.listen(heard.append)
    editor.step(0.0)
    assert editor.findings is None
    editor.step(QUIET / 2)
    assert editor.findings is None
    editor.step(QUIET)
    assert editor.findings == look_over(starfish)
    assert set(heard) == {Topic.JOB, Topic.SCENE}
    document.change("shorter", robot=replace(starfish, cables=starfish.cables[:1]))
    assert editor.findings is None
    editor.step(10.0)
    editor.step(11.0)
    assert editor.findings is not None
    assert editor.findings.cable_length == pytest.approx(starfish.cables[0].length)


def test_all_that_is_shown_makes_a_picture(editor: Editor, document: Document) -> None:
    editor.mirror_about("x")
    editor.take(Tool.CABLE)
    editor.click(on((0.03, 0.015)))
    editor.click(on((0.05, 0.02)))
    items = editor.scene_items()
    assert {item.key for item in items if isinstance(item, Dot)} >= {"via:0:1", "winch:left", "pin:0", ""}
    assert Picture(document.robot, items, 1).scene()
    assert editor.key("v")
    assert editor.tool is Tool.MOVE
    assert not editor.key("q")


def test_several_parts_move_copy_and_go_together(editor: Editor, document: Document, starfish: Robot) -> None:
    """Oracle: places of before, and the way."""
    markers = [f"marker:{marker.name}" for marker in starfish.markers[:2]]
    editor.click(on(starfish.markers[0].at, markers[0]))
    editor.click(replace(on(starfish.markers[1].at, markers[1]), shift=True))
    assert editor.selection == tuple(markers)
    start = starfish.markers[0].at
    way = tuple((-0.02 * np.array(start)).tolist())
    drag(editor, document, markers[0], tuple(np.add(start, way).tolist()), start=start)
    moved = [marker.at for marker in document.robot.markers[:2]]
    assert moved == [pytest.approx(np.add(marker.at, way), abs=2e-4) for marker in starfish.markers[:2]]
    assert document.undo_label == "move 2 parts"
    document.undo()
    editor.key("duplicate")
    assert len(document.robot.markers) == len(starfish.markers) + 2
    assert [key.startswith("marker:") for key in editor.selection] == [True, True]
    assert not set(editor.selection) & set(markers)
    editor.key("delete")
    assert document.robot.markers == starfish.markers
    editor.click(on(start, markers[0]))
    editor.click(replace(on(start, markers[0]), shift=True))
    assert editor.selection == (), "a second click takes it out again"


def test_a_finger_chooses_several_without_shift(editor: Editor, document: Document, starfish: Robot) -> None:
    """Oracle: the selection; the next press beside all parts clears it, the switch stays."""
    markers = [(marker.at, f"marker:{marker.name}") for marker in starfish.markers[:2]]
    editor.choose_several(True)
    for at, key in markers:
        editor.click(on(at, key))
    assert editor.selection == tuple(key for _, key in markers)
    start = markers[0][0]
    drag(editor, document, markers[0][1], tuple((0.98 * np.array(start)).tolist()), start=start)
    assert document.undo_label == "move 2 parts"
    editor.click(on(*markers[1]))
    assert editor.selection == (markers[0][1],), "pressed again it is taken out"
    editor.click(on((0.0, 0.0)))
    assert editor.selection == ()
    editor.choose_several(False)
    for at, key in markers:
        editor.click(on(at, key))
    assert editor.selection == (markers[1][1],)


def test_a_winch_is_pasted_with_its_cables(editor: Editor, document: Document, starfish: Robot) -> None:
    winch = starfish.winches[0]
    own = [cable for cable in starfish.cables if cable.winch == winch.name]
    assert own
    editor.choose(f"winch:{winch.name}")
    editor.key("copy")
    editor.key("paste")
    robot = document.robot
    new = robot.winches[-1]
    assert new.name not in {other.name for other in starfish.winches}
    copies = [cable for cable in robot.cables if cable.winch == new.name]
    ways = [
        np.subtract(new.at, winch.at),
        *(np.subtract(a.points, b.points)[-1] for a, b in zip(copies, own, strict=True)),
    ]
    assert all(np.allclose(way, ways[0], atol=1e-9) for way in ways)
    assert np.linalg.norm(ways[0]) > 1e-3
    assert document.undo_label == f"paste {1 + len(own)} parts"
    editor.key("all")
    assert len(editor.selection) == sum(map(len, (robot.pins, robot.winches, robot.cables, robot.markers)))
    with pytest.raises(InputError, match="last pin"):
        editor.key("delete")


def test_arrows_nudge_in_one_step_to_undo(editor: Editor, document: Document, starfish: Robot) -> None:
    editor.choose("marker:top")
    before = starfish.markers[0].at
    for name in ("arrowleft", "arrowdown", "arrowdown", "shift arrowdown"):
        assert editor.key(name)
    assert document.robot.markers[0].at == pytest.approx((before[0] - 1e-3, before[1] - 12e-3))
    document.undo()
    assert document.robot is starfish
    with pytest.raises(InputError):
        editor.nudge(1.0, 0)
    assert document.robot is starfish


def test_snapping_puts_parts_on_the_grid(editor: Editor, document: Document) -> None:
    editor.set_snap(5e-3)
    drag(editor, document, "marker:top", (0.0021, 0.1079), start=document.robot.markers[0].at)
    assert document.robot.markers[0].at == pytest.approx((0.0, 0.11), abs=1e-9)
    editor.take(Tool.MARKER)
    editor.click(on((0.0112, 0.0093)))
    assert document.robot.markers[-1].at == pytest.approx((0.01, 0.01), abs=1e-9)
    with pytest.raises(InputError, match="snapping"):
        editor.set_snap(-1.0)


def test_the_ruler_measures_between_parts_and_places(editor: Editor, document: Document) -> None:
    editor.take(Tool.RULER)
    assert not editor.grab(on((0.0, 0.0), "marker:top")), "it drags nothing"
    at = document.robot.markers[0].at
    editor.click(on((0.003, 0.1), "marker:top"))
    editor.click(on((at[0] - 0.03, at[1] - 0.04)))
    assert editor.ruler is not None
    assert editor.ruler.words == "50.0 mm (x 30.0, y 40.0)"
    assert "50.0 mm" in [item.label for item in editor.scene_items() if isinstance(item, Dot)]
    editor.click(on((0.0, 0.0)))
    assert editor.ruler.words == "", "it begins again"
    editor.take(Tool.MOVE)
    assert editor.ruler is None
