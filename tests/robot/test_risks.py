"""What is allowed but may disappoint, on flat bodies. The oracle of each test is a robot with that one fault."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from builders import gallery_robot, strip_robot
from robot_files import GOOD, SVG, edit, load
from shapely import LineString, Point
from test_risks_in_space import solid_robot
from touching import fork_mesh, fork_robot

from hydrostat.geometry import Mesh
from hydrostat.robot import Body, Cable, Marker, Mount, Pin, PoseTarget, Robot, Volume, Winch, find_risks


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """A robot without risk."""
    return load(tmp_path_factory.mktemp("good"), edit(GOOD, "[20, 10]]", "[22, 11]]"))


def cable(robot: Robot, *points: tuple[float, float]) -> Robot:
    """The robot with its first cable led through these points [mm] after its winch."""
    places = (robot.winches[0].at, *((1e-3 * x, 1e-3 * y) for x, y in points))
    return replace(robot, cables=(replace(robot.cables[0], points=places), *robot.cables[1:]))


def with_range(robot: Robot, *, stretch: float | None = None, squeeze: float | None = None) -> Body:
    """The robot's body of a material with this range."""
    material = replace(robot.body.material, name="putty", largest_stretch=stretch, largest_squeeze=squeeze)
    return replace(robot.body, material=material)


def test_none(good: Robot) -> None:
    """Oracle: nothing to say of a good robot."""
    assert find_risks(good) == []
    assert find_risks(strip_robot()) == []


def test_thin_triangle() -> None:
    """Oracle: a triangle with an angle of atan(1/10), 5.7 degrees."""
    robot = strip_robot(columns=1, rows=1)
    mesh = Mesh(robot.body.mesh.nodes * [1.0, 0.4], robot.body.mesh.elements)
    thin = replace(robot, body=replace(robot.body, mesh=mesh), cables=(), winches=())
    assert find_risks(thin) == ["body: the mesh has an angle of 6 degrees; try another element_size"]


