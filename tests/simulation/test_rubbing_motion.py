"""Motion of robots whose cables rub. Oracles: motion without friction, the loading path, the balance of energy."""

from dataclasses import replace

import numpy as np
import pytest
from builders import strip_robot

import hydrostat as hs
from hydrostat.mechanics import SCHEMES
from hydrostat.robot import Robot

pytestmark = pytest.mark.usefixtures("unchecked")

PULL = np.array([0.006, 0.0])


def strip(friction: float, viscosity: float = 0.0) -> hs.Simulation:
    """A strip whose first cable runs in waves, so that it turns at its points."""
    robot: Robot = strip_robot(columns=8, rows=2)
    first, *others = robot.cables
    waves = [(x, y * (0.5 if number % 2 else 1.0)) for number, (x, y) in enumerate(first.points[1:])]
    rubbing = replace(first, points=(first.points[0], *waves))
    cables = [replace(cable, friction=friction) for cable in (rubbing, *others)]
    body = replace(robot.body, material=replace(robot.body.material, viscosity=viscosity))
    return hs.Simulation(replace(robot, cables=tuple(cables), body=body))


def swinging(simulation: hs.Simulation, scheme: str = "sdirk2", steps: int = 40) -> list[hs.Motion]:
    """Let go at a pull, with the nodes thrown off it."""
    pose = simulation.solve(PULL)
    thrown = np.zeros_like(pose.nodes)
    thrown[:, 1] = 0.5 * (pose.nodes[:, 0] / np.ptp(pose.nodes[:, 0])) ** 2
    motions = [simulation.motion_at_rest(pose, velocities=thrown)]
    for _ in range(steps):
        motions.append(simulation.step(motions[-1], PULL, 0.002, options=hs.StepOptions(scheme=scheme)))
    return motions


def test_a_trace_of_friction_moves_as_none() -> None:
    """Oracle: the motion without friction."""
    smooth, rough = swinging(strip(0.0)), swinging(strip(1e-12))
    moved = np.abs(smooth[-1].nodes - smooth[0].nodes).max()
    assert moved > 1e-4
    for one, other in zip(smooth, rough, strict=True):
        assert np.abs(one.nodes - other.nodes).max() < 1e-6 * moved
        assert one.tensions == pytest.approx(other.tensions, rel=1e-5, abs=1e-6)


def test_a_slow_ramp_ends_where_the_loading_path_does() -> None:
    """Oracle: the pose of the loading path; there and half of the way back, so that cable sticks and turns."""
    simulation = strip(0.3, viscosity=500.0)
    there = simulation.solve(PULL)
    back = simulation.solve(0.5 * PULL, start=there)
    direct = simulation.solve(0.5 * PULL)
    hysteresis = np.abs(back.nodes - direct.nodes).max()
    assert hysteresis > 1e-5
    motion = simulation.motion_at_rest()
    for goal, pose in ((PULL, there), (0.5 * PULL, back)):
        begin = motion.contractions
        for share in np.linspace(0.05, 1.0, 20):
            motion = simulation.step(motion, begin + share * (goal - begin), 0.5)
        for _ in range(10):
            motion = simulation.step(motion, goal, 1.0)
        assert np.abs(motion.nodes - pose.nodes).max() < 0.02 * hysteresis


@pytest.mark.parametrize("scheme", SCHEMES)
def test_friction_takes_energy_and_never_gives_any(scheme: str) -> None:
    """Oracle: the balance of energy; nothing puts energy in while the winches stand still."""
    rough, smooth = swinging(strip(0.4), scheme), swinging(strip(0.0), scheme)
    energies = np.array([motion.energy for motion in rough])
    gained = np.diff(energies).max()
    thrown = rough[0].kinetic
    assert gained < 1e-6 * thrown
    assert energies[0] - energies[-1] > smooth[0].energy - smooth[-1].energy + 1e-3 * thrown


def test_the_same_motion_twice() -> None:
    one, other = swinging(strip(0.3), steps=10)[-1], swinging(strip(0.3), steps=10)[-1]
    assert one.nodes.tobytes() == other.nodes.tobytes()
    assert one.history.tobytes() == other.history.tobytes()
    assert one.pose.history.tobytes() == one.history.tobytes()


def test_a_start_without_its_slips_is_refused() -> None:
    simulation = strip(0.3)
    pose = replace(simulation.solve(PULL), history=np.zeros(0))
    with pytest.raises(hs.InputError, match="remember the way"):
        simulation.motion_at_rest(pose)
