"""What a person who writes Python meets first: names, guards of units, errors, representations."""

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from builders import gallery_robot

import hydrostat as hs


@pytest.fixture(scope="module")
def simulation() -> hs.Simulation:
    return hs.Simulation(gallery_robot("starfish"))


@pytest.fixture(scope="module")
def pose(simulation: hs.Simulation) -> hs.Equilibrium:
    return simulation.solve({"left": 0.012})


def test_types_come_with_it() -> None:
    """Oracle: PEP 561."""
    assert (files("hydrostat") / "py.typed").is_file()


def test_the_gallery_is_at_the_door() -> None:
    assert "starfish" in hs.list_gallery()
    assert hs.load_robot("gallery:starfish") == gallery_robot("starfish")
    with pytest.raises(hs.InputError, match='unknown gallery robot "starfsh"'):
        hs.load_robot("gallery:starfsh")


def test_another_material_keeps_the_mesh() -> None:
    robot = gallery_robot("starfish")
    soft = robot.with_material("flexfoam-it x")
    assert soft.body.material == hs.get_material("flexfoam-it x")
    assert soft.body.mesh is robot.body.mesh
    assert robot.with_material(young=50e3).body.material.young == 50e3
    assert robot.with_material(young=50e3).body.material.name == ""
    with pytest.raises(hs.InputError, match=r'unknown material value "yung"\. Allowed: young'):
        robot.with_material(yung=50e3)


def test_a_robot_from_a_file(tmp_path: Path) -> None:
    """Oracle: what is saved and read again."""
    drawing = tmp_path / "disc.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><circle cx="50" cy="50" r="40"/></svg>'
    )
    robot = hs.new_robot(drawing, size=0.1, nodes=120)
    assert robot.name == "disc"
    assert robot.body.mesh.size == pytest.approx(0.1, rel=1e-3)
    hs.save_robot(robot, tmp_path / "disc")
    assert hs.load_robot(tmp_path / "disc") == robot
    with pytest.raises(hs.InputError, match="there is no such file"):
        hs.new_robot(tmp_path / "none.svg")
    with pytest.raises(hs.InputError, match='unknown option "siez"'):
        hs.new_robot(drawing, siez=0.1)  # type: ignore[call-arg]


def test_a_robot_from_corners(tmp_path: Path) -> None:
    """Oracle: the robot of a drawing of the same polygon, y down; and what is saved and read again."""
    (tmp_path / "arm.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 32"><polygon points="0,0 200,8 200,24 0,28"/></svg>'
    )
    drawn = hs.new_robot(tmp_path / "arm.svg", size=0.2)
    robot = hs.new_robot([(0.3, 0.0), (0.5, -0.008), (0.5, -0.024), (0.3, -0.028)], name="arm")
    np.testing.assert_allclose(robot.body.mesh.nodes, drawn.body.mesh.nodes, atol=1e-9)
    assert (robot.name, robot.poses.keys()) == ("arm", drawn.poses.keys())
    hs.save_robot(robot, tmp_path / "arm")
    assert hs.load_robot(tmp_path / "arm") == robot


def test_a_robot_from_a_mesh(tmp_path: Path) -> None:
    """Oracle: nodes of the mesh, also after it is saved and read."""
    mesh = hs.load_robot("gallery:trunk").body.mesh
    robot = hs.new_robot(mesh, name="nose", material="ecoflex 00-30")
    np.testing.assert_allclose(robot.body.mesh.nodes, mesh.nodes, atol=1e-9)
    assert robot.body.material.name == "ecoflex 00-30"
    hs.save_robot(robot, tmp_path / "nose")
    assert hs.load_robot(tmp_path / "nose") == robot


def test_slopes_of_markers_are_those_of_finite_differences(simulation: hs.Simulation, pose: hs.Equilibrium) -> None:
    """Central differences of the markers themselves."""
    step, winch = 1e-5, 1
    ends = [simulation.solve(pose.contractions + sign * step * np.eye(3)[winch], start=pose) for sign in (1, -1)]
    for row, name in zip(simulation.marker_jacobian(pose), pose.markers, strict=True):
        measured = (ends[0].markers[name] - ends[1].markers[name]) / (2 * step)
        assert row[:, winch] == pytest.approx(measured, abs=1e-5)