@pytest.mark.parametrize(("poisson", "flat", "space"), [(0.35, 14, 12), (0.46, 35, 45), (0.499, 140, 240)])
def test_locking(good: Robot, poisson: float, flat: int, space: int) -> None:
    """Oracle: what `lab/locking/locking.py` measured at the next lower ratio; nothing below 0.35 or with patches."""
    for robot, percent in ((good, flat), (solid_robot(), space)):
        material = replace(robot.body.material, poisson=poisson)
        for volume in Volume:
            risks = find_risks(replace(robot, body=replace(robot.body, material=material, volume=volume)))
            line = (
                f"body.material: Poisson's ratio {poisson}: linear elements lock; with 4 of them across a limb it can "
                f'be {percent} % too stiff in bending for that alone; try elements = "quadratic" '
                'or volume = "patch"'
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
    winches = (replace(good.winches[0], travel=0.025), good.winches[1])
    assert find_risks(replace(good, winches=winches)) == []
    cables = (replace(good.cables[0], sheathed=((0, 1),)), good.cables[1])
    line = "winch[0] left: the travel of 25 mm is longer than a cable that it pulls (22 mm outside sheaths)"
    assert find_risks(replace(good, winches=winches, cables=cables)) == [line]
    released = (replace(good.winches[0], release=0.05), good.winches[1])
    line = "winch[0] left: the release of 50 mm is longer than a cable that it pulls (42.6 mm outside sheaths)"
    assert find_risks(replace(good, winches=released)) == [line]


def test_travel_on_a_larger_step(good: Robot) -> None:
    """Oracle: 20 mm at a winch of 3 mm are 60 mm on a step of 9 mm, of a cable of 42.6 mm."""
    cables = (replace(good.cables[0], spool_radius=0.009), good.cables[1])
    assert find_risks(replace(good, cables=cables)) == [
        "winch[0] left: the travel of 20 mm, 60 mm at its spool, is longer than a cable that it pulls (42.6 mm outside "
        "sheaths)",
        "winch[1] right: spool overlaps that of winch left: 10 mm apart, need 12 mm. Move one winch",
    ]


def test_squeeze_on_a_larger_step(good: Robot) -> None:
    """Oracle: the same cable on a winch whose travel is as much longer."""
    tight = replace(good, body=with_range(good, squeeze=0.2))
    whole, part = (
        replace(tight, winches=(replace(good.winches[0], travel=travel), replace(good.winches[1], travel=0.001)))
        for travel in (0.02, 0.01)
    )
    (expected,) = find_risks(whole)
    (found,) = find_risks(replace(part, cables=(replace(part.cables[0], spool_radius=0.006), part.cables[1])))
    amount = re.compile(r"by \d+ % on average")
    assert amount.findall(found) == amount.findall(expected) != []
    assert "full travel of 10 mm" in found
    stays = re.compile(r"a travel of ([\d.]+) mm")
    assert 2 * float(stays.findall(found)[0]) == pytest.approx(float(stays.findall(expected)[0]), rel=3e-3)


def test_spools_collide(good: Robot) -> None:
    """Oracle: two spools of radius 6 mm, 10 mm apart."""
    winches = tuple(replace(winch, spool_radius=0.006) for winch in good.winches)
    line = "winch[1] right: spool overlaps that of winch left: 10 mm apart, need 12 mm. Move one winch"
    assert find_risks(replace(good, winches=winches)) == [line]


def test_cable_near_the_edge(good: Robot) -> None:
    """Oracle: a point 2 mm inside the edge at y = 20 mm."""
    line = "cable[0]: only 2 mm inside the edge at [0, 18] mm, it may tear out"
    assert find_risks(cable(good, (0, 18), (20, 10))) == [line]
    assert find_risks(cable(good, (0, 16.9), (20, 10))) == []


def test_cable_leaves_the_body(tmp_path: Path) -> None:
    """Oracle: a slot 6 mm wide between two points of a cable, the way round it, and a slit in its place."""
    slot = SVG.format('<path d="M0,0 h27 v22 h6 v-22 h27 v40 h-60 z"/>')
    robot = load(tmp_path, edit(edit(GOOD, "[0, 10], [20, 10]", "[-15, 10], [20, 10]"), "-10", "-9"), svg=slot)
    (line,) = find_risks(robot)
    way = "add a point to lead it round, unless it crosses a slit"
    assert line == f"cable[0]: leaves the body by 3 mm at [0, 10] mm; {way}"
    slit = SVG.format('<path d="M0,0 h30 l0.1,22 l0.1,-22 h29.8 v40 h-60 z"/>')
    (line,) = find_risks(replace(robot, body=load(tmp_path / "slit", GOOD, svg=slit).body))
    assert "at [0, 10] mm" in line
    assert find_risks(cable(robot, (-10, -7), (10, -7), (20, 10))) == []


def test_world_winch_is_outside(good: Robot) -> None:
    """Oracle: the stretch from a winch in the world to the body is no risk."""
    winch = Winch(name="far", at=(-0.08, 0.0), travel=0.01, mount=Mount.WORLD)
    outside = Cable(winch="far", points=(winch.at, (-0.02, 0.0), (0.02, 0.0)))
    assert find_risks(replace(good, winches=(winch,), cables=(outside,))) == []


def test_pose_out_of_reach(good: Robot) -> None:
    """Oracle: a target farther from its marker than the body is long, which is 60 mm."""
    poses = {name: PoseTarget(name=name, targets={"tip": (x, 0.0)}) for name, x in (("near", 0.08), ("far", 0.1))}
    held = replace(good, poses=poses, body=with_range(good, stretch=4.0))
    assert find_risks(held) == ["pose far: tip should move 75 mm, farther than the body is long"]
    assert np.isclose(good.body.mesh.size, 0.06)


@pytest.mark.parametrize(("rows", "thick"), [(1, True), (2, True), (3, False)])
def test_thin_limb(rows: int, thick: bool) -> None:
    """Oracle: a strip 50 mm high of 1, 2 or 3 right triangles, as large as a regular one of side 1.0746."""
    risks = find_risks(replace(strip_robot(columns=4 * rows, rows=rows), cables=(), winches=()))
    assert bool(risks) == thick
    if thick:
        assert len(risks) == 1
        assert f"only {rows / 1.0746:.1f} elements across (50 mm thick at" in risks[0]
        assert risks[0].endswith(
            '50 % or more too stiff in bending; a mesh with edges of 12 mm would do, as would elements = "quadratic"'
        )


@pytest.mark.parametrize(("columns", "across"), [(2, "0.7"), (8, None)])
def test_thin_limb_of_quadratic_elements(columns: int, across: str | None) -> None:
    """Oracle: a strip 50 mm high of triangles as large as regular ones of 76 or 27 mm; no word of locking."""
    robot = replace(strip_robot(columns=columns, rows=1 if across else 2), cables=(), winches=())
    body = replace(robot.body, material=replace(robot.body.material, poisson=0.499)).with_elements("quadratic")
    risks = [risk for risk in find_risks(replace(robot, body=body)) if "across" in risk or "lock" in risk]
    assert len(risks) == (across is not None)
    if across:
        assert f"only {across} quadratic elements across (50 mm thick at" in risks[0]


def test_thin_limb_names_an_element_size_that_does(tmp_path: Path) -> None:
    """Oracle: with the size that it names, the same drawing has no such limb any more; a stub is no limb."""
    arm = SVG.format('<path d="M0,0 h20 v16 h40 v8 h-40 v16 h-20 z"/>')
    text = edit(edit(GOOD, "[0, 10], [20, 10]", "[-12, 5]"), "[20, -10]", "[-12, -5]")
    robot = bare(load(tmp_path / "arm", text, svg=arm))
    (line,) = [risk for risk in find_risks(robot) if "limb" in risk]
    assert "(8 mm thick at" in line
    assert 'element_size = "2 mm" would do' in line
    fine = bare(load(tmp_path / "fine", edit(text, '"12 mm"', '"2 mm"'), svg=arm))
    assert not any("limb" in risk for risk in find_risks(fine))


def bare(robot: Robot) -> Robot:
    """The robot without what pulls it."""
    return replace(robot, winches=(), cables=(), poses={})


def test_pin_that_grips_nothing(good: Robot) -> None:
    """Oracle: a pin between the nodes, and one on the node in a corner of the rectangle."""
    mesh = good.body.mesh
    between = tuple(float(x) for x in mesh.nodes[mesh.elements[0]].mean(axis=0))
    corner = Pin(at=(0.03, 0.02), radius=1e-4)
    assert corner.holds(mesh).sum() == 1
    (line,) = find_risks(replace(good, pins=(*good.pins, Pin(at=between))))
    assert line.startswith("pin[1]: reaches no node and holds a single point, about which the body can turn")
    (line,) = find_risks(replace(good, pins=(*good.pins, corner)))
    assert line.startswith("pin[1]: holds only 1 node, about which the body can turn")


def test_marker_that_cannot_move(good: Robot) -> None:
    """Oracle: a marker in the middle of the pin, and one beyond it."""
    held = Marker(name="heel", at=good.pins[0].at or (0.0, 0.0))
    line = "marker[1] heel: held by a pin, cannot move"
    pins = (Pin(box=((-1.0, -1.0), (0.0, 1.0))),)
    assert find_risks(replace(good, pins=pins, markers=(*good.markers, held))) == [line]
    assert find_risks(replace(good, pins=pins)) == []


def test_marker_in_a_coarse_place() -> None:
    """Oracle: a grid of 5 mm squares with one square of 40 mm beside it; its middle is 28 mm from any node."""
    x, y = np.meshgrid(np.linspace(0, 0.04, 9), np.linspace(-0.02, 0.02, 9))
    grid = np.column_stack([x.ravel(), y.ravel()])
    elements = [
        [a, b, c]
        for row in range(8)
        for k in range(row * 9, row * 9 + 8)
        for a, b, c in ((k, k + 1, k + 10), (k, k + 10, k + 9))
    ]
    side = [k * 9 + 8 for k in range(9)]
    nodes = np.concatenate([grid, [[0.08, -0.02], [0.08, 0.02]]])
    elements += [[side[k], 81, side[k + 1]] for k in range(8)] + [[side[8], 81, 82]]
    strip = strip_robot()
    body = replace(strip.body, mesh=Mesh(nodes, np.array(elements)))
    robot = replace(strip, body=body, winches=(), cables=(), markers=(Marker(name="tip", at=(0.07, 0.0)),))
    (line,) = [risk for risk in find_risks(robot) if "marker" in risk]
    assert line.startswith("marker[0] tip: 22.4 mm from the nearest node, where elements are 5.37 mm long elsewhere")
    near = replace(robot, markers=(Marker(name="tip", at=(0.042, 0.0)),))
    assert not any("marker" in risk for risk in find_risks(near))


def test_spool_sticks_out(good: Robot) -> None:
    """Oracle: a winch 15 mm from the edge with a spool of 16 and of 14 mm, alone."""
    winch, at = replace(good.winches[0], travel=0.01, at=(-0.01, 0.005)), (-0.01, 0.005)
    line = "winch[0] left: a spool of radius 16 mm sticks out, the edge is 15 mm away; move it inward"
    for radius, risks in ((0.016, [line]), (0.014, [])):
        alone = replace(good, winches=(replace(winch, spool_radius=radius),), cables=(bowed(good.cables[0], at),))
        assert find_risks(alone) == risks


def bowed(cable: Cable, start: tuple[float, float]) -> Cable:
    """The cable from another start."""
    return replace(cable, points=(start, *cable.points[1:]))


def test_full_travel_squeezes_too_far(good: Robot) -> None:
    """Oracle: 20 mm taken in of a cable of sqrt(20^2 + 5^2) + sqrt(22^2 + 1) = 42.6 mm, or 5 mm less with slack."""
    line = (
        "cable[0]: the full travel of 20 mm would squeeze the body along the cable by 47 % on average; putty is "
        "known up to 40 % (an estimate from lengths alone); a travel of 17.1 mm stays within"
    )
    soft = replace(good, body=with_range(good, squeeze=0.4), cables=good.cables[:1], winches=good.winches[:1])
    assert find_risks(soft) == [line]
    assert find_risks(replace(soft, cables=(replace(soft.cables[0], slack=0.005),))) == []
    assert find_risks(replace(soft, body=with_range(good, squeeze=0.5))) == []
    assert find_risks(replace(soft, body=with_range(good))) == []


def test_pose_that_stretches_too_far(good: Robot) -> None:
    """Oracle: a strip held at its end, its tip 200 mm away, which should be 240 and 320 mm from there."""
    strip = replace(strip_robot(), winches=(), cables=())
    poses = {name: PoseTarget(name=name, targets={"tip": (x, 0.0)}) for name, x in (("near", 0.24), ("far", 0.32))}
    (line,) = find_risks(replace(strip, poses=poses, body=with_range(strip, stretch=1.5)))
    assert line.startswith(
        "pose far: tip should be 320 mm from a pinned place, at rest it is 200 mm through the body: 1.60"
    )
    curled = {"curl": PoseTarget(name="curl", targets={"tip": (0.05, 0.1)})}
    assert find_risks(replace(strip, poses=curled, body=with_range(strip, stretch=1.1))) == []


def test_risks_of_many_parts_are_one_line(good: Robot) -> None:
    """Oracle: five cables too near to the edge; two are named, and the worst."""
    heights = (0.018, 0.0182, 0.019, 0.0175, 0.0172)
    cables = tuple(Cable(winch="left", points=(good.winches[0].at, (0.0, y), (0.02, 0.01))) for y in heights)
    line = "cable[0], cable[1] and 3 more: only 1 mm inside the edge at [0, 19] mm, it may tear out"
    assert find_risks(replace(good, cables=(*cables, good.cables[1]))) == [f"{line} (cable[2] is the worst)"]
    line = "cable[0] and cable[1]: only 1.8 mm inside the edge at [0, 18] mm, it may tear out"
    assert find_risks(replace(good, cables=(*cables[:2], good.cables[1]))) == [f"{line} (cable[1] is the worst)"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("letter_e", ()),
        ("letter_s", ()),
        ("starfish", ()),
        ("pig", ("1.8 elements across (18.7 mm",)),
        ("puppy", ("1.9 elements across (22.8 mm", "cable[0], cable[1] and cable[2]: the full travel of 60 mm")),
        ("robot", ("cable[0], cable[1] and 4 more: the full travel of 60 mm",)),
        ("squid", ("1.7 elements across (21.3 mm", "longer than a cable", "cable[2]: the full travel of 60 mm")),
    ],
)
def test_gallery(name: str, words: tuple[str, ...]) -> None:
    """Oracle: the shortest cut through the drawing at the place of a thin limb; for the rest travel over length."""
    robot = gallery_robot(name)
    risks = find_risks(robot)
    assert len(risks) == len(words)
    assert all(word in risk for word, risk in zip(words, risks, strict=True))
    for risk in risks:
        if found := re.search(r"\((.*) mm thick at \[(.*), (.*)\] mm", risk):
            thickness, x, y = (1e-3 * float(number) for number in found.groups())
            assert shortest_cut(robot, (x, y)) == pytest.approx(thickness, rel=0.1)


