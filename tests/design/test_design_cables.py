"""Whole designs. Oracles: counts asked for, distances of shapely, a fresh simulation, the kit's own checks."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import shapely
from builders import mesh_body, strip_mesh, strip_robot
from robustness import EXAMPLES

from hydrostat.design import Constraints, DesignRequest, FibreKind, Network, TreeOptions, TreeTrace, design_cables
from hydrostat.design.cable_design import _trees
from hydrostat.design.region import Region
from hydrostat.errors import HydrostatError, InputError
from hydrostat.fabrication import plush_pattern
from hydrostat.ik import solve_ik
from hydrostat.robot import PoseTarget, Robot, load_robot, robot_hash
from hydrostat.simulation import BodyPhysics, Simulation

UP = PoseTarget(name="up", targets={"tip": (0.18, 0.06)})
DOWN = PoseTarget(name="down", targets={"tip": (0.185, -0.05)})
CASES = {
    "one winch": ((UP,), 1, 2, FibreKind.EDGES),
    "two poses": ((UP, DOWN), 2, 4, FibreKind.EDGES),
    "a cable a winch": ((UP, DOWN), 2, 2, FibreKind.EDGES),
    "elements": ((UP, DOWN), 2, 3, FibreKind.ELEMENTS),
}


def body() -> Robot:
    """The strip without winches and cables."""
    return strip_robot().with_network((), ())


@cache
def designed(case: str) -> Network:
    poses, winches, cables, kind = CASES[case]
    options = TreeOptions(fibres=kind, trials=12)
    return design_cables(body(), poses, winches=winches, cables=cables, method="trees", options=options)


def rest_error(robot: Robot, poses: tuple[PoseTarget, ...]) -> float:
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    squares = [np.mean([np.sum((places[n] - at) ** 2) for n, at in pose.targets.items()]) for pose in poses]
    return float(np.sqrt(np.mean(squares)))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_a_design_has_what_was_asked_for(case: str, unchecked: None) -> None:
    poses, winches, cables, _ = CASES[case]
    network = designed(case)
    robot = network.robot
    assert len(robot.winches) == winches
    assert winches <= len(robot.cables) <= cables
    assert {cable.winch for cable in robot.cables} == {winch.name for winch in robot.winches}
    assert [reached.target for reached in network.ik_results] == list(poses)
    assert isinstance(network.trace, TreeTrace)
    assert len(network.trace.activations) == len(network.trace.candidates) == len(poses)
    assert 1 <= network.num_evaluated <= 12
    assert network.seconds > 0


@pytest.mark.parametrize("case", CASES)
@pytest.mark.slow
def test_the_errors_told_are_those_of_the_robot(case: str, unchecked: None) -> None:
    poses = CASES[case][0]
    network = designed(case)
    simulation = Simulation(network.robot)
    for reached in network.ik_results:
        fresh = solve_ik(simulation, reached.target)
        assert reached.rms_error == pytest.approx(fresh.rms_error, rel=1e-3)
        again = simulation.solve(reached.pose.contractions, start=reached.pose)
        places = np.array([again.markers[name] for name in reached.target.targets])
        goals = np.array(list(reached.target.targets.values()))
        assert list(reached.errors.values()) == pytest.approx(np.linalg.norm(places - goals, axis=1), rel=1e-6)
    assert network.rms_error < 0.5 * rest_error(network.robot, poses)


@pytest.mark.parametrize("case", CASES)
def test_cables_and_winches_keep_their_distances(case: str, unchecked: None) -> None:
    network, limits = designed(case), Constraints()
    robot = network.robot
    region = Region.of_body(robot.body, limits.clearance)
    rim = region.body.boundary
    for cable in robot.cables:
        assert region.body.contains(shapely.LineString(cable.points))
        assert rim.distance(shapely.LineString(cable.points)) >= 0.5 * limits.clearance - 1e-5
    at = np.array([winch.at for winch in robot.winches])
    assert region.depths(at).min() >= limits.winch_clearance - 1e-5
    for index, place in enumerate(at):
        assert np.linalg.norm(at[:index] - place, axis=1).min(initial=np.inf) >= limits.winch_gap - 2e-5
    points = [(index, np.array(point)) for index, cable in enumerate(robot.cables) for point in cable.points[1:]]
    for index, (cable, point) in enumerate(points):
        for other, neighbor in points[:index]:
            gap = float(np.linalg.norm(point - neighbor))
            assert gap >= limits.hole_gap - 2e-5 or (gap < 1e-5 and other != cable)


@pytest.mark.parametrize("case", CASES)
def test_cables_are_no_stubs(case: str, unchecked: None) -> None:
    robot = designed(case).robot
    spans = np.diff(robot.body.mesh.nodes[robot.body.mesh.edges], axis=1)[:, 0]
    edge = float(np.linalg.norm(spans, axis=1).mean())
    for cable in robot.cables:
        assert cable.segments[cable.bare].sum() > 2.0 * edge


@pytest.mark.slow
def test_the_same_twice(unchecked: None) -> None:
    poses, winches, cables, kind = CASES["two poses"]
    options = TreeOptions(fibres=kind, trials=12)
    again = design_cables(body(), poses, winches=winches, cables=cables, method="trees", options=options)
    assert robot_hash(again.robot) == robot_hash(designed("two poses").robot)
    assert again.rms_error == designed("two poses").rms_error


@pytest.mark.slow
def test_the_robots_own_network_does_not_matter(unchecked: None) -> None:
    poses, winches, cables, kind = CASES["one winch"]
    options = TreeOptions(fibres=kind, trials=12)
    other = design_cables(strip_robot(), poses, winches=winches, cables=cables, method="trees", options=options)
    assert robot_hash(other.robot) == robot_hash(designed("one winch").robot)


def test_progress_is_told() -> None:
    calls: list[tuple[str, int, int]] = []
    options = TreeOptions(trials=3, thresholds=(40,), distances=(1.5,))
    design_cables(
        body(), [UP], winches=1, cables=2, method="trees", options=options, progress=lambda *call: calls.append(call)
    )
    assert {stage for stage, _, _ in calls} == {"Activating muscles", "Growing winch trees", "Judging networks"}
    for stage in {stage for stage, _, _ in calls}:
        counts = [(done, total) for name, done, total in calls if name == stage]
        assert counts == sorted(counts)
        assert counts[-1][0] == counts[-1][1]


@pytest.mark.parametrize(
    ("example", "pose", "winches", "cables"),
    [("starfish", "wave", 2, 6), ("letter_e", "clap", 1, 3)],
)
@pytest.mark.slow
def test_the_kit_accepts_designs_of_the_examples(
    example: str, pose: str, winches: int, cables: int, unchecked: None
) -> None:
    """Every hole can be cut as drawn; and the design is of some use."""
    robot = load_robot(EXAMPLES / example)
    options = TreeOptions(trials=12)
    network = design_cables(robot, [robot.pose(pose)], winches=winches, cables=cables, method="trees", options=options)
    assert plush_pattern(network.robot).panels
    assert network.rms_error < 0.6 * rest_error(robot, (robot.pose(pose),))


def thin_robot() -> Robot:
    """A strip 8 mm high."""
    robot = strip_robot()
    points = [((0.01, 0.0), (0.19, 0.0))] * 2
    cables = tuple(replace(cable, points=line) for cable, line in zip(robot.cables, points, strict=True))
    winches = tuple(replace(winch, at=(0.01, 0.0)) for winch in robot.winches)
    return replace(robot, body=mesh_body(strip_mesh(40, 2, size=(0.2, 0.008))), cables=cables, winches=winches)


@pytest.mark.parametrize(
    ("robot", "poses", "winches", "cables", "text"),
    [
        (body(), [], 1, 1, "no pose to design for"),
        (body(), [UP], 0, 1, "winches must be a whole number from 1 to 20"),
        (body(), [UP], 3, 2, "3 winches need at least 3 cables, got 2"),
        (
            body(),
            [UP, PoseTarget(name="odd", targets={"nose": (0.1, 0.0)})],
            1,
            1,
            'pose "odd".*unknown marker "nose".*Available: tip',
        ),
        (thin_robot(), [UP], 1, 1, "too thin for cables 5 mm inside its edge"),
    ],
)
def test_what_cannot_be_designed(robot: Robot, poses: list[PoseTarget], winches: int, cables: int, text: str) -> None:
    with pytest.raises(InputError, match=text) as caught:
        design_cables(robot, poses, winches=winches, cables=cables, method="trees")
    assert "\n" not in str(caught.value)


def test_a_body_without_room_for_a_winch() -> None:
    with pytest.raises(InputError, match="no winch fits"):
        design_cables(body(), [UP], winches=1, cables=1, method="trees", constraints=Constraints(winch_clearance=0.026))


def test_more_winches_than_the_muscles_can_feed() -> None:
    with pytest.raises(HydrostatError, match=r"no network of 20 winches.*fewer winches"):
        design_cables(body(), [UP], winches=20, cables=20, method="trees", options=TreeOptions(thresholds=(20,)))


def test_a_pose_that_is_there_already() -> None:
    with pytest.raises(HydrostatError, match="bends the body more"):
        design_cables(
            body(), [PoseTarget(name="rest", targets={"tip": (0.2, 0.0)})], winches=1, cables=1, method="trees"
        )


@pytest.mark.parametrize("case", CASES)
def test_no_cable_turns_sharply(case: str, unchecked: None) -> None:
    """Oracle: angles between segments by arctan2; felt would hold a cable that doubles back."""
    for cable in designed(case).robot.cables:
        spans = np.diff(np.array(cable.points), axis=0)
        turns = np.diff(np.unwrap(np.arctan2(spans[:, 1], spans[:, 0])))
        assert np.abs(turns).max(initial=0.0) <= np.radians(TreeOptions().turn) + 1e-3


@pytest.mark.parametrize("asked", [{"seconds": 9.0}, {"front": True}, {"constraints": Constraints(mirror="x")}])
def test_searches_that_trees_do_not_know_begin_from_trees_too(asked: dict[str, Any], unchecked: None) -> None:
    """Oracle: the trees that the search begins from without a time limit, a front, or a mirror line."""
    robot, request = body(), DesignRequest(poses=(UP,), winches=1, cables=2)
    usual, given = (_trees(robot, each, BodyPhysics(robot)) for each in (request, replace(request, **asked)))
    assert [robot_hash(found) for found in given] == [robot_hash(found) for found in usual]
    assert len(usual) == 1