def test_strain_and_stress_of_a_pose(pose: hs.Equilibrium) -> None:
    """Oracle: every node moved apart by a tenth along x. The closed forms of the fields are in test_coloring."""
    stretched = replace(pose, nodes=pose.robot.body.mesh.nodes * [1.1, 1.0])
    assert stretched.strains == pytest.approx(0.1, rel=1e-9)
    mu, _ = pose.robot.body.material.lame
    assert stretched.stresses == pytest.approx(mu / 1.1 * (1.1**2 - 1), rel=1e-9)


def test_what_is_to_be_minded_is_told(simulation: hs.Simulation, pose: hs.Equilibrium) -> None:
    assert pose.warnings == ()
    far = simulation.solve({"left": 0.0601, "right": -0.0101}, strict=False)
    assert "winch right: contraction -10.1 mm is outside its range (-10 to 60 mm)" in far.warnings
    assert "winch left: contraction 60.1 mm is outside its range (-10 to 60 mm)" in far.warnings
    nodes = pose.nodes.copy()
    nodes[np.argmin(nodes[:, 0])] = [0.2, 0.0]  # the tip of the left arm, through all of the body
    assert any("self-intersection" in note for note in replace(pose, nodes=nodes).warnings)


def test_representations_are_short(simulation: hs.Simulation, pose: hs.Equilibrium) -> None:
    assert "left 12 mm" in repr(pose)
    shown = [repr(pose), repr(simulation.robot), repr(simulation.motion_at_rest(pose))]
    reached = hs.solve_ik(simulation, simulation.robot.poses["wave"])
    shown += [repr(reached), repr(simulation), repr(hs.Tracker(simulation)), repr(simulation.solve_batch([{}, {}]))]
    shown.append(repr(hs.find_equilibria(simulation, {"left": 0.01}, count=2)))
    shown.append(repr(hs.continue_branch(simulation, pose, {"left": 0.013})))
    shown.append(repr(hs.solve_ik_trajectory(simulation, [pose])))
    assert max(map(len, shown)) < 400
    assert all("array" not in words and "\n" not in words for words in shown)


@pytest.mark.slow
def test_pictures_for_notebooks(simulation: hs.Simulation, pose: hs.Equilibrium) -> None:
    assert pose.plot(title="mine").axes
    for record in (pose, simulation.robot, hs.solve_ik(simulation, simulation.robot.poses["wave"])):
        assert 'src="data:image/png;base64,iVBOR' in record._repr_html_()
        assert "&lt;" in record._repr_html_()


MILLIMETERS = {
    "solve": (
        lambda simulation: simulation.solve({"left": 12}),
        "12 m, is far more than the body, 0.279 m, .*in meters: 12 mm",
    ),
    "solve, let out": (
        lambda simulation: simulation.solve({"left": -5}),
        "far more than the body, 0.279 m, .*in meters",
    ),
    "clearance": (lambda _: hs.Constraints(clearance=5), "at most 1 m, not 5; in meters: 5 mm is 0.005"),
    "winch gap": (lambda _: hs.Constraints(winch_gap=25), "at most 20 m, not 25; in meters"),
    "a gap beside the body": (
        lambda simulation: hs.Constraints(hole_gap=4).check(simulation.robot),
        r"hole_gap: too large for a body of 0.279 m \(4 m\)",
    ),
    "zone": (lambda _: hs.Zone(at=(0, 30), radius=0.01), "in meters, at most 20.*30 mm is 0.03"),
    "radius of a zone": (lambda _: hs.Zone(at=(0.0, 0.03), radius=30.0), "in meters, at most 20, not 30"),
    "young": (
        lambda _: hs.Material(young=30, poisson=0.3, density=40),
        r"young = 30 Pa is too small \(minimum 100 Pa\)",
    ),
    "accuracy": (lambda s: s.solve({}, accuracy=0.1), "too rough for a body of 0.279 m; it is in meters"),
    "range of a winch": (
        lambda s: hs.solve_ik(s, {"left": (0.0, 0.0)}, limits=hs.Limits(contraction={"left": (0, 20)})),
        "the contraction of winch .left., 20 m, is far more than the body",
    ),
    "profile": (
        lambda s: next(s.play(hs.ContractionProfile(times=np.arange(3.0), values=np.diag([0.0, 12.0, 0.0])), 1.0, 0.1)),
        "the contraction of winch .left., 12 m, is far more than the body",
    ),
    "travel": (
        lambda _: hs.Winch(name="a", at=(0.0, 0.0), travel=60),
        "travel must be at most 20 m, not 60; in meters",
    ),
    "size of a drawing": (lambda _: hs.new_robot("a.svg", size=200), "size must be at most 20 m, not 200; in meters"),
    "design": (
        lambda s: hs.design_cables(s.robot, [hs.PoseTarget(name="far", targets={"left": (100.0, 60.0)})]),
        "the target of left is 116.4 m away from a body of 0.279 m. Check its unit",
    ),
}


