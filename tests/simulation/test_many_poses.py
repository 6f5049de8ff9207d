"""Many poses at once. Oracles: one solve after the other, to the byte; finite differences; errors put in on purpose."""

import _thread
import csv
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.errors import InputError
from hydrostat.mechanics import NewtonOptions, NewtonStatus
from hydrostat.simulation import BatchResult, Equilibrium, Simulation
from hydrostat.simulation.statics import batch_result as room

pytestmark = pytest.mark.usefixtures("unchecked")

ROBOTS = {"flat": lambda: strip_robot(columns=10, rows=2), "space": box_robot}


@pytest.fixture(scope="module", params=ROBOTS)
def simulation(request: pytest.FixtureRequest) -> Simulation:
    return Simulation(ROBOTS[request.param]())


@pytest.fixture(autouse=True)
def threads_always_pay(monkeypatch: pytest.MonkeyPatch) -> None:
    """These bodies are so small that one thread would do all."""
    monkeypatch.setattr(room, "LONG_ENOUGH", 0.0)


def goals_of(simulation: Simulation, size: int) -> np.ndarray:
    return np.random.default_rng(3).uniform(0.0, 0.01, (size, len(simulation.robot.winches)))


def all_bytes(found: BatchResult) -> bytes:
    assert found.jacobians is not None
    assert found.nodes is not None
    parts = (found.contractions, found.markers, found.tensions, found.jacobians, found.nodes, found.stable)
    return b"".join(part.tobytes() for part in parts)


def test_any_number_of_threads_finds_the_bytes_of_one_solve_after_the_other(simulation: Simulation) -> None:
    goals = goals_of(simulation, 12)
    found = simulation.solve_batch(goals, nodes=True, threads=1)
    assert found.converged.all()
    assert found.stable.all()
    for number, goal in enumerate(goals):
        pose = simulation.solve(goal)
        assert found.nodes is not None
        assert found.jacobians is not None
        assert found.nodes[number].tobytes() == pose.nodes.tobytes()
        assert found.markers[number].tobytes() == np.array(list(pose.markers.values())).tobytes()
        assert found.tensions[number].tobytes() == pose.tensions.tobytes()
        slopes = np.einsum("mn,ndw->mdw", weights(simulation), simulation.jacobian(pose))
        assert np.abs(found.jacobians[number] - slopes).max() <= 1e-14 * np.abs(slopes).max()
    for threads in (2, 3, 8):
        assert all_bytes(simulation.solve_batch(goals, nodes=True, threads=threads)) == all_bytes(found)


def weights(simulation: Simulation) -> np.ndarray:
    return simulation.marker_anchors.matrix(len(simulation.robot.body.mesh.nodes)).toarray()


def test_jacobians_are_the_slopes_of_the_markers(simulation: Simulation) -> None:
    """Central differences of step h err by h^2: halved steps leave a quarter."""
    goal = goals_of(simulation, 1)[0]
    slopes = simulation.solve_batch([goal]).jacobians
    assert slopes is not None
    errors = []
    for step in (1e-4, 5e-5):
        moves = step * np.eye(len(goal))
        sides = simulation.solve_batch(np.concatenate([goal + moves, goal - moves]), jacobians=False)
        assert sides.jacobians is None
        ahead, behind = np.split(sides.markers, 2)
        differences = np.moveaxis((ahead - behind) / (2 * step), 0, -1)
        errors.append(np.abs(differences - slopes[0]).max() / np.abs(slopes).max())
    assert errors[0] < 5e-3
    assert errors[1] < 0.3 * errors[0]


def test_a_pose_that_is_not_found_leaves_nan_and_its_reason(simulation: Simulation) -> None:
    too_much = {2: 1.0, 3: 0.2}[simulation.robot.body.mesh.dim]  # [m], but less than what is taken for millimeters
    goals = np.concatenate([goals_of(simulation, 2), goals_of(simulation, 3)[2:] + too_much])
    hasty = Simulation(simulation.robot, options=NewtonOptions(iterations=7), body=simulation.body)
    found = hasty.solve_batch(goals, nodes=True)
    assert found.converged.tolist() == [True, True, False]
    assert found.statuses[2] not in (None, NewtonStatus.CONVERGED)
    assert found.errors[:2] == ("", "")
    assert found.errors[2].startswith(str(found.statuses[2]))
    assert found.jacobians is not None
    assert found.nodes is not None
    for part in (found.markers, found.tensions, found.jacobians, found.nodes):
        assert np.isnan(part[2]).all()
        assert np.isfinite(part[:2]).all()


def test_poses_have_the_warnings_of_one_solve(simulation: Simulation, tmp_path: Path) -> None:
    """Oracle: `Equilibrium.warnings` of each pose, in the plane; in space, all but those of self-intersection."""
    robot = simulation.robot
    winches = tuple(replace(winch, travel=0.012) for winch in robot.winches)
    short = Simulation(replace(robot, winches=winches), body=simulation.body)
    goals = np.array([0.0, 0.005, 0.02])[:, None] * np.eye(len(winches))[0]
    found = short.solve_batch(goals)
    poses = [short.solve(goal, strict=False) for goal in goals]
    if robot.body.mesh.dim == 2:
        assert found.warnings == tuple(pose.warnings for pose in poses)
    assert found.warnings == tuple(pose.find_warnings(crossings=robot.body.mesh.dim == 2) for pose in poses)
    assert found.warnings[0] == ()
    assert "is outside its range" in found.warnings[2][0]
    hasty = Simulation(short.robot, options=NewtonOptions(iterations=1), body=simulation.body).solve_batch(goals)
    for batch in (found, hasty):
        rows = list(csv.DictReader(batch.write_csv(tmp_path / "poses.csv").read_text(encoding="utf-8").splitlines()))
        assert [row["status"] for row in rows] == [str(status) for status in batch.statuses]
        told = [[*filter(None, [error]), *words] for error, words in zip(batch.errors, batch.warnings, strict=True)]
        assert [row["warnings"] for row in rows] == ["; ".join(words) for words in told]
    assert hasty.errors[2]


