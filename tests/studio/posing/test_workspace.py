"""What a marker can reach. Oracles: `Simulation.solve` at the same contractions, a list that keeps what is told."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from threading import Event
from typing import Any

import numpy as np
import pytest
from builders import strip_robot

from hydrostat.errors import InputError
from hydrostat.project import Wishes, Work
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.bell import Bell
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs, Report
from hydrostat.studio.posing.reach import MarkerReach, spread_contractions, sweep

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
    drawn = np.array(spread_contractions(ROBOT, 64))
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
    for contractions in spread_contractions(ROBOT, 24):
        pose = simulation.solve(contractions, strict=False)
        if pose.result.converged and pose.tensions.max() <= limit:
            expected.append(pose.markers[name])
    assert len(expected) == held
    assert places == pytest.approx(np.array(expected), abs=1e-6)


@pytest.mark.slow
def test_the_cloud_grows_in_another_process() -> None:
    document = Document(Bell())
    document.open(Work(robot=ROBOT))
    jobs = Jobs(document.bell)
    ended = Event()
    reach = MarkerReach(document, jobs)
    document.bell.listen(lambda _: ended.set() if reach.marker and not reach.running else None)
    try:
        reach.start(ROBOT.markers[0].name, 16)
        with pytest.raises(InputError, match="still running"):
            reach.start(ROBOT.markers[0].name, 16)
        assert ended.wait(20)
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
    reach = MarkerReach(document, Jobs(document.bell))
    with pytest.raises(InputError, match="unknown marker"):
        reach.start("nobody")
    with pytest.raises(InputError, match="no cables"):
        reach.start(ROBOT.markers[0].name)


class Begun(Jobs):
    """Work that tells all, and ends, before `start` returns."""

    def start(self, title: str, function: Any, *arguments: Any, **calls: Any) -> None:
        """Nothing runs."""
        calls["on_part"](np.array([[0.01, 0.02]]))
        calls["on_end"]("")


def test_a_reach_that_ends_at_once_has_ended_and_keeps_its_places() -> None:
    document = Document(Bell())
    document.open(Work(robot=ROBOT))
    reach = MarkerReach(document, Begun(document.bell))
    reach.start(ROBOT.markers[0].name)
    assert not reach.running
    cloud = reach.cloud(ROBOT)
    assert cloud is not None
    assert len(cloud.points) == reach.count == 1


def moved_marker(robot: Robot) -> Robot:
    first, *others = robot.markers
    return replace(robot, markers=(replace(first, at=(first.at[0] - 0.002, *first.at[1:])), *others))


CHANGES: dict[str, Callable[[Robot], Robot]] = {
    "cables": lambda robot: replace(robot, cables=robot.cables[:-1]),
    "travel": lambda robot: replace(
        robot, winches=tuple(replace(own, travel=0.9 * own.travel) for own in robot.winches)
    ),
    "pins": lambda robot: replace(robot, pins=(*robot.pins, *robot.pins)),
    "marker": moved_marker,
    "no marker": lambda robot: replace(robot, markers=robot.markers[1:], poses={}),
}


@pytest.mark.parametrize("what", list(CHANGES))
def test_places_of_other_physics_are_forgotten(what: str) -> None:
    document = Document(Bell())
    document.open(Work(robot=ROBOT))
    reach = MarkerReach(document, Begun(document.bell))
    reach.start(ROBOT.markers[0].name)
    document.change("poses", robot=replace(ROBOT, poses={}))
    assert reach.cloud(document.robot) is not None, "poses move nothing"
    document.change(what, robot=CHANGES[what](document.robot))
    assert reach.cloud(document.robot) is None
    assert not reach.marker


def test_places_within_another_limit_are_forgotten() -> None:
    document = Document(Bell())
    document.open(Work(robot=ROBOT))
    reach = MarkerReach(document, Begun(document.bell))
    reach.start(ROBOT.markers[0].name)
    document.change("limit", wishes=Wishes.of(tension=3.0))
    assert reach.cloud(document.robot) is None
    assert reach.count == 0