@pytest.mark.parametrize("case", MILLIMETERS)
@pytest.mark.usefixtures("unchecked")
def test_another_unit_is_noticed(simulation: hs.Simulation, case: str) -> None:
    """Oracle: the numbers themselves; none of them can be meant in SI."""
    act, words = MILLIMETERS[case]
    with pytest.raises(hs.InputError, match=words):
        act(simulation)


ASTRAY = {
    "jacobian of an array": (lambda s: s.jacobian(np.zeros(3)), "must be a solved pose"),
    "jacobian of another robot's pose": (
        lambda s: s.jacobian(hs.Simulation(gallery_robot("pig")).solve({})),
        "must be a pose of this robot",
    ),
    "step from a pose": (lambda s: s.step(s.rest, {}, 0.01), "goes on from a motion, not from Equilibrium"),
    "play of a dict": (
        lambda s: s.play({"left": 0.01}, 1.0, 0.01),
        "such as ContractionProfile.ramp",
    ),
    "design of a name": (lambda s: hs.design_cables("starfish", s.robot.poses.values()), "for a Robot, such as"),
    "design of one pose": (lambda s: hs.design_cables(s.robot, s.robot.poses["wave"]), "must be several"),
    "a text for a number": (
        lambda _: hs.Material(young="30 kPa", poisson=0.3, density=40.0),
        "young must be a number in Pa, not '30 kPa'",
    ),
    "no path": (lambda _: hs.load_robot(None), "not from None"),
    "a batch": (lambda s: s.solve(np.zeros((3, 10))), r"not an array of \(3, 10\); solve_batch takes a row"),
    "no robot": (lambda _: hs.Simulation("gallery:starfish"), "is of a Robot, such as load_robot gives, not 'gallery"),
    "nodes to start from": (lambda s: s.solve({}, start=s.rest.nodes), "start must be a solved pose, .*not ndarray"),
    "a time with a unit": (lambda s: s.solve({}, seconds="1 s"), "seconds must be above 0, not '1 s'"),
    "one number": (lambda s: s.solve(0.01), "a number for each of right, left, feet, not 0.01"),
    "a branch from nothing": (lambda s: hs.continue_branch(s, None, {}), "must be a solved pose"),
    "touches of nothing": (lambda s: hs.find_contacts(s, None), "must be a solved pose"),
    "ways": (lambda s: hs.find_equilibria(s, {}, count="two"), "count must be a whole number"),
    "drag": (lambda _: hs.StepOptions(drag="much"), "drag must be a number"),
    "a profile of nothing": (
        lambda _: hs.ContractionProfile(times=None, values=None),
        "a profile needs times and a row for each",
    ),
    "options": (lambda s: hs.solve_ik(s, {"left": (0.0, 0.0)}, options=3), "must be IKOptions"),
    "a search without physics": (lambda _: hs.solve_ik(None, {}), r"must be a Simulation\(robot\), not None"),
    "a tracker without physics": (lambda _: hs.Tracker(None), r"must be a Simulation\(robot\), not None"),
    "limits of a tracker": (lambda s: hs.Tracker(s, limits=3), r"limits must be Limits\(...\)"),
    "a model of a tracker": (
        lambda s: hs.Tracker(s, model="a.model"),
        "one that LearnedModel.load returns, not 'a.model'",
    ),
    "steps of a tracker": (lambda s: hs.Tracker(s).update({"left": (0.0, 0.0)}, seconds="1"), "above 0, not '1'"),
    "no material": (lambda _: hs.get_material(None), "found by its name"),
    "points of a cable": (lambda _: hs.Cable(winch="a", points=None), "points must hold at least 2 points"),
    "a winch without a name": (lambda _: hs.Winch(name=3, at=(0.0, 0.0)), "name must be a text, not 3"),
    "friction": (lambda _: hs.Contact(friction="a"), "friction must be a number"),
    "winches": (lambda s: replace(s.robot, winches=3), "winches must be several"),
    "a pose": (lambda s: replace(s.robot, poses={"wave": 3}), "poses must be Pose records, not 3"),
    "gravity": (lambda s: replace(s.robot, gravity=9.81), "gravity must be"),
    "where to save": (lambda s: hs.save_robot(s.robot, None), "kept in a folder, not None"),
    "what to save": (lambda _: hs.save_robot(None, "x"), "of a Robot, such as load_robot gives, not None"),
    "where to build": (lambda s: hs.write_kit(s.robot, None), "a kit is written into a folder, not None"),
    "options of a kit": (lambda s: hs.build_kit(s.robot, options=3), "options must be KitOptions"),
    "cloth": (lambda _: hs.PatternOptions(seam_allowance="8 mm"), "seam_allowance must be a number in mm"),
    "another's pose": (
        lambda s: hs.draw_pose(gallery_robot("pig"), s.rest),
        r"must be a pose of this robot with finite nodes",
    ),
    "a picture of nothing": (lambda _: hs.draw_rest(None), "drawn of a Robot"),
    "a wish": (
        lambda s: hs.design_cables(s.robot, s.robot.poses.values(), slack=0.01),
        'unknown argument "slack". Allowed: ',
    ),
    "a file of constraints": (
        lambda s: hs.design_cables(s.robot, s.robot.poses.values(), constraints="limits.toml"),
        r"constraints must be Constraints\(...\), not 'limits.toml'",
    ),
    "corners in space": (
        lambda _: hs.new_robot([(0, 0, 0), (1, 0, 0)]),
        r"outline: shape \(2, 3\) is no list of corners. Give shape \(corners, 2\), in m",
    ),
    "words as corners": (lambda _: hs.new_robot([("a", 1)]), "outline: corners must be numbers. Give an array"),
    "corners that cross": (
        lambda _: hs.new_robot([(0, 0), (0.1, 0.1), (0.1, 0), (0, 0.1)]),
        r"the outline crosses itself at \(50, 50\) mm",
    ),
    "a flat mesh": (
        lambda s: hs.new_robot(s.robot.body.mesh),
        "from a mesh of tetrahedra. For a flat body, give its outline as an array",
    ),
    "no file": (lambda _: hs.new_robot(None), "starts from the path of a file"),
    "a size with a unit": (lambda _: hs.new_robot("a.svg", size="200 mm"), "size must be a number in m, not '200 mm'"),
    "many nodes": (lambda _: hs.new_robot("a.svg", nodes="many"), "nodes must be a whole number, not 'many'"),
}


