"""Robots that come with hydrostat, and robots from nothing but a drawing."""

from dataclasses import replace
from pathlib import Path

import pytest
from robot_files import RECTANGLE, SVG

from hydrostat.errors import InputError, OutlineError
from hydrostat.robot import find_risks, gallery_folder, list_gallery, load_robot, robot_text, save_robot, sketch_robot


def test_gallery_names() -> None:
    """Oracle: the folders of examples that hold a robot.toml, each with the name of its robot."""
    examples = Path(__file__).parents[2] / "examples"
    assert list_gallery() == sorted(path.parent.name for path in examples.glob("*/robot.toml"))
    for name in list_gallery():
        assert f'name = "{name}"' in (gallery_folder(name) / "robot.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["dragon", "", "..", "../examples/starfish", "starfish/"])
def test_not_in_the_gallery(name: str) -> None:
    """Oracle: the message lists what there is."""
    with pytest.raises(InputError, match=r"unknown gallery robot .*\. Available: .*starfish"):
        gallery_folder(name)


BAR = SVG.format('<rect width="60" height="14" rx="7"/>')


@pytest.mark.parametrize(("svg", "size"), [(RECTANGLE, None), (BAR, 0.25)], ids=["rectangle", "bar"])
def test_sketch(svg: str, size: float | None, tmp_path: Path) -> None:
    """Oracle: the robot itself, saved and read again; it is held, tracked and without risk."""
    robot = sketch_robot(svg.encode(), file="body.svg", name="new one", size=size)
    again = load_robot(save_robot(robot, tmp_path))
    assert again == robot
    assert robot_text(again) == robot_text(robot)
    assert find_risks(robot) == []
    assert 150 < len(robot.body.mesh.nodes) < 400
    marker = robot.markers[0].at
    target = robot.pose("bend").targets[robot.markers[0].name]
    assert 0 < sum((a - b) ** 2 for a, b in zip(marker, target, strict=True)) < robot.body.mesh.size**2


def test_sketch_with_numbers_given() -> None:
    """Oracle: what was asked for."""
    asked = {"element_size": 0.012, "thickness": 0.02}
    robot = sketch_robot(RECTANGLE.encode(), file="body.svg", name="n", material="flexfoam-it x", **asked)
    assert {key: getattr(robot.body, key) for key in asked} == asked
    assert robot.body.material.name == "flexfoam-it x"
    assert replace(robot.body, size=None).size is None


def test_sketch_of_no_body() -> None:
    """Oracle: the drawing's complaint."""
    with pytest.raises(OutlineError, match=r"a.svg: no closed shape"):
        sketch_robot(SVG.format("").encode(), file="a.svg", name="n")
    with pytest.raises(InputError, match="unknown material"):
        sketch_robot(RECTANGLE.encode(), file="a.svg", name="n", material="steel")
