"""The first cable. Oracle: brute force, every straight pair of via points solved as a network of its own."""

from itertools import permutations

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes.evaluator import Evaluator
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import CableRoute, Layout, WinchSite
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.robot import PoseTarget, Winch

LIMITS = Constraints(winch_clearance=0.006, leads=False, cable_gap=0.0)


def test_the_first_cable_is_nearly_the_best_of_all_short_ones(unchecked: None) -> None:
    """Each of one segment, from every place where a winch may stand; the grown one may be of up to two hops."""
    robot = strip_robot(columns=6, rows=2).with_network((), ())
    evaluator = Evaluator(robot, [PoseTarget(name="up", targets={"tip": (0.199, 0.006)})], LIMITS)
    graph = RouteGraph.build(robot, Region.of_body(robot.body, LIMITS.clearance), LIMITS, spacing=0.03)
    # Far apart, so that paths of two hops stay straight and no point is moved.
    growth = Growth(
        Proposals(evaluator, graph, RouteOptions(max_edges=2, trials=6, steps=0, starts=1), 0.06), lambda *_: None
    )
    start = growth.evaluate(Layout(robot, LIMITS, (), ()))
    assert start is not None
    (grown, *_) = growth.grow_networks([start], winches=1, cables=1)
    joined = {tuple(pair) for pair in graph.edges.tolist()}
    errors = []
    for first, last in permutations(range(len(graph.points)), 2):
        if first not in graph.winch_places or (min(first, last), max(first, last)) not in joined:
            continue
        stand = WinchSite(Winch(name="one", at=tuple(map(float, graph.points[first]))))
        line = CableRoute(0, graph.points[[first, last]])
        found = evaluator.reach_poses(Layout(robot, LIMITS, (stand,), (line,)), start, iterations=6)
        if found is not None:
            errors.append(found.error)
    assert len(errors) > 20
    assert grown.cost <= 1.05 * min(errors)
    assert grown.error < 0.5 * start.error


@pytest.mark.parametrize("cables", [1, 2])
def test_growth_stops_at_the_count(cables: int, unchecked: None) -> None:
    robot = strip_robot(columns=6, rows=2).with_network((), ())
    evaluator = Evaluator(robot, [PoseTarget(name="up", targets={"tip": (0.18, 0.06)})], LIMITS)
    graph = RouteGraph.build(robot, Region.of_body(robot.body, LIMITS.clearance), LIMITS, spacing=0.03)
    noted: list[int] = []
    growth = Growth(
        Proposals(evaluator, graph, RouteOptions(max_edges=4, trials=2, steps=1, starts=1), 0.05),
        lambda _, trial: noted.append(len(trial.layout.routes)),
    )
    start = growth.evaluate(Layout(robot, LIMITS, (), ()))
    assert start is not None
    networks = growth.grow_networks([start], winches=1, cables=cables)
    assert {len(grown.layout.sites) for grown in networks} == {1}
    assert sorted({len(grown.layout.routes) for grown in networks}) == list(range(1, cables + 1))
    assert list(dict.fromkeys(noted)) == list(range(1, cables + 1))  # each size, first met in this order
    assert len(networks) < len(noted) <= len(networks) + 3  # the best three are refined once more
    assert [grown.cost for grown in networks] == sorted(grown.cost for grown in networks)
    assert np.isfinite(growth.resolve_from_rest(networks[0]).error)
