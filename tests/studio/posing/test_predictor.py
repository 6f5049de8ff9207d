"""Drags that networks answer first. Oracles: the model itself, the targets, `Simulation.solve`, a poser without one."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from model_cards import model_card

from hydrostat.errors import InputError
from hydrostat.given import Point
from hydrostat.learning import LearnedModel, Perceptrons
from hydrostat.robot import Robot, load_robot, save_robot
from hydrostat.simulation import Simulation
from hydrostat.studio.document import Document
from hydrostat.studio.face.panels.pose_panel import prediction_words
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.poser import Poser
from hydrostat.studio.session import Session, Tone
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.robot_items import prediction_items

pytestmark = pytest.mark.usefixtures("unchecked")

HIDDEN = 0.3  # share of its travel by which each winch takes in


class Knowing:
    """A model of one robot that has one answer."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.contractions = np.array([HIDDEN * winch.travel for winch in robot.winches])
        self.markers = Simulation(robot).solve(self.contractions).markers
        self.asked: list[Mapping[str, Point]] = []

    def check(self, robot: Robot) -> None:
        if robot.winches != self.robot.winches:
            raise InputError("the model was learned of another robot")

    def solve(self, targets: Mapping[str, Point]) -> SimpleNamespace:
        self.asked.append(targets)
        wide = dict.fromkeys(targets, 1e-3)
        return SimpleNamespace(contractions=self.contractions, errors=wide, spread=wide, markers=self.markers)


@pytest.fixture(scope="module")
def model(starfish: Robot) -> Knowing:
    return Knowing(starfish)


@pytest.fixture
def poser(document: Document, model: Knowing) -> Iterator[Poser]:
    document.model = model  # type: ignore[assignment]
    jobs = Jobs(document.bell)
    yield Poser(document, jobs)
    jobs.close()


def hold_all(poser: Poser, robot: Robot, model: Knowing) -> None:
    """Drag each marker where the model brings it."""
    for marker in robot.markers:
        poser.grab(Hit(key=f"marker:{marker.name}", rest=marker.at, world=marker.at))
        poser.drag(Hit(world=tuple(model.markers[marker.name].tolist())))
        poser.release()


def test_networks_answer_first_and_the_exact_pose_follows(poser: Poser, starfish: Robot, model: Knowing) -> None:
    poser.step(0.0)  # gets ready
    hold_all(poser, starfish, model)
    poser.step(0.0)
    first = poser.shape()
    assert first.prediction is not None
    assert not first.prediction.exact
    assert first.prediction.error == first.prediction.uncertainty == 1e-3
    assert not first.contractions.any()  # what is shown of winches, and sent to motors, is of a pose
    dots = {dot.at for dot in prediction_items(first)}
    assert dots == {tuple(model.markers[marker.name].tolist()) for marker in starfish.markers}
    assert prediction_words(first).startswith("Dots by surrogate model: predicted error 1.0 mm ± 1.0 mm.")
    poser.step(0.1)
    second = poser.shape()
    assert max(second.errors.values()) < 0.05 * max(first.errors.values())  # one update, as far as the networks lead
    count = 0
    while poser.step(0.2):
        count += 1
        assert count < 500
    last = poser.shape()
    assert last.prediction is not None
    assert last.prediction.exact
    assert prediction_items(last) == []
    assert prediction_words(last).startswith("Exact: ")
    again = Simulation(starfish).solve(last.contractions)
    assert np.abs(again.nodes - last.nodes).max() < 1e-4 * starfish.body.mesh.size


def test_markers_that_nobody_holds_shall_stay(poser: Poser, starfish: Robot, model: Knowing) -> None:
    poser.step(0.0)
    model.asked.clear()
    marker = starfish.markers[0]
    target = tuple(model.markers[marker.name].tolist())
    poser.grab(Hit(key=f"marker:{marker.name}", rest=marker.at, world=marker.at))
    poser.drag(Hit(world=target))
    poser.step(0.0)
    assert set(model.asked[0]) == {own.name for own in starfish.markers}
    assert model.asked[0][marker.name] == pytest.approx(target)
    other = starfish.markers[1]
    assert model.asked[0][other.name] == pytest.approx(other.at, abs=1e-6)


def test_networks_are_not_asked_for_plain_points(poser: Poser, starfish: Robot, model: Knowing) -> None:
    poser.step(0.0)
    model.asked.clear()
    at = tuple(starfish.body.mesh.nodes[0].tolist())
    poser.grab(Hit(key="", rest=at, world=at))
    poser.drag(Hit(world=tuple((np.array(at) + 0.005).tolist())))
    poser.step(0.0)
    assert poser.held_points
    assert model.asked == []
    assert poser.shape().prediction is None


def untrained(robot: Robot) -> LearnedModel:
    """A model of a robot that has learned nothing."""
    winches, markers, cables = len(robot.winches), len(robot.markers) * robot.body.mesh.dim, len(robot.cables)

    def networks(*sizes: int) -> Perceptrons:
        return Perceptrons(sizes=np.array(sizes), numbers=np.zeros((2, Perceptrons.count(np.array(sizes)))))

    return LearnedModel(
        card=model_card(robot),
        low=np.zeros(winches),
        high=np.array([winch.travel for winch in robot.winches]),
        middle=np.zeros(markers + cables),
        unit=np.ones(markers + cables),
        forward=networks(winches, 5, markers + cables),
        inverse=networks(markers, 5, winches),
        known=np.zeros((3, winches)),
        reached=np.zeros((3, markers)),
    )


def test_a_model_beside_the_robot_is_found_and_another_robots_refused(starfish: Robot, tmp_path: Path) -> None:
    folder = tmp_path / "star"
    save_robot(starfish, folder)
    file = untrained(load_robot(folder)).save(folder / "star.model")
    session = Session()
    session.open_folder(folder)
    assert session.document.model is not None
    assert "surrogate model star.model predicts drags first" in [note.text for note in session.notes]
    other = tmp_path / "other"
    save_robot(replace(starfish, markers=starfish.markers[:1], poses={}), other)
    with pytest.raises(InputError, match="learned of another robot"):
        session.open_folder(other, file)
    (other / "hand.model").write_bytes(file.read_bytes())
    session.open_folder(other)
    assert session.document.model is None
    told = [note for note in session.notes if note.tone is Tone.BAD]
    assert len(told) == 1
    assert "hand.model: the model was learned of another robot" in told[0].text
    session.close()