def test_an_error_in_one_pose_does_not_lose_the_others(simulation: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    goals, solve = goals_of(simulation, 5), simulation.solve

    def fragile(goal: np.ndarray, **options: Any) -> Equilibrium:
        if (goal == goals[1]).all():
            raise ZeroDivisionError("put in on purpose")
        return solve(goal, **options)

    monkeypatch.setattr(simulation, "solve", fragile)
    found = simulation.solve_batch(goals)
    assert found.converged.tolist() == [True, False, True, True, True]
    assert found.statuses[1] is None
    assert found.errors[1] == "ZeroDivisionError: put in on purpose"
    assert np.isnan(found.markers[1]).all()


def test_it_begins_from_a_pose(simulation: Simulation) -> None:
    """From the pose that is asked for there is nothing left to do."""
    goal = goals_of(simulation, 1)[0]
    pose = simulation.solve(goal)
    found = simulation.solve_batch([goal, goal], nodes=True, start=pose)
    assert found.nodes is not None
    assert np.abs(found.nodes - pose.nodes).max() <= 1e-9 * simulation.robot.body.mesh.size


def test_names_of_winches_will_do(simulation: Simulation) -> None:
    winch = simulation.robot.winches[0].name
    found = simulation.solve_batch([{winch: 0.004}, {}])
    assert found.contractions[0, 0] == 0.004
    assert not found.contractions[:, 1:].any()
    assert len(found) == 2


@pytest.mark.parametrize(("least", "several"), [(0.0, True), (1.0, False)])
def test_one_thread_solves_small_bodies(
    simulation: Simulation, monkeypatch: pytest.MonkeyPatch, least: float, several: bool
) -> None:
    """Two would mostly wait for Python's lock."""
    names, solve = set(), simulation.solve

    def told(goal: np.ndarray, **options: Any) -> Equilibrium:
        names.add(threading.current_thread().name)
        time.sleep(0.01)
        return solve(goal, **options)

    monkeypatch.setattr(simulation, "solve", told)
    monkeypatch.setattr(room, "LONG_ENOUGH", least)
    simulation.solve_batch(goals_of(simulation, 6), threads=2)
    assert len(names) == (2 if several else 1)


def test_no_pose_and_no_marker(simulation: Simulation) -> None:
    bare = Simulation(replace(simulation.robot, markers=()), body=simulation.body)
    winches = len(simulation.robot.winches)
    assert bare.solve_batch(np.zeros((0, winches))).markers.shape == (0, 0, simulation.robot.body.mesh.dim)
    assert bare.solve_batch(goals_of(bare, 2)).markers.shape == (2, 0, simulation.robot.body.mesh.dim)


@pytest.mark.parametrize("wrong", [0, -1, 1.5, True])
def test_threads_are_counted_from_one(simulation: Simulation, wrong: object) -> None:
    with pytest.raises(InputError, match="threads must be a whole number"):
        simulation.solve_batch(goals_of(simulation, 2), threads=wrong)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda goals: goals[:, :1], "1 contractions given for"),
        (lambda goals: np.where([[0], [0], [1], *[[0]] * 17], np.nan, goals), r"contractions\[2\]: .* finite number"),
    ],
)
def test_wrong_contractions_are_refused_at_once(simulation: Simulation, change: Callable, text: str) -> None:
    with pytest.raises(InputError, match=text):
        simulation.solve_batch(change(goals_of(simulation, 20)))


def test_a_wrong_limit_is_refused_at_once(simulation: Simulation) -> None:
    with pytest.raises(InputError, match="seconds must be above 0"):
        simulation.solve_batch(goals_of(simulation, 2), seconds=0.0)


@pytest.mark.parametrize("threads", [1, 2])
def test_an_interrupt_ends_it(simulation: Simulation, monkeypatch: pytest.MonkeyPatch, threads: int) -> None:
    """Of ten thousand poses that take a hundredth of a second each only the first few are solved."""
    solved, solve, numbers = [], simulation.solve, count()

    def slow(goal: np.ndarray, **options: Any) -> Equilibrium:
        solved.append(goal)
        time.sleep(0.01)
        if next(numbers) == 10:  # exactly one of the threads
            threading.Timer(0.0, _thread.interrupt_main).start()
        return solve(goal, **options)

    monkeypatch.setattr(simulation, "solve", slow)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background it comes ignored
    try:
        with pytest.raises(KeyboardInterrupt):
            simulation.solve_batch(np.zeros((10_000, len(simulation.robot.winches))), threads=threads)
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(solved) < 1000


def test_what_is_no_row_of_contractions_is_told(simulation: Simulation, unchecked: None) -> None:
    for given, words in ((None, "a row for each pose, not None"), ([{simulation.robot.winches[0].name: "a"}], "'a'")):
        with pytest.raises(InputError, match=words):
            simulation.solve_batch(given)  # pyright: ignore[reportArgumentType]
