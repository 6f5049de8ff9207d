"""An object pulled out of a grasp. Oracles: balance of forces, other steps, more and less friction."""

from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh, gallery_robot, mesh_body, strip_robot

from hydrostat.errors import InputError
from hydrostat.grasp import (
    PullOptions,
    PullOut,
    find_overlaps,
    move_object,
    place_object,
    pull_bands,
    pull_out,
    read_object,
)
from hydrostat.mechanics import ObstacleEnergy
from hydrostat.robot import Cable, Contact, Obstacle, Pin, Robot, Winch

pytestmark = pytest.mark.usefixtures("unchecked")

PUCK = Obstacle(name="puck", shape="sphere", at=(0.14, 0.06), radius=0.025, mass=0.05, friction=0.4)
CURLED = {"up": 0.035}


def curler(**contact: float) -> Robot:
    """A strip that curls up around what lies above it."""
    return replace(strip_robot(columns=16, rows=3), contact=Contact(**contact))


@cache
def pulled(step: float = 2e-3) -> PullOut:
    options = PullOptions(direction=(1.0, 0.0), step=step)
    return pull_out(curler(distance=1e-3), PUCK, CURLED, options)


def test_the_object_is_held_and_comes_free() -> None:
    pull = pulled()
    assert pull.peak > 0.05
    assert pull.released
    assert pull.status == "object is free"
    assert pull.forces[-1] == pytest.approx(0.0, abs=1e-3 * pull.peak)


def test_forces_on_the_object_balance() -> None:
    """What pulls it and what the robot does to it, to a millionth of a newton; nothing else acts along the pull."""
    pull = pulled()
    assert np.abs(pull.forces + pull.contact[:, 0]).max() < 1e-6


def test_the_curve_does_not_depend_on_the_steps() -> None:
    coarse, fine = pulled(), pulled(step=1e-3)
    assert coarse.peak == pytest.approx(fine.peak, rel=0.02)
    shared = np.interp(coarse.pulled, fine.pulled, fine.forces)
    assert np.abs(shared - coarse.forces).max() < 0.05 * fine.peak


@pytest.mark.slow
@pytest.mark.parametrize(("springs", "distance", "within"), [(30.0, 1e-3, 0.01), (10.0, 5e-4, 0.03)])
def test_neither_springs_nor_distance_matter(
    monkeypatch: pytest.MonkeyPatch, springs: float, distance: float, within: float
) -> None:
    monkeypatch.setattr(ObstacleEnergy, "STICKS", springs)
    other = pull_out(curler(distance=distance), PUCK, CURLED, PullOptions(direction=(1.0, 0.0), step=2e-3))
    assert other.peak == pytest.approx(pulled().peak, rel=within)
    assert np.interp(0.01, other.moved, other.forces) == pytest.approx(
        np.interp(0.01, pulled().moved, pulled().forces), rel=within
    )


@pytest.mark.slow
def test_a_case_for_each_quantity_that_nobody_knows_well() -> None:
    options = PullOptions(direction=(1.0, 0.0), step=8e-3)
    cases = pull_bands(curler(distance=1e-3), PUCK, CURLED, options)
    assert [case.name for case in cases] == [
        "no friction",
        "friction 0.3",
        "friction 0.8",
        "modulus -30%",
        "modulus +30%",
        "x -5 mm",
        "x +5 mm",
        "y -5 mm",
        "y +5 mm",
    ]
    pulls = {case.name: case.pull for case in cases if case.pull is not None}
    peaks = {name: pull.peak for name, pull in pulls.items()}
    assert pulls["no friction"].work < pulls["friction 0.3"].work
    assert peaks["no friction"] < peaks["friction 0.3"] < peaks["friction 0.8"]
    assert peaks["modulus -30%"] != peaks["modulus +30%"]


@pytest.mark.parametrize(
    ("obstacle", "words"),
    [
        (replace(PUCK, mass=None), "has no mass; give it one"),
        (replace(PUCK, at=(0.1, 0.0)), "stands in the body|the body at rest stands in"),
        (replace(PUCK, at=(0.0, 0.5)), 'nothing touches "puck" in the closed robot. Move it'),
    ],
)
def test_what_cannot_be_pulled_is_told(obstacle: Obstacle, words: str) -> None:
    with pytest.raises(InputError, match=words):
        pull_out(curler(), obstacle, CURLED, PullOptions(direction=(1.0, 0.0)))


@pytest.mark.parametrize("wrong", [{"direction": (0.0, 0.0)}, {"direction": (1.0, 0.0), "step": 0.0}])
def test_a_wrong_pull_is_told(wrong: dict) -> None:
    with pytest.raises(InputError, match="pull must"):
        PullOptions(**wrong)


