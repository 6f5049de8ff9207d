"""What is allowed but may disappoint. The oracle of each test is a robot with that one fault."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import box_robot, strip_robot
from robot_files import GOOD, SVG, edit, load

from hydrostat.geometry import Mesh
from hydrostat.robot import Cable, Mount, Pin, Pose, Robot, Volume, Winch, find_risks


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """A robot without risk."""
    return load(tmp_path_factory.mktemp("good"), edit(GOOD, "[20, 10]]", "[22, 11]]"))


def cable(robot: Robot, *points: tuple[float, float]) -> Robot:
    """The robot with its first cable led through these points [mm] after its winch."""
    places = (robot.winches[0].at, *((1e-3 * x, 1e-3 * y) for x, y in points))
    return replace(robot, cables=(replace(robot.cables[0], points=places), *robot.cables[1:]))


def test_none(good: Robot) -> None:
    """Oracle: nothing to say of a good robot, flat or in space."""
    assert find_risks(good) == []
    assert find_risks(box_robot()) == []


def test_thin_triangle() -> None:
    """Oracle: a triangle with an angle of atan(1/10), 5.7 degrees."""
    robot = strip_robot(columns=1, rows=1)
    mesh = Mesh(robot.body.mesh.nodes * [1.0, 0.4], robot.body.mesh.elements)
    thin = replace(robot, body=replace(robot.body, mesh=mesh), cables=(), winches=())
    assert find_risks(thin) == ["body: the mesh has an angle of 6 degrees; try another element_size"]


@pytest.mark.parametrize(("poisson", "flat", "space"), [(0.35, 14, 12), (0.46, 35, 45), (0.499, 140, 240)])
def test_locking(good: Robot, poisson: float, flat: int, space: int) -> None:
    """Oracle: what `benchmarks/locking.py` measured at the next lower ratio; nothing below 0.35 or with patches."""
    for robot, percent in ((good, flat), (box_robot(), space)):
        material = replace(robot.body.material, poisson=poisson)
        for volume in Volume:
            risks = find_risks(replace(robot, body=replace(robot.body, material=material, volume=volume)))
            line = (
                f"body.material: Poisson's ratio {poisson}: linear elements lock; with 4 of them across a limb it can "
                f'be {percent} % too stiff in bending for that alone; try volume = "patch"'
            )
            assert risks == ([line] if volume is Volume.ELEMENT else [])
        below = replace(robot.body.material, poisson=0.349)
        assert find_risks(replace(robot, body=replace(robot.body, material=below))) == []


def test_held_everywhere(good: Robot) -> None:
    """Oracle: one box round the whole body, two boxes that share it, and one of those alone."""
    halves = (Pin(box=((-1.0, -1.0), (0.0, 1.0))), Pin(box=((0.0, -1.0), (1.0, 1.0))))
    line = "pin: every node of the body is held, nothing can move; make a radius or a box smaller"
    assert find_risks(replace(good, pins=(Pin(box=((-1.0, -1.0), (1.0, 1.0))),))) == [line]
    assert find_risks(replace(good, pins=halves)) == [line]
    assert find_risks(replace(good, pins=halves[:1])) == []


def test_winch_without_cable(good: Robot) -> None:
    """Oracle: the winch whose cable was taken away."""
    assert find_risks(replace(good, cables=good.cables[:1])) == ["winch[1] right: pulls no cable"]


def test_travel_longer_than_cable(good: Robot) -> None:
    """Oracle: sqrt(20^2 + 5^2) + sqrt(22^2 + 1) mm of cable, the first part sheathed or not."""
    winches = (replace(good.winches[0], travel=0.03), good.winches[1])
    assert find_risks(replace(good, winches=winches)) == []
    cables = (replace(good.cables[0], sheathed=((0, 1),)), good.cables[1])
    line = "winch[0] left: its travel of 30 mm is longer than a cable it pulls (22 mm outside sheaths)"
    assert find_risks(replace(good, winches=winches, cables=cables)) == [line]


def test_spools_collide(good: Robot) -> None:
    """Oracle: two spools of radius 6 mm, 10 mm apart."""
    winches = tuple(replace(winch, spool_radius=0.006) for winch in good.winches)
    line = "winch[1] right: only 10 mm from winch left, their spools collide"
    assert find_risks(replace(good, winches=winches)) == [line]


def test_cable_near_the_edge(good: Robot) -> None:
    """Oracle: a point 2 mm inside the edge at y = 20 mm."""
    line = "cable[0]: a point is only 2 mm inside the edge and may tear out"
    assert find_risks(cable(good, (0, 18), (20, 10))) == [line]
    assert find_risks(cable(good, (0, 16.9), (20, 10))) == []


def test_cable_leaves_the_body(tmp_path: Path) -> None:
    """Oracle: a slot between two points of a cable, and the way round it."""
    slot = SVG.format('<path d="M0,0 h27 v22 h6 v-22 h27 v40 h-60 z"/>')
    robot = load(tmp_path, edit(edit(GOOD, "[0, 10], [20, 10]", "[-15, 10], [20, 10]"), "-10", "-9"), svg=slot)
    line = "cable[0]: it leaves the body between two of its points; add a point to lead it round"
    assert find_risks(robot) == [line]
    assert find_risks(cable(robot, (-10, -7), (10, -7), (20, 10))) == []


def test_world_winch_is_outside(good: Robot) -> None:
    """Oracle: the stretch from a winch in the world to the body is no risk."""
    winch = Winch(name="far", at=(-0.08, 0.0), travel=0.01, mount=Mount.WORLD)
    outside = Cable(winch="far", points=(winch.at, (-0.02, 0.0), (0.02, 0.0)))
    assert find_risks(replace(good, winches=(winch,), cables=(outside,))) == []


def test_pose_out_of_reach(good: Robot) -> None:
    """Oracle: a target farther from its marker than the body is long, which is 60 mm."""
    poses = {name: Pose(name=name, targets={"tip": (x, 0.0)}) for name, x in (("near", 0.08), ("far", 0.1))}
    assert find_risks(replace(good, poses=poses)) == ["pose far: tip should move 75 mm, farther than the body is long"]
    assert np.isclose(good.body.mesh.size, 0.06)