def shortest_cut(robot: Robot, place: tuple[float, float]) -> float:
    """Length of the shortest straight cut through the drawing at a place [m]."""
    assert robot.body.outline is not None
    cuts = []
    for angle in np.linspace(0, np.pi, 180, endpoint=False):
        along = np.array([np.cos(angle), np.sin(angle)])
        line = LineString([place - along, place + along]).intersection(robot.body.outline.polygon)
        cuts.append(min(shapely.get_parts(line), key=Point(place).distance).length)
    return min(cuts)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_body_that_touches_itself_at_rest_is_told_with_a_place(dim: int) -> None:
    """The two prongs of a fork, one of them bent until a corner lies on the other. Oracle: where it was put."""
    mesh = fork_mesh(dim)
    nodes = mesh.nodes.copy()
    tip = np.isclose(nodes[:, 0], 0.12) & np.isclose(nodes[:, 1], 0.04 / 6)
    robot = fork_robot(dim)
    assert not [risk for risk in find_risks(robot) if "touches itself" in risk]
    nodes[np.flatnonzero(tip)[0], 1] = -0.04 / 6 + 1e-8
    nodes[np.flatnonzero(tip)[0], 0] = 0.113
    bent = replace(robot, body=replace(robot.body, mesh=Mesh(nodes, mesh.elements)))
    (told,) = [risk for risk in find_risks(bent) if "touches itself" in risk]
    assert "for instance at [113, -7" in told
