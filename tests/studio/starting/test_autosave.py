"""Work that was not saved comes back after a crash."""

import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path
from typing import IO

import pytest

from hydrostat.files import lock_file
from hydrostat.project import Work
from hydrostat.robot import Marker, gallery_folder, load_robot
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.starting.autosave import (
    AGAIN,
    MAX_ASIDE,
    MAX_DELAY,
    QUIET_TIME,
    Autosave,
    HeldFolder,
    find_left,
    is_held,
)

CRASHES = """
import sys
from pathlib import Path
from dataclasses import replace
from hydrostat.robot import Marker, gallery_folder, load_robot
from hydrostat.studio.session import Session

session = Session(Path(sys.argv[1]))
robot = load_robot(gallery_folder("letter_e"))
session.starter.open_gallery(gallery_folder("letter_e"))
new = Marker(name="new", at=robot.pins[0].at)
session.document.change("add marker", robot=replace(robot, markers=(*robot.markers, new)))
clock = 0.0
while not any(path.parent.name.isdecimal() for path in Path(sys.argv[1]).glob("work/*/*/meta.json")):  # whole
    session.step(clock)
    clock += 0.05
print("kept", flush=True)
sys.stdin.read()
"""


def opened(folder: Path | None) -> tuple[Document, Autosave]:
    document = Document(Bell())
    return document, Autosave(document, folder)


def changed(document: Document, name: str) -> None:
    robot = document.robot
    document.change("rename", robot=replace(robot, name=name))


def settle(autosave: Autosave, now: float) -> None:
    """A step, and the end of what it began."""
    autosave.step(now)
    if autosave._writer is not None:
        autosave._writer.join()


@pytest.fixture
def work() -> Work:
    return Work(robot=load_robot(gallery_folder("letter_e")))


