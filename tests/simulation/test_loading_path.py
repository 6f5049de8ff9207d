"""Robots whose cables rub. Oracles: the capstan law, cables without friction, differences, the balance of energy."""

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from builders import box_robot, mesh_body, strip_mesh, strip_robot
from typer.testing import CliRunner

from hydrostat.cli.main import app
from hydrostat.mechanics import FrictionCableEnergy
from hydrostat.robot import Cable, Mount, Pin, Robot, Winch, load_robot, save_robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.simulation.statics import loading_path

WAVY = (0.005, 0.018, 0.008, 0.016, 0.004, 0.012)


def rub(robot: Robot, friction: float) -> Robot:
    return robot.with_network(robot.winches, [replace(cable, friction=friction) for cable in robot.cables])


def wavy_strip(
    friction: float, *, mount: Mount = Mount.BODY, slack: float = 0.0, sheathed: tuple[tuple[int, int], ...] = ()
) -> Robot:
    """A strip whose upper cable zigzags."""
    robot = strip_robot(mount=mount, slack=slack, sheathed=sheathed)
    first, *others = robot.cables
    waves = tuple((x, y) for (x, _), y in zip(first.points[1:], WAVY, strict=True))
    return rub(robot.with_network(robot.winches, [replace(first, points=(first.points[0], *waves)), *others]), friction)


ROBOTS = {
    "strip": lambda: wavy_strip(0.3),
    "world": lambda: wavy_strip(0.3, mount=Mount.WORLD),
    "sheathed": lambda: wavy_strip(0.3, sheathed=((1, 3),)),
    "slack": lambda: wavy_strip(0.3, slack=0.004),
    "box": lambda: rub(box_robot(), 0.5),
}
PULL = np.array([0.02, 0.008])


def settled(simulation: Simulation, pose: Equilibrium) -> FrictionCableEnergy:
    assert simulation.friction is not None
    return simulation.friction.with_history(pose.history, pose.nodes, pose.contractions)


def span_tensions(simulation: Simulation, pose: Equilibrium) -> np.ndarray:
    return settled(simulation, pose).span_tensions(pose.nodes, pose.contractions)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_trace_of_friction_is_none(name: str) -> None:
    """Oracle: the robot without friction; a coefficient of 1e-14 changes no tension by more than 1e-13 of itself."""
    robot = ROBOTS[name]()
    plain, traced = Simulation(rub(robot, 0.0)), Simulation(rub(robot, 1e-14))
    expected, pose = plain.solve(PULL), traced.solve(PULL)
    assert expected.history.size == 0 < pose.history.size
    assert np.abs(pose.nodes - expected.nodes).max() < 1e-9 * robot.body.mesh.size
    assert pose.tensions == pytest.approx(expected.tensions, rel=1e-8)
    assert pose.energy == pytest.approx(expected.energy, rel=1e-8)


@pytest.mark.parametrize("name", ROBOTS)
def test_tensions_obey_the_capstan_law(name: str) -> None:
    """Neighboring tensions differ by at most exp(mu angle), by just that where cable slips; and balance the body."""
    simulation = Simulation(ROBOTS[name]())
    there = simulation.solve(PULL)
    back = simulation.solve(0.5 * PULL, start=there)
    for before, step in ((there, 1e-3), (back, -1e-3)):
        pose = simulation.solve(before.contractions + step * PULL, start=before)
        cables = settled(simulation, pose)
        tensions, factors = span_tensions(simulation, pose), np.exp(cables.friction * cables.angles(pose.nodes))
        rubs = np.flatnonzero(cables.friction > 0)
        ratios, slips = tensions[rubs - 1] / tensions[rubs], (pose.history - before.history)[rubs]
        moved = np.abs(slips) > 1e-12
        assert moved.sum() >= 6
        assert (np.sign(slips[moved]) == np.sign(step)).all()
        assert tensions.min() > 0
        assert (np.abs(np.log(ratios)) <= np.log(factors[rubs]) + 1e-6).all()
        assert ratios[moved] == pytest.approx(factors[rubs][moved] ** np.sign(step), rel=1e-6)
        assert factors.max() > 1.01
        assembly = simulation.assembly.with_energies([*simulation.assembly.energies[:-1], cables])
        left = np.abs(assembly.gradient(pose.nodes, pose.contractions)).max()
        assert left < 1e-7 * tensions.max()


def test_a_cable_round_a_body_that_is_held() -> None:
    """Oracle: exp(-mu angle) of the rest shape; pins of 1e9 N/m hold every node."""
    angles = np.linspace(0.2, np.pi - 0.2, 9)
    points = tuple((0.1 - 0.02 * float(np.cos(a)), 0.02 * float(np.sin(a)) - 0.01) for a in angles)
    robot = Robot(
        name="held",
        body=mesh_body(strip_mesh(16, 4)),
        pins=(Pin(box=((-1.0, -1.0), (1.0, 1.0)), stiffness=1e9),),
        winches=(Winch(name="one", at=points[0]),),
        cables=(Cable(winch="one", points=points, friction=0.4),),
        markers=(),
        poses={},
    )
    simulation = Simulation(robot)
    pose = simulation.solve(np.array([0.003]))
    tensions = span_tensions(simulation, pose)
    assert tensions[-1] / tensions[0] == pytest.approx(np.exp(-0.4 * 7 * (angles[1] - angles[0])), rel=1e-4)
    cables = settled(simulation, pose)
    assert tensions[-1] / tensions[0] == pytest.approx(np.exp(-0.4 * cables.angles(pose.nodes).sum()), rel=1e-7)
    assert pose.tensions[0] == tensions[0]


