"""Ways to the same contractions. Oracles: solves counted one by one, the other pose of an arch."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from arches import arch
from builders import strip_robot

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.simulation.branches.loading_paths import Approach, follow_approach, loading_paths_to

pytestmark = pytest.mark.usefixtures("unchecked")


class Recording(Simulation):
    """Keeps where each solve began, and to what contractions it went."""

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot)
        self.starts: list[Equilibrium | None] = []
        self.goals: list[Any] = []

    def solve(self, contractions: Any, *, start: Equilibrium | None = None, strict: bool = True) -> Equilibrium:
        self.starts.append(start)
        self.goals.append(contractions)
        return super().solve(contractions, start=start, strict=strict)


def wound(travel: float, release: float) -> Recording:
    """A strip whose two winches take in and let out so much [m]."""
    robot = strip_robot(columns=8, rows=2)
    winches = tuple(replace(winch, travel=travel, release=release) for winch in robot.winches)
    return Recording(replace(robot, winches=winches))


def names(robot: Robot, goal: Vector) -> list[str]:
    return [way.name for way in loading_paths_to(Simulation(robot), goal, 5, seed=0)]


def test_winches_that_mostly_let_out_go_in_as_few_steps() -> None:
    """Ten steps are the whole range, at whatever end of it rest lies; then ten back from its other end."""
    simulation, goal = wound(1e-6, 0.03), np.full(2, -0.03)
    for way in loading_paths_to(simulation, goal, 3, seed=0):
        simulation.goals.clear()
        pose = follow_approach(simulation, way)
        assert pose.result.converged
        assert pose.contractions == pytest.approx(goal)
        assert len(simulation.goals) <= 1 + 1 + 10 + 1


def test_a_way_far_beyond_the_range_has_an_end() -> None:
    simulation = wound(1e-6, 0.0)
    pose = follow_approach(simulation, Approach(name="far", stops=(np.array([0.01, 0.0]),)))
    assert pose.contractions == pytest.approx([0.01, 0.0])
    assert len(simulation.goals) == 1 + 100


def test_where_cable_is_let_out_there_is_a_way_back_from_there() -> None:
    """Only there; it goes to full release first."""
    goal = np.array([0.01, 0.0])
    assert "back from full release" not in names(wound(0.06, 0.0).robot, goal)
    simulation = wound(0.06, 0.02)
    back = next(way for way in loading_paths_to(simulation, goal, 5, seed=0) if way.name == "back from full release")
    np.testing.assert_array_equal(back.stops, [[-0.02, -0.02], goal])
    assert follow_approach(simulation, back).contractions == pytest.approx(goal)
    assert any((np.asarray(stop) == -0.02).all() for stop in simulation.goals)


def test_a_push_moves_the_body_aside_by_its_reach() -> None:
    """Small enough that arcs are straight; the push is what the last solve begins at."""
    simulation, reach = Recording(arch()), 0.01
    push = simulation.body.masses[:, None] * np.array([0.0, -1.0])
    pose = follow_approach(simulation, Approach(name="pushed", stops=(np.array([0.145]),), push=push, reach=reach))
    before, pushed = simulation.starts[-1], pose.nodes
    assert before is not None
    aside = np.linalg.norm(before.nodes - pushed, axis=1).max() / simulation.robot.body.mesh.size
    assert aside == pytest.approx(reach, rel=0.05)


def test_a_push_makes_an_arch_snap() -> None:
    """It rests up after small steps alone, and down after a push that way."""
    simulation = Simulation(arch())
    push = simulation.body.masses[:, None] * np.array([0.0, -1.0])
    way = Approach(name="pushed", stops=(np.array([0.145]),), push=push, reach=0.25)
    assert follow_approach(simulation, replace(way, push=None)).markers["top"][1] > 0
    down = follow_approach(simulation, way)
    assert down.result.stable
    assert down.markers["top"][1] < 0