def test_objects_are_read_from_words() -> None:
    known = {"mass": 0.058, "friction": 0.5}
    assert read_object("sphere:65mm", 3, **known).radius == pytest.approx(0.0325)
    assert read_object("box:4cm,40mm,60mm", 3, **known).to == pytest.approx((0.02, 0.02, 0.03))
    rod = read_object("capsule:40mm,120mm", 3, **known)
    assert (rod.to, rod.radius) == (pytest.approx((0, 0, 0.04)), pytest.approx(0.02))
    for wrong, words in (
        ("cone:3mm", 'unknown shape "cone"'),
        ("sphere:3mm,4mm", "has 1 size, not 2. Write e.g. sphere:65mm"),
        ("sphere", "has 1 size, not 0"),
        ("sphere:3", "no unit"),
    ):
        with pytest.raises(InputError, match=words):
            read_object(wrong, 3, **known)


def test_a_force_that_still_rises_is_no_peak() -> None:
    """Oracle: a pull cut off before its peak, which the whole pull has at 10 mm or more."""
    assert not pulled().is_rising
    cut = PullOptions(direction=(1.0, 0.0), step=2e-3, travel=4e-3)
    assert pull_out(curler(distance=1e-3), PUCK, CURLED, cut).is_rising


def test_obstacles_in_the_object_are_found() -> None:
    """Oracle: distances of two discs by hand; the last one is in the middle of the other."""
    disc = Obstacle(name="disc", shape="sphere", at=(0.17, 0.06), radius=0.004)
    for radius, x, found in ((0.004, 0.17, []), (0.006, 0.17, ["disc"]), (0.004, 0.14, ["disc"])):
        robot = replace(curler(), obstacles=(replace(disc, at=(x, 0.06), radius=radius),))
        assert find_overlaps(robot, PUCK) == found


def test_a_place_near_the_closed_markers_is_clear_of_the_body() -> None:
    robot = gallery_robot("caging_gripper")
    ball = read_object("sphere:65mm", 3, mass=0.058, friction=0.5)
    closed = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.02]])
    placed = place_object(robot, ball, closed)
    skin = robot.body.mesh.nodes[np.unique(robot.body.mesh.boundary)]
    assert placed.field()(skin).values.min() >= 2 * robot.contact_distance - 1e-12
    assert move_object(placed, np.zeros(3)).at == pytest.approx((0.0, 0.0, 0.0))


def test_a_small_object_is_clear_of_the_edges_between_nodes() -> None:
    """A disc of 3 mm on a limb of coarse edges. Oracle: its distance to points all along the boundary."""
    robot = replace(gallery_robot("starfish"), contact=Contact())
    placed = place_object(robot, read_object("sphere:3mm", 2, mass=0.01, friction=0.5), np.array([[-0.0124, 0.0966]]))
    corners = robot.body.mesh.nodes[robot.body.mesh.boundary]
    along = corners[:, :1] + np.linspace(0.0, 1.0, 9)[:, None] * (corners[:, 1:] - corners[:, :1])
    assert placed.field()(along.reshape(-1, 2)).values.min() > 0


def bar() -> Robot:
    """A bar 200 x 30 x 50 mm, held at its left end, that curls up."""
    stops = tuple((float(x), 0.015, 0.015) for x in np.linspace(0.01, 0.19, 7))
    mesh = box_mesh((10, 1, 2), size=(0.2, 0.03, 0.05))
    return Robot(
        name="bar",
        body=mesh_body(replace(mesh, nodes=mesh.nodes - (0.0, 0.0, 0.025))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=(Winch(name="up", at=stops[0]),),
        cables=(Cable(winch="up", points=stops),),
        poses={},
        contact=Contact(distance=2e-3),
    )


def test_a_block_from_a_file_is_pulled_like_a_box(tmp_path: Path) -> None:
    """The same block as a surface file and as a box, at three places of the pull."""
    corners = "".join(f"{x} {y} {z}\n" for x, y, z in product((0, 40), (0, 60), (0, 40)))
    sides = ("0 1 3", "0 3 2", "4 6 7", "4 7 5", "0 4 5", "0 5 1", "2 3 7", "2 7 6", "0 2 6", "0 6 4", "1 5 7", "1 7 3")
    path = tmp_path / "block.off"
    path.write_text("OFF\n8 12 0\n" + corners + "".join(f"3 {side}\n" for side in sides))
    place, options = np.array([0.14, 0.015, 0.06]), PullOptions(direction=(1.0, 0.0, 0.0), step=8e-3, travel=16e-3)
    made, box = (
        pull_out(bar(), move_object(read_object(text, 3, mass=0.05, friction=0.4), place), {"up": 0.045}, options)
        for text in (str(path), "box:40mm,60mm,40mm")
    )
    assert box.peak > 0.05
    assert made.forces == pytest.approx(box.forces, rel=0.01, abs=1e-3 * box.peak)
    assert np.abs(made.forces + made.contact[:, 0]).max() < 1e-6