@pytest.mark.slow
def test_what_a_killed_studio_leaves_is_restored(tmp_path: Path) -> None:
    """Oracle: the change that was made before kill -9, made here again; the robot had never been saved."""
    process = subprocess.Popen(
        [sys.executable, "-c", CRASHES, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == b"kept\n"
        document, autosave = opened(tmp_path / "work")
        assert autosave.find_recovered() == [], "it lives"
        os.kill(process.pid, signal.SIGKILL)
    finally:
        process.kill()
        process.communicate()
    (left,) = autosave.find_recovered()
    assert left.words.endswith(": letter_e")
    autosave.restore(left)
    robot = load_robot(gallery_folder("letter_e"))
    assert robot.pins[0].at is not None
    assert document.robot == replace(robot, markers=(*robot.markers, Marker(name="new", at=robot.pins[0].at)))
    assert document.folder is None
    assert not document.is_saved
    assert autosave.find_recovered() == [], "it is kept by the studio that restored it"
    autosave.close()
    (again,) = autosave.find_recovered()
    autosave.forget(again)
    assert autosave.find_recovered() == []


def test_work_is_kept_when_changes_pause(tmp_path: Path, work: Work) -> None:
    """Oracle: files on the disk, at times of a clock that the test tells."""
    document, autosave = opened(tmp_path)
    document.open(work)
    settle(autosave, 0.0)
    settle(autosave, 100.0)
    assert list(tmp_path.glob("*/*/meta.json")) == [], "what is saved needs no keeping"
    changed(document, "first")
    settle(autosave, 100.0)
    settle(autosave, 100.0 + 0.9 * QUIET_TIME)
    assert list(tmp_path.glob("*/*/meta.json")) == []
    settle(autosave, 100.1 + QUIET_TIME)
    assert len(list(tmp_path.glob("*/*/meta.json"))) == 1
    for second in range(int(MAX_DELAY) + 2):
        changed(document, f"change {second}")
        settle(autosave, 200.0 + second)
    (kept,) = tmp_path.glob("*/*/work")
    assert load_robot(kept).name == f"change {int(MAX_DELAY)}", "without a pause it is kept now and then"
    autosave.close()


def test_saving_ends_keeping(tmp_path: Path, work: Work) -> None:
    """Oracle: the folder is empty."""
    document, autosave = opened(tmp_path / "state")
    document.open(work, saved=False)
    settle(autosave, 0.0)
    settle(autosave, 3.0)
    assert len(list((tmp_path / "state").iterdir())) == 1
    document.mark_saved(tmp_path / "robot", document.work)
    settle(autosave, 3.1)
    assert list((tmp_path / "state").iterdir()) == []


def test_closing_keeps_what_is_not_saved(tmp_path: Path, work: Work) -> None:
    """Oracle: the last change, though there was no pause after it; and where the robot had been saved."""
    document, autosave = opened(tmp_path)
    document.open(work, folder=tmp_path / "robot")
    changed(document, "last words")
    autosave.close()
    (left,) = opened(tmp_path)[1].find_recovered()
    assert (left.name, left.origin) == ("last words", tmp_path / "robot")


def test_half_written_and_foreign_things_are_not_offered(tmp_path: Path) -> None:
    """Oracle: nothing is offered, nothing fails, and empty folders of studios that are gone are removed."""
    for name in ("gone/3.part/work", "gone/2", "broken/1/work", "list/1/work"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "broken/1/meta.json").write_text("{")
    (tmp_path / "list/1/meta.json").write_text("[]")
    (tmp_path / "list/1/work/robot.toml").write_text("")
    (tmp_path / "file").write_text("")
    _, autosave = opened(tmp_path)
    assert autosave.find_recovered() == []
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_folder_that_is_being_made_is_not_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Oracle: it is there and held, though another thread looks for left work before it is locked."""
    looks = [threading.Thread(target=find_left, args=([tmp_path],))]

    def lock_late(file: IO[bytes]) -> None:
        if threading.current_thread() is threading.main_thread() and looks[0].ident is None:
            looks[0].start()
            looks[0].join(0.2)
        lock_file(file)

    monkeypatch.setattr("hydrostat.studio.starting.autosave.lock_file", lock_late)
    held = HeldFolder(tmp_path)
    looks[0].join()
    assert is_held(held.path)
    held.let_go()


def test_only_what_was_changed_is_set_aside_and_not_for_ever(tmp_path: Path, work: Work) -> None:
    """Oracle: names of what is left, the newest first."""
    document, autosave = opened(tmp_path)
    document.open(work, saved=False)
    for number in range(MAX_ASIDE + 2):
        changed(document, f"mine_{number}")
        autosave.set_aside()
        changed(document, "task")
        autosave.note_received()
        autosave.set_aside()
    names = [left.name for left in autosave.find_recovered()]
    assert names == [f"mine_{number}" for number in range(MAX_ASIDE + 1, 1, -1)]


def test_a_disk_that_cannot_be_written_is_no_reason_to_stop(tmp_path: Path, work: Work) -> None:
    """Oracle: no error leaves it."""
    (tmp_path / "state").write_text("a file where the folder should be")
    document, autosave = opened(tmp_path / "state")
    document.open(work, saved=False)
    settle(autosave, 0.0)
    settle(autosave, 10.0)
    autosave.close()
    assert autosave.find_recovered() == []


def test_why_nothing_is_kept_is_told_and_tried_again(
    tmp_path: Path, work: Work, caplog: pytest.LogCaptureFixture
) -> None:
    """Oracle: the problem while a file is where the folder should be; none, and a copy, soon after it is gone."""
    state = tmp_path / "state"
    state.write_text("a file where the folder should be")
    document, autosave = opened(state)
    document.open(work, saved=False)
    settle(autosave, 0.0)
    settle(autosave, QUIET_TIME)
    assert autosave.problem
    assert autosave.problem.endswith(": Not a directory")
    assert [(line.getMessage(), line.exc_info) for line in caplog.records] == [(autosave.problem, None)]
    state.unlink()
    settle(autosave, QUIET_TIME + 0.9 * AGAIN)
    assert autosave.problem
    settle(autosave, QUIET_TIME + AGAIN)
    assert autosave.problem == ""
    assert len(list(state.glob("*/*/meta.json"))) == 1
    autosave.close()


def test_work_goes_on_and_is_kept_as_often_as_said(tmp_path: Path, work: Work) -> None:
    """Oracle: changes four times a second for 60 s; a copy each `MAX_DELAY`."""
    document, autosave = opened(tmp_path)
    document.open(work, saved=False)
    kept = set()
    for beat in range(240):
        changed(document, f"change_{beat}")
        settle(autosave, beat / 4)
        kept |= {path.parent.name for path in tmp_path.glob("*/*/meta.json")}
    assert 60 / MAX_DELAY - 2 <= len(kept) <= 60 / MAX_DELAY + 1
    autosave.close()


@pytest.mark.parametrize("touched", [False, True])
def test_what_others_wrote_after_a_crash_is_asked_about(tmp_path: Path, work: Work, touched: bool) -> None:
    """Oracle: doubts about the folder of the robot; none if nobody touched it."""
    home = tmp_path / "robot"
    work.save(home)
    document, autosave = opened(tmp_path / "state")
    document.open(work, folder=home)
    changed(document, "mine")
    autosave.close()
    if touched:
        (home / "robot.toml").write_text((home / "robot.toml").read_text() + "# theirs\n")
    again, autosave = opened(tmp_path / "state")
    autosave.restore(autosave.find_recovered()[0])
    assert again.folder == home
    assert any("another program" in words for words in again.work.warnings(home, again.stamp)) == touched
    autosave.close()


def test_without_a_folder_nothing_is_kept(work: Work) -> None:
    """Oracle: nothing to offer."""
    document, autosave = opened(None)
    document.open(work, saved=False)
    settle(autosave, 0.0)
    settle(autosave, 10.0)
    autosave.close()
    assert autosave.find_recovered() == []
