"""Holes left out. Oracles: a straight cable, whose inner holes do nothing, and fresh solutions."""

from types import SimpleNamespace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes.evaluator import Evaluator
from hydrostat.design.routes.final_judgement import FinalJudgement
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.routes.thin import remove_via_points
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.robot import PoseTarget, Winch

LIMITS = Constraints(winch_clearance=0.006, leads=False, built_in=False)
UP = PoseTarget(name="up", targets={"tip": (0.18, 0.06)})


def growth_of(tolerances: BuildTolerances, simplicity: float) -> Growth:
    robot = strip_robot(columns=10, rows=3).with_network((), ())
    graph = RouteGraph.build(robot, Region.of_body(robot.body, LIMITS.clearance), LIMITS, spacing=0.03)
    evaluator = Evaluator(robot, [UP], LIMITS, tolerances)
    return Growth(Proposals(evaluator, graph, RouteOptions(simplicity=simplicity), 0.05), lambda *_: None)


def line(growth: Growth, heights: list[float]) -> Layout:
    points = np.column_stack([np.linspace(0.03, 0.17, len(heights)), heights])
    site = WinchSite(Winch(name="one", at=tuple(map(float, points[0])), travel=0.06))
    return Layout(growth.evaluator.source, LIMITS, (site,), (CableRoute(0, points),))


def test_inner_holes_of_a_straight_cable_are_left_out(unchecked: None) -> None:
    """On its two ends it pulls as before: what it misses in the model stays the same, and fewer holes vary."""
    growth = growth_of(BuildTolerances(), 1.0)
    trial = growth.evaluator.reach_poses(line(growth, [0.012] * 7), None)
    assert trial is not None
    thinner = remove_via_points(growth, trial)
    assert len(thinner.layout.routes[0].points) < 4
    assert thinner.cost <= 1.003**5 * trial.cost
    again = growth.evaluator.reach_poses(thinner.layout, None)
    assert again is not None
    assert abs(again.cost - thinner.cost) < 0.01 * thinner.cost


def test_holes_that_matter_stay(unchecked: None) -> None:
    """Without its middle the cable would cross the neutral line of the strip, and bend it the other way round."""
    growth = growth_of(BuildTolerances.none(), 0.0)
    heights = [-0.01, 0.0, 0.012, 0.017, 0.012, 0.0, -0.01]
    trial = growth.evaluator.reach_poses(line(growth, heights), None)
    assert trial is not None
    thinner = remove_via_points(growth, trial)
    assert thinner.cost <= trial.cost
    kept = thinner.layout.routes[0].points[:, 1]
    assert kept.max() > 0.01


@pytest.mark.parametrize(("error", "is_thinner"), [(1.01, True), (1.03, False)])
def test_holes_left_out_may_cost_two_percent_and_the_network_with_them_stays(
    monkeypatch: pytest.MonkeyPatch, error: float, is_thinner: bool
) -> None:
    """Oracle: `thinner_cost` of the rules; the other network is the first alternative, so nothing found is lost."""
    monkeypatch.setattr("hydrostat.design.routes.final_judgement.kit_fits", lambda _: True)
    thinner, whole = (SimpleNamespace(robot=None, built=built) for built in (error, 1.0))
    finalists = SimpleNamespace(
        judge_all=lambda trials, thorough=True: list(trials),
        cost=lambda one: one.built,
        judge=lambda _: None,
        constraints=SimpleNamespace(built_in=False),
    )
    monkeypatch.setattr("hydrostat.design.routes.final_judgement.layout_of", lambda *_: None)
    judgement = object.__new__(FinalJudgement)  # whose types are not those of the stand-ins
    vars(judgement).update(
        finalists=finalists, found=[thinner, whole], passed=[], sizes={}, thinner=thinner, complete=True, networks=[]
    )
    judgement.judge_networks()
    assert judgement.networks == ([thinner, whole] if is_thinner else [whole, thinner])
