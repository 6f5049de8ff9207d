"""Cables proposed while one drags (X1). Oracles: the checks of designs, a fresh simulation, what was asked."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from hydrostat.design import Constraints, TreeOptions, body_region, violations
from hydrostat.errors import InputError
from hydrostat.ik import solve_ik
from hydrostat.project import Wishes
from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics, Simulation
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.cable_proposals import (
    OPTIONS,
    POSE,
    Proposal,
    ProposalInput,
    asked_of_trees,
    propose_network,
)
from hydrostat.studio.posing.movers import MuscleMover
from hydrostat.studio.posing.pose_state import HeldPoint, Mode, held_of, with_pose
from hydrostat.studio.posing.poser import Poser
from hydrostat.studio.view.things import Dot

PATIENCE = 120.0  # the process has to start [s]


@pytest.fixture
def poser(document: Document) -> Iterator[Poser]:
    jobs = Jobs(document.bell)
    made = Poser(document, jobs)
    yield made
    made.proposals.close()
    jobs.close()


def posed(robot: Robot, held: dict[str, HeldPoint], wishes: Wishes) -> ProposalInput:
    """As muscles hold some points."""
    mover = MuscleMover(robot)
    for _ in range(120):
        if not mover.update(held)[1]:
            break
    nodes, tensions = mover.pulls
    return ProposalInput(held=held, nodes=nodes, tensions=tensions, wishes=wishes)


def until(ready: Callable[[], object], poser: Poser) -> None:
    began = time.monotonic()
    while not ready():
        assert time.monotonic() - began < PATIENCE, "it never came"
        poser.step(time.monotonic())
        time.sleep(0.01)


@pytest.mark.slow
def test_a_network_of_a_moment_can_be_built_and_reaches_what_it_says(starfish: Robot, unchecked: None) -> None:
    """Also where a point is held that is no marker."""
    held = held_of(starfish, "wave")
    node = starfish.body.mesh.nodes[np.argmax(starfish.body.mesh.nodes[:, 0])]
    held["point_1"] = HeldPoint(at=tuple(node), target=tuple(node))
    wishes = Wishes.of(winches=2, cables=4, tension=15.0, clearance=0.006)
    found = propose_network(starfish, posed(starfish, held, wishes), BodyPhysics(starfish))
    assert found.words == ""
    assert len(found.winches) == 2
    assert 2 <= len(found.cables) <= 4
    robot = starfish.with_network(found.winches, found.cables)
    limits = Constraints(tension=15.0, clearance=0.006, cable_gap=0.0, turn=TreeOptions.turn)
    assert violations(robot, limits, body_region(robot.body, 0.006)) == []
    named = with_pose(robot, POSE, held)
    reached = solve_ik(Simulation(named), named.pose(POSE), options=OPTIONS)
    assert found.error == pytest.approx(reached.rms_error, rel=1e-6)
    rest = [np.subtract(point.at, point.target) for point in held.values()]
    assert found.error < np.sqrt(np.mean(np.sum(np.square(rest), axis=1)))


def test_what_is_asked_follows_the_wishes(starfish: Robot) -> None:
    robot = replace(starfish, poses={POSE: replace(starfish.pose("wave"), name=POSE)})
    asked = asked_of_trees(robot, Wishes.of(winches=0, cables=3, phi=0.2, threshold=33, mirror="x"))
    assert (asked.winches, asked.cables, asked.method) == (2, 3, "trees")
    assert asked.tree_options.phis == (0.2,)
    assert asked.tree_options.thresholds == (33,)
    assert asked_of_trees(robot, Wishes(winches=0, cables=1)).winches == 1


@pytest.mark.slow
def test_cables_are_proposed_while_muscles_follow_and_can_be_kept(
    starfish: Robot, document: Document, poser: Poser
) -> None:
    poser.set_mode(Mode.MUSCLES)
    with pytest.raises(InputError, match="no network proposed yet"):
        poser.proposals.keep()
    poser.proposals.switch(True)
    poser.show_pose("wave")
    until(lambda: poser.proposals.network(document.robot), poser)
    found = poser.proposals.network(document.robot)
    assert found is not None
    keys = {thing.key for thing in poser.things() if isinstance(thing, Dot)}
    assert {f"winch:{winch.name}" for winch in found.winches} <= keys
    poser.proposals.keep()
    assert document.robot.cables == found.cables
    assert document.undo()
    assert document.robot.cables == starfish.cables
    poser.rest()
    poser.step(0.0)
    assert poser.proposals.network(document.robot) is None
    poser.proposals.switch(False)
    assert poser.proposals.latest_proposal(document.robot) is None


@pytest.mark.slow
def test_the_latest_wins(starfish: Robot, document: Document, poser: Poser, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a hundred moments in a row few are answered, and the last one is: its network is what comes of it alone."""
    taken: list[Proposal] = []
    proposals, held = poser.proposals, held_of(starfish, "wave")
    take = proposals._take
    monkeypatch.setattr(proposals, "_take", lambda *found: (taken.append(found[2]), take(*found)))
    last = posed(starfish, held, Wishes(cables=2))
    early = replace(last, wishes=Wishes(cables=5))
    proposals.switch(True)
    for _ in range(99):
        proposals.ask(starfish, early)
    proposals.ask(starfish, last)
    wanted = propose_network(starfish, last, BodyPhysics(starfish))
    until(lambda: taken and taken[-1] == wanted, poser)
    assert len(taken) <= 2


@pytest.mark.slow
def test_a_process_that_dies_is_told(starfish: Robot, document: Document, poser: Poser) -> None:
    held = held_of(starfish, "wave")
    poser.proposals.switch(True)
    moment = ProposalInput(held=held, nodes=np.zeros((1, 2)), tensions=np.zeros(1), wishes=Wishes())
    poser.proposals.ask(starfish, moment)  # of another body
    until(lambda: poser.proposals.latest_proposal(starfish), poser)
    found = poser.proposals.latest_proposal(starfish)
    assert found is not None
    assert "crashed" in found.words
    assert poser.proposals.network(starfish) is None
