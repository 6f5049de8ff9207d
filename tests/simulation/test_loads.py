"""Forces on a body, hung masses, pulls of winches. Oracles: differences, reciprocity, weights, round trips."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, gallery_robot, mesh_body, strip_robot

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import solve_pulls
from hydrostat.mechanics import NewtonOptions
from hydrostat.robot import Load, Marker, Pin, Robot
from hydrostat.simulation import Simulation, marker_compliance

TIGHT = NewtonOptions(tolerance=1e-13)


def strip(*loads: Load, gravity: tuple[float, float] | None = None) -> Robot:
    markers = (Marker(name="tip", at=(0.195, 0.003)), Marker(name="middle", at=(0.101, -0.007)))
    return replace(strip_robot(), markers=markers, loads=loads, gravity=gravity)


def block(*loads: Load) -> Robot:
    return Robot(
        name="block",
        body=mesh_body(box_mesh((6, 2, 2), size=(0.12, 0.04, 0.04))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        markers=(Marker(name="tip", at=(0.119, 0.021, 0.03)), Marker(name="middle", at=(0.061, 0.02, 0.011))),
        poses={},
        loads=loads,
    )


@pytest.mark.parametrize("make", [strip, block])
def test_compliance_and_sensitivity_are_differences(make) -> None:  # type: ignore[no-untyped-def]
    dim = 2 if make is strip else 3
    base = Load(name="base", marker="tip", force=(0.1, -0.3, 0.2)[:dim])
    simulation = Simulation(make(base), options=TIGHT)
    idle = np.zeros(len(simulation.robot.winches))
    pose = simulation.solve(idle)
    compliance = marker_compliance(simulation, pose)
    random = np.random.default_rng(1).normal(size=pose.nodes.shape)
    slopes = simulation.adjoint(pose, random).loads
    step = 1e-3
    for axis in range(dim):
        found = []
        for sign in (1, -1):
            force = np.array(base.force) + sign * step * np.eye(dim)[axis]
            other = Simulation(make(replace(base, force=tuple(force))), options=TIGHT).solve(idle)
            found.append((other.markers["tip"], float((random * other.nodes).sum())))
        moved, value = ((plus - minus) / (2 * step) for plus, minus in zip(*found, strict=True))
        assert compliance[0][:, axis] == pytest.approx(moved, rel=1e-5, abs=1e-7)
        assert slopes[0, axis] == pytest.approx(value, rel=1e-5)
    assert compliance == pytest.approx(np.swapaxes(compliance, 1, 2), rel=1e-9)


def test_small_loads_are_reciprocal() -> None:
    """Maxwell and Betti: what a force at one point moves another by, it moves this by from there."""
    force = (0.0, 0.0, 1e-4)
    at_tip = Simulation(block(Load(name="a", marker="tip", force=force)), options=TIGHT).solve([])
    at_middle = Simulation(block(Load(name="a", at=(0.061, 0.02, 0.011), force=force)), options=TIGHT).solve([])
    rest = {marker.name: np.array(marker.at) for marker in at_tip.robot.markers}
    one = (at_tip.markers["middle"] - rest["middle"])[2]
    other = (at_middle.markers["tip"] - rest["tip"])[2]
    assert one == pytest.approx(other, rel=1e-4)
    assert one > 0


def test_a_hung_mass_is_its_weight() -> None:
    gravity = (0.3, -9.81)
    hung = strip(Load(name="m", marker="tip", mass=0.02), gravity=gravity)
    pushed = strip(Load(name="m", marker="tip", force=(0.006, -0.1962)), gravity=gravity)
    one, other = (Simulation(robot).solve([0.01, 0.0]) for robot in (hung, pushed))
    assert one.nodes == pytest.approx(other.nodes, abs=1e-9)
    masses = [Simulation(robot).body.masses.sum() for robot in (hung, pushed)]
    assert masses[0] - masses[1] == pytest.approx(0.02, rel=1e-12)
    thin = Simulation(hung, options=TIGHT)
    pose = thin.solve([0.01, 0.0])
    slope = thin.adjoint(pose, np.ones_like(pose.nodes)).thickness
    values = [
        Simulation(replace(hung, body=replace(hung.body, thickness=0.03 + sign * 1e-5)), options=TIGHT)
        .solve([0.01, 0.0])
        .nodes.sum()
        for sign in (1, -1)
    ]
    assert slope == pytest.approx((values[0] - values[1]) / 2e-5, rel=1e-4)


@pytest.mark.parametrize("name", ["starfish", "octopus_arm"])
def test_pulls_lead_back_to_contractions(name: str) -> None:
    robot = gallery_robot(name)
    simulation, random = Simulation(robot), np.random.default_rng(2)
    travels = np.array([winch.travel for winch in robot.winches])
    owners = [[cable.winch == winch.name for cable in robot.cables] for winch in robot.winches]
    for share in (0.2, 0.5):
        goal = share * random.random(len(travels)) * travels
        pose = simulation.solve(goal)
        wanted = np.array(owners) * robot.spool_ratios @ pose.tensions
        pulls = {winch.name: float(pull) for winch, pull in zip(robot.winches, wanted, strict=True)}
        found = solve_pulls(simulation, pulls)
        assert found.nodes == pytest.approx(pose.nodes, abs=1e-6)
        first = robot.winches[0].name
        mixed = solve_pulls(simulation, {first: pulls.pop(first)}, dict(zip(pulls, goal[1:].tolist(), strict=True)))
        assert mixed.nodes == pytest.approx(pose.nodes, abs=1e-6)


def test_pulls_with_friction_and_out_of_reach() -> None:
    robot = strip_robot()
    rubbing = robot.with_network(robot.winches, [replace(cable, friction=0.2) for cable in robot.cables])
    name = robot.winches[0].name
    found = solve_pulls(Simulation(rubbing), {name: 2.0})
    assert found.tensions[0] == pytest.approx(2.0, rel=1e-5)
    with pytest.raises(InputError, match="must be at least 0 N, not -1"):
        solve_pulls(Simulation(robot), {name: -1.0})
    both = robot.with_network(robot.winches, [replace(cable, reverse=True) for cable in robot.cables])
    with pytest.raises(InputError, match="pulls both ways"):
        solve_pulls(Simulation(both), {name: 1.0})
    with pytest.raises(InputError, match='unknown winch "no"'):
        solve_pulls(Simulation(robot), {"no": 1.0})
    with pytest.raises(NotConvergedError):
        solve_pulls(Simulation(robot), {name: 1e6})
