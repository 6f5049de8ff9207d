"""A robot of the gallery that is saved keeps the comments of its robot.toml. The oracle is the gallery's own file."""

from dataclasses import replace
from pathlib import Path

from hydrostat.robot import gallery_folder, load_robot
from hydrostat.studio.session import Session


def comments(text: str) -> list[str]:
    return [line.split("#", 1)[1].strip() for line in text.splitlines() if "#" in line]


def test_a_copy_of_the_gallery_keeps_its_comments(tmp_path: Path) -> None:
    source = gallery_folder("starfish")
    before = comments((source / "robot.toml").read_text())
    assert before
    session = Session(tmp_path / "state")
    session.starter.open_gallery(source)
    robot = session.document.robot
    session.document.change("rename", robot=replace(robot, name="mine"))
    session.save(tmp_path / "mine")
    assert comments((tmp_path / "mine" / "robot.toml").read_text()) == before
    assert load_robot(tmp_path / "mine").name == "mine"
