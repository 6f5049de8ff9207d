"""The panel of the stage "start", and the window around all panels. The oracle is the gallery and the session."""

from pathlib import Path

from desk import Desk, at_desk

from hydrostat.robot import Robot, list_gallery, load_robot, save_robot
from hydrostat.studio.face.tour import KEYS, STAGES
from hydrostat.studio.session import Tone
from hydrostat.studio.stage import StageName


def test_a_robot_of_the_gallery_is_opened() -> None:
    async def act(desk: Desk) -> None:
        assert [name for name in list_gallery() if not desk.all(f"gallery-{name}")] == []
        assert [stage for stage in StageName if desk.one(f"stage-{stage}").enabled] == [StageName.START]
        await desk.press("gallery-starfish")
        await desk.until(lambda: desk.session.stage is StageName.POSE)
        assert desk.robot.name == "starfish"
        assert all(desk.one(f"stage-{stage}").enabled for stage in StageName)
        for stage in (*StageName, StageName.START):
            await desk.press(f"stage-{stage}")
            assert desk.session.stage is stage

    at_desk(None, act)


def test_work_that_is_not_saved_is_not_left_without_asking(starfish: Robot, tmp_path: Path) -> None:
    save_robot(starfish, tmp_path / "other")

    async def act(desk: Desk) -> None:
        desk.session.editor.rename("marker:top", "tip")
        changed = desk.robot
        await desk.choose("folder", str(tmp_path / "other"))
        await desk.press("folder-open")
        await desk.press("leave-no")
        assert desk.robot is changed
        await desk.press("folder-open")
        await desk.press(desk.all("leave-yes")[-1])
        await desk.until(lambda: desk.session.stage is StageName.POSE)
        assert "tip" not in {marker.name for marker in desk.robot.markers}

    at_desk(starfish, act)


def test_work_that_is_not_saved_is_saved_on_the_way_out(starfish: Robot, tmp_path: Path) -> None:
    save_robot(starfish, tmp_path / "mine")
    save_robot(starfish, tmp_path / "other")

    async def act(desk: Desk) -> None:
        desk.session.open_folder(tmp_path / "mine")
        desk.session.editor.rename("marker:top", "tip")
        desk.go(StageName.START)
        await desk.choose("folder", str(tmp_path / "other"))
        await desk.press("folder-open")
        await desk.press("leave-save")
        await desk.until(lambda: desk.session.document.folder == tmp_path / "other")
        assert "tip" in {marker.name for marker in load_robot(tmp_path / "mine").markers}

    at_desk(starfish, act)


def test_save_as_goes_to_another_folder(starfish: Robot, tmp_path: Path) -> None:
    save_robot(starfish, tmp_path / "mine")

    async def act(desk: Desk) -> None:
        desk.session.open_folder(tmp_path / "mine")
        await desk.press("save-as")
        assert desk.one("save-folder").value == str(tmp_path / "mine_2"), "not over the robot that it is a copy of"
        await desk.choose("save-folder", str(tmp_path / "yours"))
        await desk.press("save-now")
        await desk.until(lambda: desk.session.document.folder == tmp_path / "yours")
        assert load_robot(tmp_path / "yours").name == "starfish"

    at_desk(starfish, act)


def test_notes_do_not_pile_up(starfish: Robot) -> None:
    async def act(desk: Desk) -> None:
        toasts = desk.page.toasts
        with desk.client:
            for text in ("undone: a", "undone: b", "undone: c"):
                toasts.show(text)
            assert toasts.words == ["undone: c"]
            for text in ("wrong 1", "wrong 2", "wrong 3", "wrong 3"):
                toasts.show(text, Tone.BAD)
            assert toasts.words == ["wrong 2", "wrong 3"]

    at_desk(starfish, act)


def test_a_folder_without_a_robot_is_told(tmp_path: Path) -> None:
    async def act(desk: Desk) -> None:
        await desk.choose("folder", str(tmp_path / "none"))
        await desk.press("folder-open")
        await desk.until(lambda: bool(desk.told))
        assert desk.session.stage is StageName.START

    at_desk(None, act)


def test_an_outline_is_drawn_and_becomes_a_draft() -> None:
    async def act(desk: Desk) -> None:
        starter = desk.session.starter
        await desk.press("outline-new")
        assert not desk.one("outline-done").enabled
        corners = [[-50, -30, False], [50, -30, False], [50, 30, True], [-50, 30, False]]
        await desk.press("back")
        assert starter.outlining is None
        await desk.press("outline-new")
        assert starter.outlining is not None
        (editor,) = [own for own in desk.client.elements.values() if type(own).__name__ == "OutlineEditor"]
        await desk.press(editor, "change", [corners])
        assert "4 corners" in desk.one("outline-words").text
        await desk.press(editor, "change", "nonsense")  # refused
        assert desk.told
        await desk.press("outline-done")
        await desk.until(lambda: bool(desk.begun))
        assert starter.draft is not None
        assert starter.draft.file == "outline.svg"

    at_desk(None, act)


def test_a_surface_is_meshed_once_as_it_came() -> None:
    async def act(desk: Desk) -> None:
        starter = desk.session.starter
        starter.bring("ball.stl", b"solid ball\nendsolid\n")
        await desk.follow()
        assert desk.one("make-robot").enabled is False
        assert starter.draft is not None
        assert starter.draft.inflate is None  # only a drawing can be blown up
        assert len(desk.begun) == 1

    at_desk(None, act)


def test_saving_asks_where_and_help_lists_all_keys(starfish: Robot, tmp_path: Path) -> None:
    async def act(desk: Desk) -> None:
        words = desk.words
        assert [line.line for line in STAGES.values() if line.line not in words] == []
        assert [what for _, what in KEYS if what not in words] == []
        assert desk.one("Save").enabled
        await desk.press("Save")
        await desk.choose("save-folder", str(tmp_path / "mine"))
        await desk.press("save-now")
        await desk.until(lambda: desk.session.document.folder is not None)
        assert (tmp_path / "mine" / "robot.toml").is_file()

    at_desk(starfish, act)
