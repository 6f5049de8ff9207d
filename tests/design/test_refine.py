"""Refinement and the certificate. Oracles: finite differences of true equilibria, a network whose poses are known."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.design.buildable import violations
from hydrostat.design.constraints import Constraints
from hydrostat.design.region import Region
from hydrostat.design.request import RouteOptions
from hydrostat.design.routes.begin import add_mirror_image, layout_of
from hydrostat.design.routes.certificate import certify
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.layout import CableRoute, Layout
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.refine import RefineOptions, linear_model, refine
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.robot import Marker, PoseTarget, Robot
from hydrostat.simulation import Simulation

LOOSE = Constraints(winch_clearance=0.006, slack=0.005, spool_ratio=2.0)
TWO_WAY = replace(LOOSE, two_way=True)
EFFORT = 1e-4


def strip() -> Robot:
    markers = [("tip", (0.2, 0.0)), ("mid", (0.1, 0.02)), ("low", (0.15, -0.02))]
    return replace(
        strip_robot(columns=10, rows=3, slack=0.001), markers=tuple(Marker(name=name, at=at) for name, at in markers)
    )


def poses_of(robot: Robot, contractions: list[tuple[float, ...]]) -> list[PoseTarget]:
    """What a robot reaches exactly."""
    simulation = Simulation(robot)
    found = []
    for number, pulled in enumerate(contractions):
        markers = simulation.solve(np.array(pulled)).markers
        targets = {name: tuple(map(float, place)) for name, place in markers.items()}
        found.append(PoseTarget(name=f"pose {number}", targets=targets))
    return found


def trial_at(evaluator: Evaluator, layout: Layout, contractions: list[tuple[float, ...]]) -> Trial:
    simulation = Simulation(layout.robot())
    return evaluator.trial(layout, simulation, [simulation.solve(np.array(pulled)) for pulled in contractions])


def of_a_pair() -> Layout:
    """Two mirrored cables, no longer free of each other."""
    source = strip()
    winch = layout_of(source, LOOSE).sites[0]
    line = CableRoute(0, np.array(source.cables[0].points)[[0, 2, 4, 6]], slack=0.002, ratio=1.2)
    return add_mirror_image(Layout(source, replace(LOOSE, mirror="y"), (winch,), (line,)))


def of_its_own() -> Layout:
    """Off the edges of the mesh, on which anchors have no derivative."""
    start = layout_of(strip(), LOOSE)
    numbers = start.numbers.copy()
    numbers[: start.starts[-2]] += np.tile([0.0021, 0.0007], start.starts[-2] // 2)
    numbers[start.starts[-2] : start.starts[-1]] = 1e-3
    return start.at(numbers)


def of_two_ways() -> Layout:
    """The first winch pulls the second cable when it turns back."""
    start = of_its_own()
    winches = (replace(site, winch=replace(site.winch, release=0.02)) for site in start.sites)
    second = replace(start.routes[1], winch=0, ratio=-1.3)
    return replace(start, sites=tuple(winches), routes=(start.routes[0], second), constraints=TWO_WAY)


@pytest.mark.slow
@pytest.mark.parametrize("made", [of_its_own, of_a_pair, of_two_ways])
def test_the_linear_model_agrees_with_finite_differences(made, unchecked: None) -> None:
    """All free numbers and all contractions: winches, via points, slack, ratios."""
    layout, pulled = made(), [(0.012, 0.006), (-0.015 if made is of_two_ways else 0.004, 0.015)]
    evaluator = Evaluator(layout.source, poses_of(strip(), [(0.01, 0.0), (0.0, 0.01)]), layout.constraints)
    trial = trial_at(evaluator, layout, pulled)
    region = Region.of_body(layout.source.body, layout.constraints.clearance)
    model = linear_model(evaluator, region, trial, effort=EFFORT, reach=0.006)

    def right(change: np.ndarray) -> np.ndarray:
        moved = layout.at(layout.numbers + layout.ties @ change[: model.free])
        pulls = np.array(pulled) + change[model.free :].reshape(len(pulled), -1)
        at = trial_at(evaluator, moved, [tuple(one) for one in pulls])
        parts = [
            np.concatenate([evaluator.residual(at.simulation, index, pose.nodes), EFFORT * pose.tensions])
            for index, pose in enumerate(at.poses)
        ]
        return np.concatenate(parts)

    here = right(np.zeros(model.matrix.shape[1]))
    rows = len(here)  # what is below is for turns, which count nothing here
    assert model.right[:rows] == pytest.approx(here, abs=1e-12)
    assert not model.matrix[rows:].any()
    step = 2e-6
    for column in range(model.matrix.shape[1]):
        ends = [right(sign * step * np.eye(model.matrix.shape[1])[column]) for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step)
        # An anchor that crosses from one element into the next has another slope there.
        assert model.matrix[:rows, column] == pytest.approx(slope, abs=2e-3 * np.abs(slope).max() + 2e-5), column


def hidden() -> tuple[Evaluator, Layout, Trial]:
    """Poses of a hidden network, and the same network with its via points displaced by up to 5 mm."""
    robot = strip()
    constraints = Constraints(winch_clearance=0.006, slack=0.005)
    poses = poses_of(robot, [(0.015, 0.0), (0.0, 0.012)])
    evaluator, layout = Evaluator(robot, poses, constraints), layout_of(robot, constraints)
    shifts = np.random.default_rng(5).uniform(-5e-3, 5e-3, layout.starts[-2])
    numbers = layout.numbers.copy()
    numbers[: len(shifts)] += shifts
    displaced = layout.at(numbers)
    trial = evaluator.reach_poses(displaced, None)
    assert trial is not None
    return evaluator, displaced, trial


def test_refinement_finds_a_hidden_network_again(unchecked: None) -> None:
    evaluator, _, trial = hidden()
    region = Region.of_body(evaluator.source.body, evaluator.constraints.clearance)
    found = refine(evaluator, region, trial, RefineOptions(iterations=60, effort=1e-4, straightness=0.0, progress=1e-4))
    assert trial.error > 5e-4
    assert found.error < 0.01 * trial.error
    assert violations(found.layout.robot(), evaluator.constraints, region) == []


def test_every_step_lowers_the_error_and_stays_buildable(unchecked: None) -> None:
    evaluator, _, trial = hidden()
    region = Region.of_body(evaluator.source.body, evaluator.constraints.clearance)
    for _ in range(4):
        found = refine(evaluator, region, trial, RefineOptions(iterations=1, effort=1e-4, straightness=0.0))
        assert found.error < trial.error * (1 + 1e-6)
        assert violations(found.layout.robot(), evaluator.constraints, region) == []
        for pose, stand in ((pose, stand) for pose in found.poses for stand in found.layout.sites):
            assert pose.contractions.min() >= -stand.winch.release - 1e-12
            assert pose.contractions.max() <= stand.winch.travel + 1e-12
        trial = found


def test_it_ends_where_enough_is_reached(unchecked: None) -> None:
    evaluator, _, trial = hidden()
    region = Region.of_body(evaluator.source.body, evaluator.constraints.clearance)
    assert refine(evaluator, region, trial, RefineOptions(stop_error=2 * trial.error)) is trial


def proposals(evaluator: Evaluator) -> Proposals:
    mesh = evaluator.source.body.mesh
    spacing = float(np.linalg.norm(np.diff(mesh.nodes[mesh.edges], axis=1)[:, 0], axis=1).mean())
    region = Region.of_body(evaluator.source.body, evaluator.constraints.clearance)
    graph = RouteGraph.build(evaluator.source, region, evaluator.constraints, spacing=spacing)
    return Proposals(evaluator, graph, RouteOptions(max_edges=6), 1.5 * spacing)


@pytest.mark.slow
def test_the_slope_falls_towards_an_optimum(unchecked: None) -> None:
    """Of a pose that the network cannot reach, at the best that it can; not where via points are displaced.

    It need not be nought there: via points end on edges of the mesh, where the error has no derivative.
    """
    evaluator, _, trial = hidden()
    targets = {**evaluator.targets[0].targets, "tip": (0.18, 0.04)}
    evaluator = Evaluator(evaluator.source, [PoseTarget(name="other", targets=targets)], evaluator.constraints)
    start = evaluator.reach_poses(trial.layout, None)
    assert start is not None
    region = Region.of_body(evaluator.source.body, evaluator.constraints.clearance)
    ended = refine(evaluator, region, start, RefineOptions(iterations=60, effort=0.0, progress=1e-7))
    before, after = certify(proposals(evaluator), start), certify(proposals(evaluator), ended)
    assert before.descent_rate > 0.02
    assert after.descent_rate < 0.5 * before.descent_rate


def test_what_one_more_cable_promises_comes_true(unchecked: None) -> None:
    """A small wish beside what one cable reaches: nearly linear, so the promise is kept within 30 %."""
    robot = strip()
    source = robot.with_network(robot.winches[:1], robot.cables[:1])
    reached = Simulation(source).solve(np.array([0.006])).markers
    shifts = {"tip": (-0.0006, -0.0008), "mid": (0.0, -0.0004), "low": (-0.0004, 0.0002)}
    targets = {name: tuple(map(float, np.add(place, shifts[name]))) for name, place in reached.items()}
    evaluator = Evaluator(source, [PoseTarget(name="near", targets=targets)], Constraints(winch_clearance=0.006))
    trial = evaluator.reach_poses(layout_of(source, evaluator.constraints), None)
    assert trial is not None
    priced = proposals(evaluator)
    promised = certify(priced, trial).further
    (best,) = priced.price_paths(trial, count=1)
    points = priced.graph.points
    line = CableRoute(1, points[list(best.nodes)])
    stand = replace(trial.layout.sites[0], winch=replace(source.winches[0], name="new", at=tuple(points[best.winch])))
    added = replace(trial.layout, sites=(*trial.layout.sites, stand), routes=(*trial.layout.routes, line))
    assert best.lead == (best.winch,)
    found = evaluator.reach_poses(added, trial)
    assert found is not None
    drop = trial.error**2 - found.error**2
    assert drop > 0.2 * trial.error**2
    assert trial.error**2 - promised**2 == pytest.approx(drop, rel=0.3)