@pytest.mark.slow
def test_loading_and_unloading_differ_and_the_loop_closes() -> None:
    """Oracle: the work of the winch in a closed loop is what friction dissipates: sum of limits x slips, above 0."""
    simulation = Simulation(wavy_strip(0.3))
    turn, steps = 0.02, 40
    pose = simulation.solve(np.array([turn, 0.0]))
    pose = simulation.solve(np.array([0.4 * turn, 0.0]), start=pose)
    pose = first = simulation.solve(np.array([turn, 0.0]), start=pose)
    work = dissipated = 0.0
    loop = [turn, *np.linspace(turn, 0.4 * turn, steps)[1:], *np.linspace(0.4 * turn, turn, steps)[1:]]
    tensions, tips = {}, {}
    for before, contraction in pairwise(loop):
        after = simulation.solve(np.array([contraction, 0.0]), start=pose)
        cables = settled(simulation, after)
        dissipated += float(cables.law.limits @ np.abs(after.history - pose.history))
        work += 0.5 * (pose.tensions[0] + after.tensions[0]) * (contraction - before)
        assert span_tensions(simulation, after).min() >= 0
        tensions.setdefault(round(contraction, 6), []).append(after.tensions[0])
        tips.setdefault(round(contraction, 6), []).append(after.markers["tip"][1])
        pose = after
    assert np.abs(pose.nodes - first.nodes).max() < 1e-8
    assert pose.energy == pytest.approx(first.energy, rel=1e-8)
    assert dissipated > 0
    assert work == pytest.approx(dissipated, rel=0.02)
    pairs = [pair for pair in tensions.values() if len(pair) == 2]
    assert len(pairs) >= steps - 2
    assert all(let_out < taken_in for let_out, taken_in in pairs), "a winch that lets out feels less"
    assert max(np.ptp(pair) for pair in tips.values()) > 1e-3


@pytest.mark.parametrize("name", ["strip", "sheathed", "box"])
def test_one_increment_or_many(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Contractions that grow in proportion lead to the same pose in increments of any size."""
    poses = []
    for share in (1.0, 0.05, 0.01):
        monkeypatch.setattr(loading_path, "_INCREMENT", share)
        poses.append(Simulation(ROBOTS[name]()).solve(PULL))
    size = np.ptp(poses[0].nodes, axis=0).max()
    for pose in poses[1:]:
        assert np.abs(pose.nodes - poses[0].nodes).max() < 1e-7 * size
        assert np.abs(pose.history - poses[0].history).max() < 1e-7 * size


@pytest.mark.parametrize("name", ROBOTS)
def test_jacobian_goes_on_the_way_the_robot_came(name: str) -> None:
    """Oracle: differences between poses along the same way, while it is pulled and while it is let go."""
    simulation = Simulation(ROBOTS[name]())
    there = simulation.solve(PULL)
    back = simulation.solve(0.5 * PULL, start=there)
    for pose, sign in ((there, 1), (back, -1)):
        moves = simulation.jacobian(pose) @ PULL
        step = 1e-5
        beyond = simulation.solve(pose.contractions + sign * step * PULL, start=pose)
        found = sign * (beyond.nodes - pose.nodes) / step
        assert np.abs(found - moves).max() < 2e-4 * np.abs(moves).max()


def test_a_pose_is_kept_when_nothing_changes() -> None:
    simulation = Simulation(wavy_strip(0.3))
    pose = simulation.solve(PULL)
    again = simulation.solve(PULL, start=pose)
    assert np.abs(again.nodes - pose.nodes).max() < 1e-9
    assert again.tensions == pytest.approx(pose.tensions, rel=1e-6)


@pytest.mark.slow
def test_the_command_line_simulates_friction(tmp_path: Path) -> None:
    """Oracle: the same robot by the library."""
    robot = load_robot(Path(__file__).parents[2] / "examples" / "starfish")
    save_robot(rub(robot, 0.2), tmp_path / "rubbing")
    command = ["simulate", str(tmp_path / "rubbing"), "--contract", "left=20mm", "--out", str(tmp_path / "out")]
    ran = CliRunner().invoke(app, command)
    assert ran.exit_code == 0, ran.output
    facts = json.loads((tmp_path / "out" / "pose.json").read_text())
    expected = Simulation(load_robot(tmp_path / "rubbing")).solve({"left": 0.02})
    assert facts["tensions"] == pytest.approx(expected.tensions.tolist())
    plain = Simulation(robot).solve({"left": 0.02})
    assert expected.tensions[1] > 1.05 * plain.tensions[1]
