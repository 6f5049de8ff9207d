"""Searches that are stopped and resumed. Oracle: the same search without a stop."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from builders import strip_robot

from hydrostat.design import DesignRequest, DesignStage, Network, RouteOptions, SearchRecord, find_network
from hydrostat.design.routes.evaluator import Evaluator
from hydrostat.errors import InputError
from hydrostat.robot import PoseTarget, robot_hash

ROBOT = strip_robot(columns=10, rows=3).with_network((), ())
POSES = (PoseTarget(name="up", targets={"tip": (0.18, 0.06)}),)
QUICK = RouteOptions(starts=1, exchanges=1, refine_steps=2, trials=2, steps=2, max_edges=6)
REQUEST = DesignRequest(poses=POSES, winches=2, cables=2, options=QUICK)


def search(record: SearchRecord, stop: int | None = None) -> Network:
    """Search; stopped after a number of steps."""

    def watch(_: DesignStage) -> None:
        if stop is not None and len(record.steps) >= stop:
            raise KeyboardInterrupt

    return find_network(ROBOT, REQUEST, watch=watch, record=record)


@pytest.mark.slow
def test_a_resumed_search_finds_the_same_network(
    tmp_path: Path, unchecked: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = SearchRecord()
    unbroken = search(whole)
    file = tmp_path / "search.json"
    stopped = SearchRecord()
    first = search(stopped, stop=len(whole.steps) // 2)
    assert not first.complete
    assert 0 < len(stopped.steps) < len(whole.steps)
    stopped.write(file, ROBOT, REQUEST)

    resumed = SearchRecord.read(file, ROBOT, replace(REQUEST, seconds=100.0))
    solved = []
    reach = Evaluator.reach_poses
    monkeypatch.setattr(Evaluator, "reach_poses", lambda *given, **named: solved.append(0) or reach(*given, **named))
    network = search(resumed)
    assert network.complete
    assert robot_hash(network.robot) == robot_hash(unbroken.robot)
    assert (network.expected_error, network.rms_error, network.num_evaluated) == (
        unbroken.expected_error,
        unbroken.rms_error,
        unbroken.num_evaluated,
    )
    assert [step["step"] for step in resumed.steps] == [step["step"] for step in whole.steps]
    known = sum(step["tried"] for step in stopped.steps)
    assert len(solved) < network.num_evaluated - 0.5 * known  # what is known is not computed again


def test_the_record_of_another_search_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "search.json"
    SearchRecord().write(file, ROBOT, REQUEST)
    assert not SearchRecord.read(file, ROBOT, REQUEST).known
    with pytest.raises(InputError, match=r"another search \(cables differs\)"):
        SearchRecord.read(file, ROBOT, replace(REQUEST, cables=4))
    with pytest.raises(InputError, match=r"another search \(robot differs\)"):
        SearchRecord.read(file, strip_robot(columns=8, rows=3), REQUEST)
    for old in ('"workspace_weight"', '"warm_start"', '"version"'):  # keys that had other names once
        earlier = tmp_path / "earlier.json"
        earlier.write_text(file.read_text().replace(old, '"other_name"'))
        with pytest.raises(InputError, match="written by another version of hydrostat"):
            SearchRecord.read(earlier, ROBOT, REQUEST)
    with pytest.raises(InputError, match="no such file"):
        SearchRecord.read(tmp_path / "none.json", ROBOT, REQUEST)
    record = SearchRecord([{"step": "sketch", "tried": 1, "networks": None}])
    with pytest.raises(InputError, match='step 1 is "sketch", not "refined"'):
        record.take("refined")


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{",
        "[]",
        '{"steps": 3}',
        '{"steps": [{"step": 1}]}',
        '{"steps": [3]}',
        '{"steps": [{"step": "a", "tried": 1}]}',
    ],
)
def test_a_file_that_is_no_record_is_refused(content: str, tmp_path: Path) -> None:
    file = tmp_path / "search.json"
    file.write_text(content)
    with pytest.raises(InputError, match="not the record of a search"):
        SearchRecord.read(file, ROBOT, REQUEST)


def test_a_network_that_cannot_be_read_is_one_line(tmp_path: Path, unchecked: None) -> None:
    file = tmp_path / "search.json"
    broken = {"step": "sketch", "tried": 1, "networks": [{"layout": {"winches": [{}]}}]}
    SearchRecord().write(file, ROBOT, REQUEST)
    file.write_text(json.dumps(json.loads(file.read_text()) | {"steps": [broken]}))
    record = SearchRecord.read(file, ROBOT, REQUEST)
    with pytest.raises(InputError, match="a network cannot be read"):
        search(record)


def test_a_search_that_is_stopped_while_it_resumes_forgets_nothing(tmp_path: Path) -> None:
    known = [{"step": str(number), "tried": 1, "networks": None} for number in range(5)]
    record = SearchRecord(known)
    record.add(known[0])
    record.write(tmp_path / "search.json", ROBOT, REQUEST)
    assert SearchRecord.read(tmp_path / "search.json", ROBOT, REQUEST).known == tuple(known)
