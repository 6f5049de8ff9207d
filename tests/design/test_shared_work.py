"""Work that two processes share. Oracles: the built-in `map`; the network that one process finds."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace

import pytest
from builders import strip_robot

from hydrostat.design import DesignRequest, Network, RouteOptions, find_network
from hydrostat.design.network import RouteTrace
from hydrostat.design.routes import design_routes as search
from hydrostat.design.routes.shared_work import can_share, map_in_order
from hydrostat.robot import PoseTarget

POSES = (PoseTarget(name="up", targets={"tip": (0.18, 0.06)}),)
QUICK = RouteOptions(starts=1, exchanges=1, refine_steps=2, trials=2, steps=2, max_edges=6)


@pytest.fixture(autouse=True)
def alone(request: pytest.FixtureRequest) -> None:
    """Skip a test in a process with threads, as no copy of it is made; the last test runs all in another one."""
    if not can_share() and request.node.name != "test_all_of_these_in_a_process_without_threads":
        pytest.skip("no copy of this process can be made")


def process_of(_: object) -> int:
    return os.getpid()


def test_results_come_in_order() -> None:
    items = [3.0, 1.0, 2.0, 5.0, 4.0]
    assert list(map_in_order(lambda item: item**0.5, items, cores=2)) == [item**0.5 for item in items]


def test_every_other_item_is_computed_by_another_process() -> None:
    here = [process == os.getpid() for process in map_in_order(process_of, range(4), cores=2)]
    assert here == [True, False, True, False]
    assert set(map_in_order(process_of, range(4), cores=1)) == {os.getpid()}


def test_known_objects_stay_the_same() -> None:
    known, other = ["large"], ["small"]
    results = list(map_in_order(lambda _: (known, other), range(2), cores=2, known=[known]))
    assert all(one is known for one, _ in results)
    assert results[1][1] is not other
    assert results[1][1] == other


def test_an_error_is_raised_in_its_turn() -> None:
    results = map_in_order(lambda item: 1 / item, [1.0, 0.0, 2.0], cores=2)
    assert next(results) == 1.0
    with pytest.raises(ZeroDivisionError):
        next(results)


def test_an_error_with_arguments_of_its_own_is_raised_as_it_is() -> None:
    """Such an error cannot be made again from its text alone."""

    class OddError(Exception):
        def __init__(self, text: str, number: int) -> None:
            super().__init__(text)

    def fail(item: int) -> int:
        if item:
            raise OddError("odd", item)
        return item

    with pytest.raises(OddError, match="odd"):
        list(map_in_order(fail, range(2), cores=2))


def test_work_of_a_process_that_was_killed_is_done_here() -> None:
    own = os.getpid()

    def fall(item: int) -> int:
        if os.getpid() != own:
            os.kill(os.getpid(), signal.SIGKILL)
        return item

    assert list(map_in_order(fall, range(5), cores=2)) == list(range(5))


def test_an_iterator_that_is_closed_leaves_no_process() -> None:
    with closing(map_in_order(process_of, range(4), cores=2)) as results:
        assert isinstance(results, Iterator)
        _, child = next(results), next(results)
    with pytest.raises(ProcessLookupError):
        os.kill(child, 0)


def stages(network: Network) -> list[tuple[str, float, int]]:
    assert isinstance(network.trace, RouteTrace)
    return [(stage.words, stage.error, stage.num_evaluated) for stage in network.trace.stages]


def design(cores: int, monkeypatch: pytest.MonkeyPatch) -> Network:
    monkeypatch.setattr(search, "THREADS", cores)
    robot = strip_robot(columns=10, rows=3).with_network((), ())
    robot = replace(robot, body=replace(robot.body, thickness=0.045))  # units fit above each other: nothing is moved
    return find_network(robot, DesignRequest(poses=POSES, winches=2, cables=2, options=QUICK))


def test_two_cores_find_the_network_of_one(monkeypatch: pytest.MonkeyPatch, unchecked: None) -> None:
    """To the last bit, with the same networks on the way after as many trials."""
    one, two = (design(cores, monkeypatch) for cores in (1, 2))
    assert (two.robot.winches, two.robot.cables, two.expected_error, two.num_evaluated) == (
        one.robot.winches, one.robot.cables, one.expected_error, one.num_evaluated,
    )  # fmt: skip
    assert stages(two) == stages(one)
    assert [pose.errors for pose in two.ik_results] == [pose.errors for pose in one.ik_results]


@pytest.mark.slow
def test_all_of_these_in_a_process_without_threads() -> None:
    """Workers of pytest-xdist have threads, so all that is above is skipped there."""
    if can_share():
        pytest.skip("they ran in this process")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider", __file__],
        capture_output=True,
        text=True,
        env={name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")},
    )
    assert done.returncode == 0, done.stdout
    assert " 1 skipped" in done.stdout.splitlines()[-1]
