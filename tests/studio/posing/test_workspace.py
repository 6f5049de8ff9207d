"""What a marker can reach. Oracles: `Simulation.solve` at the same contractions, a list that keeps what is told."""

from dataclasses import dataclass, field
from threading import Event
from typing import Any

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs, Report
from hydrostat.studio.posing.reach import Reach
from hydrostat.studio.posing.workspace import spread, sweep
from hydrostat.studio.records.work import Work

ROBOT = strip_robot(columns=8, rows=2)


@dataclass
class Told(Report):
    """Keeps what work tells."""

    parts: list[Any] = field(default_factory=list)
    done: list[int] = field(default_factory=list)

    def progress(self, stage: str, done: int, total: int) -> None:
        self.done.append(done)

    def part(self, value: Any) -> None:
        self.parts.append(value)

    def finish(self) -> None:
        """Nobody interrupts a test."""


def test_contractions_fill_what_the_winches_can_do() -> None:
    drawn = np.array(spread(ROBOT, 64))
    low = np.array([-winch.release for winch in ROBOT.winches])
    high = np.array([winch.travel for winch in ROBOT.winches])
    shares = (drawn - low) / (high - low)
    assert shares.min() >= 0
    assert shares.max() <= 1
    assert np.histogramdd(shares, bins=4, range=[(0, 1)] * len(low))[0].min() > 0, "every sixteenth of it is visited"
    steps = np.linalg.norm(np.diff(shares, axis=0), axis=1)
    rng = np.random.default_rng(0)
    mixed = np.linalg.norm(np.diff(rng.permutation(shares), axis=0), axis=1)
    assert steps.mean() < 0.5 * mixed.mean(), "each is near the one before"


def test_places_are_those_of_equilibria_within_the_limit() -> None:
    told, limit = Told(), 8.0
    name = ROBOT.markers[0].name
    held = sweep(told, ROBOT, name, limit, 24)
    places = np.concatenate(told.parts)
    assert len(places) == held > 4
    assert told.done == sorted(told.done)
    simulation = Simulation(ROBOT)
    expected = []
    for contractions in spread(ROBOT, 24):
        pose = simulation.solve(contractions, strict=False)
        if pose.result.converged and pose.tensions.max() <= limit:
            expected.append(pose.markers[name])
    assert len(expected) == held
    assert places == pytest.approx(np.array(expected), abs=1e-6)


def test_the_cloud_grows_in_another_process() -> None:
    document = Document(Bell())
    document.open(Work(robot=ROBOT))
    jobs = Jobs(document.bell)
    ended = Event()
    reach = Reach(document, jobs)
    document.bell.listen(lambda _: ended.set() if reach.marker and not reach.running else None)
    try:
        reach.start(ROBOT.markers[0].name, 16)
        with pytest.raises(InputError, match="still in progress"):
            reach.start(ROBOT.markers[0].name, 16)
        assert ended.wait(60)
        cloud = reach.cloud(ROBOT)
        assert cloud is not None
        assert 0 < len(cloud.points) == reach.count <= 16
        reach.clear()
        assert reach.cloud(ROBOT) is None
    finally:
        jobs.close()


def test_a_reach_needs_a_marker_and_cables() -> None:
    document = Document(Bell())
    document.open(Work(robot=ROBOT.with_network((), ())))
    reach = Reach(document, Jobs(document.bell))
    with pytest.raises(InputError, match="no marker"):
        reach.start("nobody")
    with pytest.raises(InputError, match="no cables"):
        reach.start(ROBOT.markers[0].name)
