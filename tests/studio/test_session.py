"""The session without a browser: who holds, who hears. The oracle is a stage that writes down what it is told."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

from hydrostat.errors import InputError
from hydrostat.project import Work
from hydrostat.robot import load_robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.session import Session, Tone
from hydrostat.studio.stage import Hit, Stage, StageName
from hydrostat.studio.view.coloring import Coloring
from hydrostat.studio.view.picture import parse_message
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape


class Diary(Stage):
    """A stage that writes down all it is told."""

    def __init__(self, session: Session) -> None:
        self.session, self.told, self.complaint = session, [], ""

    def shape(self) -> RobotShape:
        return rest_shape(self.session.document.robot)

    def scene_items(self) -> Sequence[SceneItem]:
        return []

    def enter(self) -> None:
        self.told.append("enter")

    def leave(self) -> None:
        self.told.append("leave")

    def grab(self, hit: Hit) -> bool:
        self.told.append(("grab", hit.key))
        return hit.key != ""

    def drag(self, hit: Hit) -> None:
        self.told.append(("drag", hit.world))

    def release(self) -> None:
        self.told.append("release")

    def click(self, hit: Hit) -> None:
        self.told.append(("click", hit.key))

    def key(self, name: str) -> bool:
        self.told.append(("key", name))
        return name == "r"

    def step(self, now: float) -> bool:
        if self.complaint:
            raise InputError(self.complaint)
        return False


@pytest.fixture(scope="module")
def work() -> Work:
    return Work(robot=gallery_robot("starfish"))


@pytest.fixture
def session(work: Work) -> Session:
    made = Session()
    made.document.open(work)
    made.stages = {name: Diary(made) for name in StageName}
    made.go(StageName.POSE)
    return made


def diary(session: Session) -> list:
    stage = session.current
    assert isinstance(stage, Diary)
    return stage.told


BODY = Hit(key="body", rest=(0.0, 0.0), world=(0.0, 0.0))
NOTHING = Hit(world=(0.0, 0.0))


def there(x: float) -> Hit:
    return Hit(world=(x, 0.0))


def test_without_a_robot_there_is_only_the_start() -> None:
    empty = Session()
    assert empty.current_view() is None
    assert not empty.step(0.0)
    assert not empty.grab("a", BODY)
    with pytest.raises(InputError, match="no robot is open"):
        empty.go(StageName.EDIT)
    assert empty.stage is StageName.START


def test_one_screen_at_a_time_holds(session: Session) -> None:
    assert session.grab("a", BODY)
    assert not session.grab("b", BODY)
    session.drag("b", there(2.0))
    session.drag("a", there(1.0))
    session.release("b")
    session.drag("a", there(3.0))
    session.release("a")
    session.drag("a", there(4.0))
    assert session.grab("b", BODY)
    assert diary(session) == [
        "enter", ("grab", "body"), ("drag", (1.0, 0.0)), ("drag", (3.0, 0.0)), "release", ("grab", "body"),
    ]  # fmt: skip
    assert any("another window" in note.text for note in session.notes)


def test_a_screen_that_is_gone_lets_go(session: Session) -> None:
    session.grab("a", BODY)
    session.release("a")
    assert diary(session)[-1] == "release"
    assert session.grab("b", BODY)


def test_what_is_not_held_is_not_dragged(session: Session) -> None:
    assert not session.grab("a", NOTHING)
    session.drag("a", there(1.0))
    session.release("a")
    assert diary(session) == ["enter", ("grab", "")]


def test_another_stage_lets_go_first(session: Session) -> None:
    session.grab("a", BODY)
    before = diary(session)
    session.go(StageName.DRIVE)
    assert before[-2:] == ["release", "leave"]
    assert diary(session) == ["enter"]


def test_the_stage_that_is_shown_already_lets_go_of_nothing(session: Session) -> None:
    """A click on its button may come late, when a drag has begun; a second window may click it at any time."""
    session.grab("a", BODY)
    rung: list[Topic] = []
    session.bell.listen(rung.append)
    session.go(StageName.POSE)
    assert rung == []
    session.drag("a", there(1.0))
    assert diary(session) == ["enter", ("grab", "body"), ("drag", (1.0, 0.0))]


def test_a_drag_is_one_step_to_undo(session: Session, work: Work) -> None:
    class Mover(Diary):
        def drag(self, hit: Hit) -> None:
            robot = self.session.document.robot
            from dataclasses import replace

            self.session.document.change("move", robot=replace(robot, name=f"at_{hit.world[0]:.0f}"), merge="move")

    session.stages = {**session.stages, StageName.POSE: Mover(session)}
    for drag in range(2):
        session.grab("a", BODY)
        for x in range(5):
            session.drag("a", there(10.0 * drag + x))
        session.release("a")
    assert session.document.robot.name == "at_14"
    session.undo()
    assert session.document.robot.name == "at_4"
    session.undo()
    assert session.document.robot is work.robot
    session.redo()
    assert session.document.robot.name == "at_4"


def test_a_frame_says_which_drag_it_answers(session: Session) -> None:
    session.grab("a", BODY, 100.0)
    session.step(0.0)
    session.drag("a", there(1.0), 200.0)
    shown = session.current_view()
    assert shown is not None
    assert parse_message(shown.frame)[0]["stamp"] == 100.0
    session.step(0.1)
    shown = session.current_view()
    assert shown is not None
    assert parse_message(shown.frame)[0]["stamp"] == 200.0


def test_a_step_that_fails_again_and_again_complains_once(session: Session) -> None:
    stage = session.current
    assert isinstance(stage, Diary)
    stage.complaint = "the pose is lost; press R"
    for now in range(20):
        assert not session.step(float(now))
    assert [note.text for note in session.notes if note.tone is Tone.BAD] == [stage.complaint]
    stage.complaint = ""
    session.step(30.0)
    stage.complaint = "the pose is lost; press R"
    session.step(31.0)
    assert len([note for note in session.notes if note.tone is Tone.BAD]) == 2


def test_undo_tells_what_it_took_back(session: Session, work: Work) -> None:
    session.document.change("add marker ear", robot=work.robot)
    session.undo()
    session.undo()
    assert [note.text for note in session.notes][-2:] == ["undone: add marker ear", "nothing to undo"]


def test_the_same_picture_keeps_its_scene(session: Session) -> None:
    first, second = session.current_view(), session.current_view()
    assert first is not None
    assert second is not None
    assert first.serial == second.serial
    head, arrays = parse_message(second.frame)
    assert head["scene"] == first.serial
    assert np.allclose(arrays["nodes"][:, :2], session.document.robot.body.mesh.nodes, atol=1e-6)


def test_save_asks_for_a_folder_and_then_knows_it(session: Session, work: Work, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="folder"):
        session.save()
    session.document.change("rename", robot=work.robot)
    assert not session.document.is_saved
    session.save(tmp_path / "mine")
    assert session.document.is_saved
    assert load_robot(tmp_path / "mine") == work.robot
    session.save()
    assert session.document.folder == tmp_path / "mine"


def test_listeners_hear_of_notes_and_stages(session: Session) -> None:
    heard: set[Topic] = set()
    session.bell.listen(heard.add)
    session.go(StageName.EDIT)
    session.tell("hello")
    assert {Topic.STAGE, Topic.NOTE} <= heard


def test_work_that_cannot_be_kept_is_told_once(session: Session) -> None:
    session.starter.autosave.problem = "the disk is full"
    for now in range(5):
        session.step(float(now))
    assert [note.text for note in session.notes].count("the disk is full") == 1


def test_what_a_page_names_must_be_of_its_set() -> None:
    session = Session()
    session.document.open(Work(robot=gallery_robot("starfish")))
    for call in (session.go, session.color_by, session.editor.take, session.poser.set_mode):
        before = session.stage, session.coloring, session.editor.tool, session.poser.mode
        with pytest.raises(InputError, match=r'must be one of .*, not "nonsense"'):
            call("nonsense")
        assert (session.stage, session.coloring, session.editor.tool, session.poser.mode) == before
    session.color_by("strain")
    assert session.coloring is Coloring.STRAIN
