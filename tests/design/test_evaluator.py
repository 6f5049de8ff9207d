"""What is cut short on the evaluator. Oracle: the same work without the cut."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes import reach_from_rest as from_rest
from hydrostat.design.routes.begin import layout_of
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.ik import IKOptions, IKResult, solve_ik
from hydrostat.robot import Marker, PoseTarget
from hydrostat.simulation import Simulation

LIMITS = Constraints(winch_clearance=0.006, leads=False)
POSES = [PoseTarget(name="up", targets={"tip": (0.18, 0.06)}), PoseTarget(name="down", targets={"tip": (0.18, -0.06)})]


def robot_and_bench() -> tuple[Layout, Evaluator]:
    robot = strip_robot(columns=6, rows=2)
    return layout_of(robot, LIMITS), Evaluator(robot, POSES, LIMITS)


@pytest.mark.parametrize("start", ["rest", "trial"])
def test_a_bound_on_the_error_changes_only_what_is_above_it(start: str, unchecked: None) -> None:
    layout, evaluator = robot_and_bench()
    whole = evaluator.reach_poses(layout, None)
    assert whole is not None
    before = None if start == "rest" else whole
    found = evaluator.reach_poses(layout, before)
    assert found is not None
    assert found.error > 1e-3
    same = evaluator.reach_poses(layout, before, worst=1.001 * found.error)
    assert same is not None
    assert same.error == found.error
    assert evaluator.reach_poses(layout, before, worst=0.999 * found.error) is None


def test_a_held_layout_above_the_bound_is_none(unchecked: None) -> None:
    layout, evaluator = robot_and_bench()
    trial = evaluator.reach_poses(layout, None)
    assert trial is not None
    pulls = [pose.contractions for pose in trial.poses]
    same = evaluator.hold_contractions(layout, pulls, trial, worst=1.001 * trial.error)
    assert same is not None
    assert same.error == pytest.approx(trial.error, rel=1e-6)
    assert evaluator.hold_contractions(layout, pulls, trial, worst=0.999 * trial.error) is None


def test_the_best_candidates_are_those_of_all_solved_to_the_end(unchecked: None) -> None:
    robot = strip_robot(columns=6, rows=2).with_network((), ())
    evaluator = Evaluator(robot, POSES, LIMITS)
    graph = RouteGraph.build(robot, Region.of_body(robot.body, LIMITS.clearance), LIMITS, spacing=0.03)
    growth = Growth(Proposals(evaluator, graph, RouteOptions(max_edges=4, trials=6, steps=0), 0.05), lambda *_: None)
    start = growth.evaluate(Layout(robot, LIMITS, (), ()))
    assert start is not None
    layouts = growth.build(start, growth.price(start, 1, 2, best=6), 1, best=6)
    (best,) = growth.solve_layouts(start, layouts, best=1)
    every = [evaluator.reach_poses(layout, start, iterations=5) for layout in layouts]
    ratings = sorted(growth._rate(trial) for trial in every if trial is not None)
    assert len(ratings) > 3
    assert ratings[0] < ratings[-1]
    assert growth._rate(best) == ratings[0]


def test_a_pose_that_misses_more_than_hoped_is_sought_again(monkeypatch: pytest.MonkeyPatch, unchecked: None) -> None:
    layout, evaluator = robot_and_bench()
    good = evaluator.reach_poses(layout, None)
    asked: list[int] = []

    def watched(*given: Any, options: IKOptions, **more: Any) -> IKResult:
        asked.append(options.restarts)
        return solve_ik(*given, options=options, **more)

    monkeypatch.setattr(from_rest, "solve_ik", watched)
    poor = evaluator.reach_poses(layout, None, iterations=0)
    assert good is not None
    assert poor is not None
    assert poor.error > 1.2 * good.error
    assert asked == [0, 0]
    evaluator.reach_poses(layout, None, hoped=poor)
    assert asked == [0, 0] * 2
    evaluator.reach_poses(layout, None, iterations=0, hoped=good)
    assert 1 in asked[4:]


def test_poses_from_rest_are_told(unchecked: None) -> None:
    layout, evaluator = robot_and_bench()
    graph = RouteGraph.build(
        evaluator.source, Region.of_body(evaluator.source.body, LIMITS.clearance), LIMITS, spacing=0.03
    )
    growth = Growth(Proposals(evaluator, graph, RouteOptions(), 0.05), lambda *_: None)
    found = evaluator.reach_poses(layout, None)
    assert isinstance(found, Trial)
    assert not found.from_rest
    assert growth.resolve_from_rest(found).from_rest
    assert growth.resolve_from_rest(found, worst=0.5 * found.error).error == np.inf


def test_markers_that_a_pose_does_not_name_count_a_hundredth(unchecked: None) -> None:
    """Oracle: the sum written out."""
    layout, _ = robot_and_bench()
    low = Marker(name="low", at=(0.1, 0.005))
    robot = replace(layout.source, markers=(*layout.source.markers, low))
    evaluator = Evaluator(robot, [PoseTarget(name="up", targets={"tip": (0.19, 0.04)})], LIMITS)
    simulation = Simulation(replace(layout, source=robot).robot())
    pose = simulation.solve(np.array([0.01, 0.0]))
    tip, others = pose.markers["tip"], pose.markers["low"]
    found = evaluator.residual(simulation, 0, pose.nodes)
    expected = np.sum((tip - (0.19, 0.04)) ** 2) + 0.01 * np.sum((others - low.at) ** 2)
    assert found @ found == pytest.approx(expected)
    assert np.linalg.norm(others - low.at) > 1e-4
