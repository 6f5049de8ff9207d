"""Loads that vary in a motion. Oracles: statics of the load at the end, a point mass, work and energy."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.robot import Load, Marker, Pin, Robot
from hydrostat.simulation import ContractionProfile, Motion, Simulation

IDLE = ContractionProfile(times=np.array([0.0]), values=np.zeros((1, 0)))


def loaded(*loads: Load) -> Robot:
    robot = strip_robot(columns=8, rows=2)
    return replace(robot.with_network((), ()), markers=(Marker(name="tip", at=(0.19, 0.0)),), loads=loads)


def play(robot: Robot, seconds: float, step: float) -> list[Motion]:
    simulation = Simulation(robot)
    return list(simulation.play(IDLE, seconds, step, start=simulation.motion_at_rest(None)))


@pytest.mark.parametrize("given", [{"force": (0.02, -0.05)}, {"moment": (4e-3,)}], ids=["force", "moment"])
def test_slow_loads_end_in_the_equilibrium_of_their_share(given: dict) -> None:
    """Half of the load within 4 s, which is slow for this strip: the place of half the load in statics, to 1 %."""
    load = Load(name="slow", marker="tip", path=((0.0, 0.0), (4.0, 0.5)), **given)
    end = play(loaded(load), 4.5, 0.05)[-1]
    (key, values) = next(iter(given.items()))
    half = Load(name="half", marker="tip", **{key: tuple(0.5 * value for value in values)})
    told = Simulation(loaded(half)).solve(np.zeros(0))
    travel = told.markers["tip"] - (0.19, 0.0)
    assert end.markers["tip"] - told.markers["tip"] == pytest.approx(np.zeros(2), abs=0.01 * np.linalg.norm(travel))
    whole = Simulation(loaded(load)).solve(np.zeros(0))  # statics has no time
    full = Simulation(loaded(replace(load, path=()))).solve(np.zeros(0))
    assert np.array_equal(whole.nodes, full.nodes)


def test_impulse_of_a_load_on_a_body_that_hardly_anything_holds() -> None:
    """Oracle: momentum is the integral of the force, of a triangle in time."""
    robot = loaded(Load(name="kick", marker="tip", force=(0.3, 0.1), path=((0.0, 0.0), (0.1, 1.0), (0.2, 0.0))))
    free = replace(robot, pins=(Pin(at=(0.1, 0.0), radius=0.06, stiffness=1e-6),))
    end = play(free, 0.25, 0.01)[-1]
    momentum = Simulation(free).body.masses @ end.velocities
    assert momentum == pytest.approx(np.array([0.3, 0.1]) * 0.1, rel=1e-4)


def test_a_load_is_held_as_it_acts_at_an_instant() -> None:
    load = Load(name="late", marker="tip", force=(0.2, -0.4), path=((0.0, 0.5), (1.0, 0.0)))
    assert load.held_at(0.0) == Load(name="late", marker="tip", force=(0.1, -0.2))
    assert load.held_at(2.0) is None
