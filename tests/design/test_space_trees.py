"""Winch trees in space. Oracles: places along segments, brute force over places, a fresh simulation, counts by hand."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import box_robot, gallery_robot

from hydrostat.design import Constraints, FibreKind, Network, TreeOptions, TreeTrace, design_cables
from hydrostat.design.buildable import violations
from hydrostat.design.region import Region
from hydrostat.design.trees.lead_paths import LeadPaths, find_lead_paths
from hydrostat.design.trees.winch_trees import WinchTrees, tree_score
from hydrostat.ik import solve_ik
from hydrostat.robot import Mount, PoseTarget, Robot
from hydrostat.simulation import Simulation

LIMITS = Constraints()
KNOBS = {"threshold": 50, "distance": 1.5, "steps": 10}


@cache
def designed(name: str, pose: str, phi: float = 0.5, kind: FibreKind = FibreKind.EDGES) -> Network:
    """By the thesis's search as it stands: one value of each knob."""
    robot = gallery_robot(name)
    options = replace(TreeOptions.single(phi=phi, **KNOBS), fibres=kind)  # type: ignore[arg-type]
    return design_cables(robot, [robot.pose(pose)], winches=2, cables=4, method="trees", options=options)


@cache
def ways(name: str) -> LeadPaths:
    robot = gallery_robot(name)
    return find_lead_paths(robot, Region.of_body(robot.body, LIMITS.clearance), LIMITS)


def test_ways_run_inside_and_end_at_winches_in_the_world(unchecked: None) -> None:
    """Half a clearance all along, by 41 places of each run; into winches only from the part that is held."""
    robot, found = gallery_robot("trunk"), ways("trunk")
    region = Region.of_body(robot.body, LIMITS.clearance)
    starts, ends = found.runs.nonzero()
    inner = (starts < found.within) & (ends < found.within)
    shares = np.linspace(0, 1, 41)[:, None, None]
    first, second = found.points[starts[inner]], found.points[ends[inner]]
    assert region.depths((first + shares * (second - first)).reshape(-1, 3)).min() >= 0.0025 - 4e-5
    assert not (starts >= found.within).any()
    assert [tuple(found.points[place]) for place in found.places] == [winch.at for winch in robot.winches]
    entries = found.points[np.unique(starts[ends >= found.within])]
    assert region.depths(entries).min() >= LIMITS.clearance
    held = robot.pins[0].anchors(robot.body.mesh).positions(robot.body.mesh.nodes)
    away = np.linalg.norm(entries[:, None] - held, axis=2).min(axis=1)
    assert away.max() <= robot.body.mesh.edge_lengths.mean() * (1 + 1e-6)


def test_winches_stand_in_a_body_where_the_robots_own_do() -> None:
    """A box 40 mm thick: 12 mm deep."""
    robot = box_robot()
    found = find_lead_paths(robot, Region.of_body(robot.body, 0.005), LIMITS)
    places = found.points[found.places]
    assert len(places)
    assert not any(map(found.outside, found.places.tolist()))
    assert np.minimum(places, np.array([0.12, 0.04, 0.04]) - places).min() >= LIMITS.winch_clearance


@pytest.mark.slow
@pytest.mark.parametrize(("name", "pose"), [("trunk", "feed"), ("bear", "hug")])
def test_a_network_in_space_can_be_built(name: str, pose: str, unchecked: None) -> None:
    """By sentences of the checks, which know nothing of trees; and it reaches what it says, by a fresh simulation."""
    network, robot = designed(name, pose), gallery_robot(name)
    limits = replace(LIMITS, cable_gap=0.0, max_turn=TreeOptions.turn)
    assert violations(network.robot, limits, Region.of_body(robot.body, LIMITS.clearance)) == []
    own = {winch.at for winch in robot.winches}
    world = robot.winches[0].mount is Mount.WORLD
    assert all((winch.at in own and winch.mount is Mount.WORLD) == world for winch in network.robot.winches)
    again = solve_ik(Simulation(network.robot), robot.pose(pose), start=network.ik_results[0].pose)
    assert again.rms_error <= network.rms_error + 1e-6
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    rest = [np.sum((places[marker] - goal) ** 2) for marker, goal in robot.pose(pose).targets.items()]
    assert network.rms_error < 0.6 * np.sqrt(np.mean(rest))


@pytest.mark.slow
@pytest.mark.parametrize("phi", [0.0, 0.5])
def test_the_first_winch_scores_best_of_all_places_and_routes(phi: float, unchecked: None) -> None:
    """R39, R41, R43: the strongest fibres, then brute force over each winch of the trunk and each run of routes."""
    network, robot = designed("trunk", "feed", phi), gallery_robot("trunk")
    trace = network.trace
    assert isinstance(trace, TreeTrace)
    tensions, kept = trace.activations[0].tensions, trace.candidates[0]
    assert network.num_evaluated == 1
    assert len(kept) == KNOBS["threshold"]
    assert tensions[kept].min() >= np.delete(tensions, kept).max()
    routes, posed = list(trace.trees), [trace.activations[0].nodes]
    options = TreeOptions.single(phi=phi)
    trees = WinchTrees(robot.body.mesh, routes, posed, ways("trunk"), LIMITS, options)
    order = np.argsort(trees.shortenings[:, 0], kind="stable")
    scale = trees.shortenings.max()
    scores = {
        (place, int(first)): tree_score(trees.shortenings[order[first : first + 2]] / scale, phi)
        - options.lead_penalty * float(trees.leads[place, order[first : first + 2]].mean()) / robot.body.mesh.size
        for place in range(len(trees.places))
        for first in range(len(routes) - 1)
    }
    found = trees.best(2, set(), [], phi)
    assert found is not None
    assert found.score == pytest.approx(max(scores.values()), abs=1e-12)
    # That winch is in the network, whatever other one was placed after it.
    assert tuple(trees.ways.points[found.place]) in {winch.at for winch in network.robot.winches}


@pytest.mark.slow
def test_fibres_of_elements_in_space(unchecked: None) -> None:
    """R37: one in each tetrahedron."""
    network = designed("trunk", "feed", kind=FibreKind.ELEMENTS)
    assert isinstance(network.trace, TreeTrace)
    assert len(network.trace.activations[0].fibres) == len(gallery_robot("trunk").body.mesh.elements)


def test_two_winches_in_the_world_stand_at_two_places() -> None:
    """Both winches of a box stand 5 mm apart in the world, nearer than two in a body may."""
    box = box_robot()
    at = {"one": (-0.05, 0.02, 0.02), "two": (-0.05, 0.025, 0.02)}
    winches = [replace(winch, at=at[winch.name], mount=Mount.WORLD) for winch in box.winches]
    cables = [replace(cable, points=(at[cable.winch], *cable.points[1:])) for cable in box.cables]
    robot: Robot = box.with_network(winches, cables)
    pose = PoseTarget(name="up", targets={"tip": (0.1, 0.05, 0.035)})
    options = TreeOptions.single(threshold=30, distance=1.0)
    network = design_cables(robot, [pose], winches=2, cables=2, method="trees", options=options)
    assert {winch.at for winch in network.robot.winches} == set(at.values())
    for cable in network.robot.cables:
        assert cable.points[0] == next(winch.at for winch in network.robot.winches if winch.name == cable.winch)
        assert cable.points[1][0] <= 0.02  # where it enters, near the end that is held
        assert not cable.bare[0]