@pytest.mark.parametrize("case", ASTRAY)
@pytest.mark.usefixtures("unchecked")
def test_what_was_a_raw_exception_is_an_input_error(simulation: hs.Simulation, case: str) -> None:
    act, words = ASTRAY[case]
    with pytest.raises(hs.InputError, match=words):
        act(simulation)


def test_a_search_ends_in_time_and_tells_how_it_goes(simulation: hs.Simulation) -> None:
    """Oracle: a target that no winch reaches; without a limit the search goes on for many steps and restarts."""
    away = {"left": (0.5, 0.5)}
    told: list[tuple[int, float]] = []
    whole = hs.solve_ik(simulation, away, progress=lambda step, error: told.append((step, error)))
    assert [step for step, _ in told] == list(range(1, len(told) + 1))
    assert told[0][1] > told[-1][1] > 0.3
    cut = hs.solve_ik(simulation, away, seconds=1e-9)
    assert cut.status == "time limit reached"
    assert cut.iterations < whole.iterations
    assert cut.pose.result.converged
    with pytest.raises(hs.InputError, match="seconds must be above 0, not 0"):
        hs.solve_ik(simulation, away, seconds=0)


def test_what_progress_raises_ends_the_search(simulation: hs.Simulation) -> None:
    def enough(_: int, __: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        hs.solve_ik(simulation, {"left": (0.5, 0.5)}, progress=enough)


def test_places_may_be_arrays(simulation: hs.Simulation, pose: hs.Equilibrium) -> None:
    """As markers of a pose are; a tracker compares the targets of one update with those of the last."""
    reached = hs.solve_ik(simulation, {"left": pose.markers["left"]}, start=pose)
    assert reached.errors["left"] < 1e-6
    assert reached.target is not None
    assert reached.target == hs.PoseTarget(name="target", targets={"left": tuple(pose.markers["left"].tolist())})
    assert simulation.solve([0.0, 0.012, 0.0]).contractions.tolist() == pose.contractions.tolist()
