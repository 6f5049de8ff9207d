"""Parts placed by keys alone. Oracles: the robot of the document, undo, and the words for a screen reader."""

from collections.abc import Iterator

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.robot import Robot
from hydrostat.studio.editing.editor import Editor, Tool
from hydrostat.studio.editing.part import keys_of
from hydrostat.studio.face.view_words import describe_view
from hydrostat.studio.session import Session
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Dot, Look

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture
def session(starfish: Robot) -> Iterator[Session]:
    made = Session()
    made.document.open(Work(robot=starfish))
    made.go("edit")
    yield made
    made.close()


@pytest.fixture
def editor(session: Session) -> Editor:
    return session.editor


def press(editor: Editor, *names: str) -> None:
    for name in names:
        assert editor.key(name), name


def crosses(editor: Editor) -> list[str]:
    return [item.label for item in editor.scene_items() if isinstance(item, Dot) and item.look is Look.TARGET]


@pytest.mark.parametrize(("letter", "kind"), [("p", "pin"), ("m", "marker"), ("w", "winch")])
def test_enter_places_a_part_in_one_step_to_undo(
    session: Session, editor: Editor, starfish: Robot, letter: str, kind: str
) -> None:
    editor.choose("marker:top")
    press(editor, letter, "enter")
    start = starfish.markers[0].at
    assert editor.cross_hair.at == start, "it begins at the selected part"
    press(editor, "arrowdown", "arrowdown", "shift arrowdown", "arrowleft", "enter")
    before = set(keys_of(starfish))
    (key,) = set(keys_of(session.document.robot)) - before
    assert key.startswith(kind)
    assert editor.selected_key == key
    parts = {"pin": "pins", "marker": "markers", "winch": "winches"}
    placed = getattr(session.document.robot, parts[kind])[-1]
    assert placed.at == pytest.approx((start[0] - 0.001, start[1] - 0.012))
    press(editor, "shift arrowdown", "enter")
    session.undo()
    assert len(set(keys_of(session.document.robot)) - before) == 1
    session.undo()
    assert session.document.robot is starfish


def test_a_cable_by_keys_is_one_step_to_undo(session: Session, editor: Editor, starfish: Robot) -> None:
    winch = starfish.winches[0]
    editor.choose(f"winch:{winch.name}")
    press(editor, "c", "enter", "enter")
    press(editor, *["arrowright"] * 6, "enter", "shift arrowright", "enter")
    assert "Cable of 3 points" in describe_view(session)
    press(editor, "enter")  # once more at the same place: the end
    assert editor.draft is None
    cable = session.document.robot.cables[-1]
    assert cable.winch == winch.name
    ways = np.diff(np.array(cable.points), axis=0)
    assert ways == pytest.approx(np.array([[0.006, 0.0], [0.01, 0.0]]), abs=2e-4)
    session.undo()
    assert session.document.robot is starfish


def test_the_state_is_told_and_escape_ends_it(session: Session, editor: Editor) -> None:
    assert not editor.key("enter"), "the tool that moves has no cross-hair"
    press(editor, "m", "enter")
    words = editor.cross_hair.words
    assert describe_view(session).endswith(f"Cross-hair: {words}.")
    assert crosses(editor) == [words]
    before = session.document.robot
    press(editor, *["shift arrowright"] * 40)
    assert "outside the body" in describe_view(session)
    with pytest.raises(InputError, match="no body here"):
        editor.key("enter")
    right = before.body.mesh.nodes[:, 0].max()
    assert editor.cross_hair.at is not None
    assert editor.cross_hair.at[0] == pytest.approx(right, abs=1e-4), "it stays near the body"
    press(editor, "escape")
    assert (editor.tool, editor.cross_hair.at, crosses(editor)) == (Tool.MOVE, None, [])
    assert session.document.robot is before
    editor.choose("marker:top")
    press(editor, "arrowup")
    assert session.document.undo_label == "nudge marker top"


def test_a_click_of_the_pointer_hides_it(editor: Editor, session: Session, starfish: Robot) -> None:
    """Enter then finishes the cable of the pointer, without a point at the old place."""
    press(editor, "m", "enter", "c")
    assert editor.cross_hair.at is None, "another tool was taken"
    press(editor, "enter")
    winch = starfish.winches[0]
    for key, way in ((f"winch:{winch.name}", 0.0), ("body", 0.006), ("body", 0.016)):
        at = (winch.at[0] + way, *winch.at[1:])
        session.click("screen", Hit(key=key, rest=at, world=at))
        assert editor.cross_hair.at is None
    press(editor, "enter")
    assert editor.draft is None
    assert len(session.document.robot.cables[-1].points) == 3
    session.undo()
    assert session.document.robot is starfish


@pytest.mark.parametrize("way_back", [(), ("shift arrowright", "shift arrowup", "shift arrowup")])
def test_enter_at_the_last_or_first_corner_ends_a_region(
    session: Session, editor: Editor, way_back: tuple[str, ...]
) -> None:
    press(editor, "b", "enter", "enter", "enter")
    assert len(editor.brush.drawn.corners) == 1, "a second Enter in place sets no corner"
    press(editor, "shift arrowdown", "shift arrowdown", "enter", "shift arrowleft", "enter")
    assert len(editor.brush.drawn.corners) == 3
    press(editor, *way_back, "enter")
    assert editor.brush.drawn.corners == ()
    (part,) = session.document.robot.body.parts
    assert len(part.points or ()) == 3


def test_it_is_hidden_in_another_body_and_another_stage(session: Session, editor: Editor) -> None:
    press(editor, "m", "enter")
    session.document.open(Work(robot=gallery_robot("pig")))
    assert editor.cross_hair.words == ""
    press(editor, "enter")
    session.go("pose")
    assert editor.cross_hair.at is None


def test_in_space_page_keys_move_it_in_depth(session: Session, editor: Editor) -> None:
    session.document.open(Work(robot=gallery_robot("tongue")))
    press(editor, "m", "enter")
    start = editor.cross_hair.at
    assert start is not None
    press(editor, "pageup", "arrowup", "enter")
    placed = session.document.robot.markers[-1].at
    assert placed == pytest.approx((start[0], start[1] + 0.001, start[2] + 0.001), abs=1e-4)
