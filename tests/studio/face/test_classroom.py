"""What a teacher decides. Oracles: robots of the rooms, files of the zip."""

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import pytest

from hydrostat.errors import InputError
from hydrostat.fabrication import KitOptions
from hydrostat.project import Work
from hydrostat.robot import Robot, gallery_folder, load_robot
from hydrostat.studio.exporting.class_work import PupilWork, pack_class
from hydrostat.studio.face.classroom import Classroom
from hydrostat.studio.face.rooms import Room, Rooms, clean_name, new_key
from hydrostat.studio.stage import Hit
from hydrostat.studio.starting.starter import unpack_robot


@pytest.fixture(scope="module")
def starfish() -> Robot:
    return load_robot(gallery_folder("starfish"))


@pytest.fixture
def classroom(tmp_path: Path) -> Iterator[Classroom]:
    made = Classroom(Rooms(state=tmp_path, first=gallery_folder("starfish")))
    yield made
    made.close()
    made.rooms.close()


def enter(classroom: Classroom, *names: str) -> list[Room]:
    return [classroom.rooms.enter(new_key(), name=name) for name in names]


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("  Ada   B\n", "Ada B"),
        ("\u202eadA\u200b", "adA"),  # turned around; an unseen letter
        ("Z\u0300\u0301\u0302o", "Zo"),  # marks that pile up
        ("<b>", "<b>"),  # harmless: it is text wherever it is shown
        ("x" * 99, "x" * 24),
    ],
)
def test_a_nickname_is_letters_that_are_seen(text: str, name: str) -> None:
    assert clean_name(text) == name


def test_only_a_given_nickname_is_stored(classroom: Classroom, starfish: Robot, tmp_path: Path) -> None:
    """Oracle: a name typed in a later lesson wins over the one that a room without a name was shown with."""
    nameless, ada = enter(classroom, "", "Ada")
    for room in (nameless, ada):
        room.session.document.change("rename", robot=replace(starfish, name="mine"))
    classroom.rooms.close()
    (file,) = (path for path in tmp_path.glob("rooms/*/work/*/*/meta.json") if "Ada" in path.read_text())
    file.write_text(file.read_text().replace("Ada", "\\u200b"))  # damaged
    later = Rooms(state=tmp_path)
    assert [later.enter(room.key, name=name).name for room, name in ((nameless, "Bo"), (ada, ""))] == ["Bo", "Pupil"]
    later.close()


def test_looking_for_earlier_robots_removes_nothing(classroom: Classroom, tmp_path: Path) -> None:
    empty = tmp_path / "rooms/other/work/1-a"
    empty.mkdir(parents=True)
    assert classroom.rooms.list_earlier() == []
    assert empty.is_dir()


def test_nobody_takes_the_nickname_of_another(classroom: Classroom) -> None:
    first, second, third = enter(classroom, "Ada", "ada", "")
    assert [first.name, second.name, third.name] == ["Ada", "ada 2", "Pupil"]
    classroom.rooms.rename(second, "ADA")
    assert second.name == "ADA 2"
    with pytest.raises(InputError, match="nickname missing"):
        classroom.rooms.rename(second, " \u200b")


def test_locked_robots_stay_as_they_are(classroom: Classroom, starfish: Robot) -> None:
    (room,) = enter(classroom, "Ada")
    session = room.session
    session.document.change("rename", robot=replace(starfish, name="mine"))
    classroom.lock(True)
    (late,) = enter(classroom, "Late")
    assert late.session.is_locked
    assert not session.grab("screen", Hit(key="marker:top", world=(0.0, 0.1)))
    session.undo()
    assert session.key("r") is False
    for act in (
        lambda: session.editor.rename("marker:top", "tip"),
        lambda: session.starter.open_gallery(gallery_folder("starfish")),
    ):
        with pytest.raises(InputError, match="teacher has locked"):
            act()
    assert session.document.robot.name == "mine"
    classroom.lock(False)
    session.undo()
    assert session.document.robot.name == "starfish"


