"""One body and one simulation, shared by many threads and processes. Oracle: one solve after another, to the byte."""

import multiprocessing
import pickle
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from threading import Barrier

import numpy as np
import pytest
from builders import gallery_robot, strip_robot

from hydrostat.ik import TrajectoryOptions, solve_ik_trajectory
from hydrostat.simulation import Equilibrium, Simulation

pytestmark = pytest.mark.usefixtures("unchecked")

WORKERS = 8
"""So many work at once."""

ROUNDS = 6
"""So many solves each thread makes."""

Task = tuple[Simulation, np.ndarray, Equilibrium | None]


@pytest.fixture(scope="module", params=["strip", "starfish"])
def simulation(request: pytest.FixtureRequest) -> Simulation:
    return Simulation(strip_robot(columns=10, rows=2) if request.param == "strip" else gallery_robot("starfish"))


@pytest.fixture(scope="module")
def processes() -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


def tasks(simulation: Simulation) -> list[Task]:
    """Different contractions for each worker, every other from a pose; every fourth on a simulation of its own."""
    travels = np.array([winch.travel for winch in simulation.robot.winches])
    own = Simulation(simulation.robot, body=simulation.body)
    start = simulation.solve(0.1 * travels)
    shares = np.random.default_rng(7).uniform(0.05, 0.3, (WORKERS, len(travels)))
    return [
        (own if number % 4 == 3 else simulation, share * travels, start if number % 2 else None)
        for number, share in enumerate(shares)
    ]


def solved(task: Task) -> bytes:
    """Nodes and slopes of one solve."""
    simulation, contractions, start = task
    pose = simulation.solve(contractions, start=start)
    return pose.nodes.tobytes() + simulation.jacobian(pose).tobytes()


def test_threads_find_the_same_bytes(simulation: Simulation) -> None:
    """All begin together, and each solves several times."""
    wanted = tasks(simulation)
    alone = [solved(task) for task in wanted]
    assert len(set(alone)) == WORKERS
    barrier = Barrier(WORKERS)

    def work(task: Task) -> list[bytes]:
        barrier.wait()
        return [solved(task) for _ in range(ROUNDS)]

    with ThreadPoolExecutor(WORKERS) as pool:
        found = list(pool.map(work, wanted))
    for ours, right in zip(found, alone, strict=True):
        assert all(one == right for one in ours)


def test_threads_that_are_first_on_new_physics_find_the_same_bytes(simulation: Simulation) -> None:
    """What is made when it is first asked for, such as factors at rest, may be asked for by all threads at once."""
    pulled = [contractions for _, contractions, _ in tasks(simulation)]
    alone = [solved((simulation, contractions, None)) for contractions in pulled]
    new, barrier = Simulation(simulation.robot), Barrier(WORKERS)

    def work(contractions: np.ndarray) -> bytes:
        barrier.wait()
        return solved((new, contractions, None))

    with ThreadPoolExecutor(WORKERS) as pool:
        found = list(pool.map(work, pulled))
    assert [one == right for one, right in zip(found, alone, strict=True)] == [True] * WORKERS


@pytest.mark.slow
def test_processes_find_the_same_bytes(simulation: Simulation, processes: ProcessPoolExecutor) -> None:
    """What is sent to other processes, factors included, solves the same there."""
    wanted = tasks(simulation)
    found = list(processes.map(solved, wanted))
    alone = [solved(task) for task in wanted]
    assert [one == right for one, right in zip(found, alone, strict=True)] == [True] * WORKERS


def test_factors_sent_through_pickle_solve_the_same(simulation: Simulation) -> None:
    pose = simulation.solve(tasks(simulation)[0][1])
    sent, there = pickle.loads(pickle.dumps((simulation, pose)))
    known = sent.stiffness_of(there)
    assert known is not None
    right = np.random.default_rng(1).normal(size=(pose.nodes.size, 3))
    assert known.solve(right).tobytes() == simulation.stiffness(pose).solve(right).tobytes()
    assert known.solve(right[:, 0]).tobytes() == simulation.stiffness(pose).solve(right[:, 0]).tobytes()
    assert sent.jacobian(there).tobytes() == simulation.jacobian(pose).tobytes()


def test_a_pose_without_factors_is_small_and_still_a_start(simulation: Simulation) -> None:
    """Its nodes, twice, its robot, and little more; slopes are the same, from factors made again."""
    pulled = tasks(simulation)[0][1]
    pose = simulation.solve(pulled)
    light = pose.without_factors()
    assert light.result.stiffness is None
    assert pose.result.stiffness is not None
    assert len(pickle.dumps(light)) < len(pickle.dumps(pose.robot)) + 2 * pose.nodes.nbytes + 4000
    slopes = simulation.jacobian(pose)
    np.testing.assert_allclose(simulation.jacobian(light), slopes, rtol=0, atol=1e-8 * np.abs(slopes).max())
    again = simulation.solve(1.1 * pulled, start=light).nodes
    np.testing.assert_allclose(again, simulation.solve(1.1 * pulled, start=pose).nodes, rtol=0, atol=1e-7)


def test_a_trajectory_holds_no_factors(simulation: Simulation) -> None:
    robot = simulation.robot
    place = simulation.solve(tasks(simulation)[0][1]).markers
    targets = {marker.name: tuple(place[marker.name].tolist()) for marker in robot.markers}
    found = solve_ik_trajectory(simulation, [targets], options=TrajectoryOptions(rate=4))
    poses = [
        *found.poses,
        *(key.pose for key in found.keyframes),
        *(key.found.pose for key in found.keyframes if key.found),
    ]
    assert len(poses) > len(found.keyframes)
    assert all(pose.result.stiffness is None for pose in poses)
