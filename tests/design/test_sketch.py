"""Sketches along the limbs. Oracles: Newton at small contractions, distances between straight runs, the clearance."""

from itertools import pairwise

import numpy as np
import pytest
from builders import strip_robot
from robustness import EXAMPLES
from scipy.optimize import nnls

from hydrostat.design.constraints import Constraints
from hydrostat.design.polyline import nearest_shares, resample
from hydrostat.design.region import Region
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.routes.sketch import LineChoice, draw_lines, sketches
from hydrostat.robot import Cable, PoseTarget, load_robot
from hydrostat.simulation import Simulation


def _begun(robot, constraints: Constraints, poses) -> tuple[Proposals, Trial]:
    robot = robot.with_network((), ())
    evaluator = Evaluator(robot, list(poses), constraints)
    spacing = float(robot.body.mesh.edge_lengths.mean())
    graph = RouteGraph.build(robot, Region.of_body(robot.body, constraints.clearance), constraints, spacing=spacing)
    proposals = Proposals(evaluator, graph, RouteOptions(), 2 * spacing)
    bare = Growth(proposals, lambda *_: None).evaluate(Layout(robot, constraints, (), ()))
    assert bare is not None
    return proposals, bare


def test_what_a_sketch_promises_is_what_small_contractions_do(unchecked: None) -> None:
    constraints = Constraints(winch_clearance=0.006)
    proposals, bare = _begun(
        strip_robot(columns=12, rows=4), constraints, [PoseTarget(name="up", targets={"tip": (0.2, 0.03)})]
    )
    lines = list(draw_lines(proposals, [marker.at for marker in bare.layout.source.markers]))
    choice = LineChoice(proposals, bare, lines, 1, 1)
    index = min(range(len(lines)), key=lambda one: choice.cost([one]))
    simulation = Simulation(proposals.with_line(bare.layout, lines[index].place, lines[index].points).robot())
    weak, strong = (simulation.solve(np.array([pulled])) for pulled in (2e-4, 4e-4))
    more = float(strong.tensions[0] - weak.tensions[0])
    promised = choice.moves[0][:, index] * more
    assert more > 0
    moved = strong.markers["tip"] - weak.markers["tip"]
    assert np.linalg.norm(moved - promised) <= 0.05 * np.linalg.norm(promised)
    short, long = (simulation.cables.elongations(pose.nodes, pose.contractions)[0] for pose in (weak, strong))
    body = choice.gives[index, index] - 1 / Cable.stiffness
    assert 2e-4 - (long - short) == pytest.approx(body * more, rel=0.05)


def test_the_error_of_a_set_of_lines_is_that_of_nonnegative_least_squares(
    starfish: tuple[Proposals, Trial], unchecked: None
) -> None:
    """Oracle: SciPy's `nnls` on the moves of the markers, lines that would push left out round by round."""
    proposals, bare = starfish
    lines = list(draw_lines(proposals, [marker.at for marker in bare.layout.source.markers]))
    choice = LineChoice(proposals, bare, lines, 3, 5)
    missed = [proposals.evaluator.residual(bare.simulation, index, pose.nodes) for index, pose in enumerate(bare.poses)]
    chance = np.random.default_rng(5)
    for count in (1, 2, 3, 5, 5, 5):
        chosen = chance.choice(len(lines), count, replace=False).tolist()
        squares = [_left(choice, chosen, index, miss) ** 2 for index, miss in enumerate(missed)]
        assert choice.cost(chosen) == pytest.approx(np.sqrt(sum(squares)) * (1 + 0.01 * count), rel=1e-7)


def _left(choice: LineChoice, chosen: list[int], pose: int, missed: np.ndarray) -> float:
    places = np.array([choice.lines[index].place for index in chosen])
    by_winch = np.equal.outer(places, np.unique(places)).astype(float)
    ridge = 0.5 * np.linalg.norm(missed) / choice.proposals.evaluator.constraints.tension_limit
    taut = np.ones(len(chosen), dtype=bool)
    for _ in range(6):
        own = np.array(chosen)[taut]
        tensions = np.linalg.solve(choice.gives[np.ix_(own, own)], by_winch[taut])
        matrix = np.vstack([choice.moves[pose][:, own] @ tensions, ridge * tensions])
        pulled, found = nnls(matrix, np.append(missed, np.zeros(len(own))))
        pushes = tensions @ pulled < -1e-6 * max((tensions @ pulled).max(), 0.0)
        if not pushes.any():
            return float(found)
        if pushes.all():
            break
        taut[np.flatnonzero(taut)[pushes]] = False
    return float(np.linalg.norm(missed))


@pytest.fixture(scope="module")
def starfish() -> tuple[Proposals, Trial]:
    robot = load_robot(EXAMPLES / "starfish")
    return _begun(robot, Constraints(), robot.poses.values())


def test_lines_keep_the_clearance_and_go_along_both_sides(starfish: tuple[Proposals, Trial], unchecked: None) -> None:
    proposals, bare = starfish
    region = proposals.graph.region
    lines = list(draw_lines(proposals, [marker.at for marker in bare.layout.source.markers]))
    assert len(lines) > 20
    for line in lines:
        assert region.depths(line.points[1:]).min() >= region.clearance
        assert region.depths(resample(line.points, 1e-3)).min() >= 0.5 * region.clearance - 1e-9
    one, other = lines[:2]  # of the same winch, to the same marker
    assert one.place == other.place
    middle = [resample(line.points, 1e-3)[len(line.points)] for line in (one, other)]
    assert np.linalg.norm(middle[0] - middle[1]) > region.clearance


def test_sketches_are_within_the_counts_and_cross_nothing(starfish: tuple[Proposals, Trial], unchecked: None) -> None:
    proposals, bare = starfish
    drawn = sketches(proposals, bare, winches=3, cables=5, count=4)
    assert drawn
    for layout in drawn:
        assert len(layout.sites) <= 3
        assert len(layout.routes) <= 5
        for index, route in enumerate(layout.routes):
            for other in layout.routes[index + 1 :]:
                if route.winch != other.winch:
                    assert _apart(route.points, other.points) >= bare.layout.constraints.cable_gap - 2e-5
    costs = [trial.cost for layout in drawn if (trial := proposals.evaluator.reach_poses(layout, None)) is not None]
    assert min(costs) < 0.5 * bare.cost


def test_there_are_no_sketches_beside_cables_or_in_the_mirror(
    starfish: tuple[Proposals, Trial], unchecked: None
) -> None:
    proposals, bare = starfish
    assert not sketches(*_begun(bare.layout.source, Constraints(mirror="x"), proposals.evaluator.targets), **COUNTS)
    (drawn,) = sketches(proposals, bare, **COUNTS)
    trial = proposals.evaluator.reach_poses(drawn, None)
    assert trial is not None
    assert not sketches(proposals, trial, **COUNTS)


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    least = np.inf
    for start, end in pairwise(one):
        runs = np.stack([other[:-1], other[1:]], axis=1)
        share, far = nearest_shares(np.repeat(np.stack([start, end])[None], len(runs), axis=0), runs)
        here, there = start + share[:, None] * (end - start), runs[:, 0] + far[:, None] * (runs[:, 1] - runs[:, 0])
        least = min(least, float(np.linalg.norm(here - there, axis=1).min()))
    return least


COUNTS = {"winches": 2, "cables": 2, "count": 1}