def test_a_robot_is_handed_out_and_undone(classroom: Classroom, starfish: Robot) -> None:
    mine = replace(starfish, name="mine")
    here, locked = enter(classroom, "Ada", "Bo")
    here.session.document.change("rename", robot=mine)
    classroom.lock(True)
    classroom.hand_out(Work(robot=replace(starfish, name="task")))
    (new,) = enter(classroom, "New")
    assert {room.session.document.robot.name for room in (here, locked, new)} == {"task"}
    assert here.session.is_locked
    classroom.lock(False)
    here.session.undo()
    assert here.session.document.robot is mine
    assert here.session.redo_label == "hand out task"
    assert here.session.notes[0].text == "your teacher handed out task. Undo brings your robot back"


def test_a_robot_that_a_hand_out_replaced_is_there_in_the_next_lesson(
    classroom: Classroom, starfish: Robot, tmp_path: Path
) -> None:
    """Oracle: names of robots, after a restart; a browser that forgot its room gets the robot from the teacher."""
    (ada,) = enter(classroom, "\U0001f4a9")
    classroom.rooms.rename(ada, "Ada")
    ada.session.document.change("rename", robot=replace(starfish, name="mine"))
    classroom.hand_out(Work(robot=replace(starfish, name="task")))
    assert [(left.owner, left.name) for left in classroom.rooms.list_earlier()] == [("Ada", "mine")]
    classroom.rooms.close()
    later = Classroom(Rooms(state=tmp_path, first=gallery_folder("starfish")))
    again = later.rooms.enter(ada.key, name="\U0001f4a9")
    assert (again.name, again.session.document.robot.name) == ("Ada", "task")
    assert [left.name for left in again.session.starter.autosave.find_recovered()] == ["mine"]
    (forgotten,) = enter(later, "Ada")
    (left,) = later.rooms.list_earlier()
    later.lock(True)
    later.give_back(forgotten, left)
    assert forgotten.session.document.robot.name == "mine"
    later.lock(False)
    forgotten.session.undo()
    assert forgotten.session.document.robot.name == "starfish"
    assert [left.name for left in later.rooms.list_earlier()] == ["mine"], "it is kept, and an untouched robot is not"
    later.rooms.close()


class Silent:
    def progress(self, stage: str, done: int, total: int) -> None: ...
    def part(self, value: object) -> None: ...
    def finish(self) -> None: ...


def test_a_class_takes_all_home(starfish: Robot) -> None:
    """Names that lead out of the folder, or that are one on some systems, are harmless; what fails is told."""
    bare = replace(starfish, winches=(), cables=(), poses={}, name="bare")
    names = ("../../Ada", "ada!", "ADA?")
    works = [PupilWork(name, Work(robot=bare), "", KitOptions()) for name in names]
    with ZipFile(BytesIO(pack_class(Silent(), works, kits=True, pages=False).content)) as made:
        files = sorted(made.namelist(), key=str.casefold)
        assert [file.casefold() for file in files] == [
            "class/ada/bare.zip", "class/ada_2/bare.zip", "class/ada_3/bare.zip", "class/class.txt"
        ]  # fmt: skip
        assert unpack_robot("bare.zip", made.read(files[0]))[0].robot.name == "bare"
        assert made.read("class/class.txt").decode().count("no kit: the robot has no cables") == 3


def test_an_error_or_stop_at_one_robot_loses_no_other(starfish: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    ends = iter([ValueError("odd"), KeyboardInterrupt()])

    def end(*_: object) -> None:
        raise next(ends)

    monkeypatch.setattr("hydrostat.studio.exporting.class_work._kit", end)
    monkeypatch.setattr("hydrostat.studio.exporting.class_work._page", lambda *_: ("page.html", b""))
    works = [PupilWork(name, Work(robot=starfish), "", KitOptions()) for name in ("Ada", "Bo", "Cy")]
    with ZipFile(BytesIO(pack_class(Silent(), works, kits=True, pages=True).content)) as made:
        told = made.read("class/class.txt").decode()
        assert sum(name.endswith("starfish.zip") for name in made.namelist()) == 3
        assert [name for name in made.namelist() if name.endswith(".html")] == ["class/Ada/page.html"]
    assert "no kit: ValueError('odd')" in told
    assert told.count("stopped") == 1
