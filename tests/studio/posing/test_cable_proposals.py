"""Cables proposed while one drags (X1). Oracles: the checks of designs, a fresh simulation, what was asked."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from hydrostat.design import (
    BuildTolerances,
    Constraints,
    DesignMethod,
    QuickSearch,
    Region,
    TreeOptions,
    assign_cable_sides,
    expected_error,
    rms_error,
    violations,
)
from hydrostat.errors import InputError
from hydrostat.ik import solve_ik
from hydrostat.project import Wishes
from hydrostat.robot import Robot, limit_travels
from hydrostat.simulation import Simulation
from hydrostat.studio.designing.run import error_at_rest
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.posing.movers import MuscleMover
from hydrostat.studio.posing.pose_state import HeldPoint, Mode, held_of, with_pose
from hydrostat.studio.posing.poser import Poser
from hydrostat.studio.posing.proposal_work import (
    OPTIONS,
    POSE,
    MusclePulls,
    Proposal,
    ProposalInput,
    Proposer,
    propose_network,
    request_routes,
    request_trees,
)
from hydrostat.studio.view.scene_items import Dot, Look

TIMEOUT = 120.0  # the process has to start [s]


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
    muscles = MusclePulls(nodes=nodes, tensions=tensions)
    return ProposalInput(held=held, wishes=wishes, markers=robot.markers, muscles=muscles)


def by_routes(robot: Robot, wishes: Wishes, name: str = "wave") -> ProposalInput:
    """A stored pose as it is held."""
    return ProposalInput(held=held_of(robot, name), wishes=wishes, markers=robot.markers)


def until(ready: Callable[[], object], poser: Poser | None = None) -> None:
    began = time.monotonic()
    while not ready():
        assert time.monotonic() - began < TIMEOUT, "it never came"
        if poser is not None:
            poser.step(time.monotonic())
        time.sleep(0.01)


@pytest.mark.slow
def test_routes_of_a_moment_keep_all_limits_and_have_the_error_that_is_told(starfish: Robot, unchecked: None) -> None:
    """Also where a point is held that is no marker. Oracles: the checks of designs, a fresh inverse kinematics."""
    held = held_of(starfish, "wave")
    node = starfish.body.mesh.nodes[np.argmax(starfish.body.mesh.nodes[:, 0])]
    held["point_1"] = HeldPoint(at=tuple(node), target=tuple(node))
    wishes = Wishes.of(winches=2, cables=4, tension=15.0)
    moment = ProposalInput(held=held, wishes=wishes, markers=starfish.markers)
    proposals = list(Proposer(starfish).propose(moment))
    assert [one.is_last for one in proposals] == [False, True]
    named = with_pose(starfish, POSE, held)
    request = request_routes(replace(named, poses={POSE: named.pose(POSE)}), wishes)
    for one in proposals:
        robot = assign_cable_sides(named).with_network(one.winches, one.cables)
        assert 1 <= len(one.winches) <= 2
        assert len(one.winches) <= len(one.cables) <= 4
        assert violations(robot, request.constraints, Region.of_body(robot.body, request.constraints.clearance)) == []
        assert limit_travels(robot).winches == one.winches
    simulation = Simulation(robot)
    limits = QuickSearch(named, request).constraints.limits  # with the torque of the motors that fit
    reached = solve_ik(simulation, robot.pose(POSE), limits=limits)
    assert proposals[-1].expected_error == pytest.approx(
        expected_error(simulation, [reached], request.uncertainty), rel=0.02
    )
    assert proposals[-1].expected_error < error_at_rest(named, (named.pose(POSE),))


@pytest.mark.slow
def test_the_same_moment_has_the_same_networks(starfish: Robot) -> None:
    """Whatever was asked before: other poses and markers leave nothing behind but what is drawn already."""
    moment = by_routes(starfish, Wishes(winches=1, cables=2))
    used = Proposer(starfish)
    for other in (by_routes(starfish, moment.wishes, "star_jump"), by_routes(starfish, Wishes(winches=2, cables=4))):
        next(used.propose(other))
    assert list(used.propose(moment)) == list(Proposer(starfish).propose(moment))


@pytest.mark.slow
def test_stored_poses_are_reached_too(starfish: Robot) -> None:
    """A network for both poses has a smaller error over both than one for the first alone; equal poses count once."""
    wishes = Wishes(winches=2, cables=4)
    alone = by_routes(starfish, wishes)
    both = propose_network(starfish, replace(alone, poses=tuple(starfish.poses.values())))
    first = propose_network(starfish, alone)
    assert (both.poses, first.poses) == (len(starfish.poses), 1)
    errors = []
    for one in (both, first):
        simulation = Simulation(starfish.with_network(one.winches, one.cables))
        errors.append(rms_error([solve_ik(simulation, pose) for pose in starfish.poses.values()]))
    assert errors[0] < errors[1]


@pytest.mark.slow
def test_winch_trees_are_proposed_where_no_route_is_sketched(starfish: Robot, unchecked: None) -> None:
    """A mirror has no sketches. The words say so; travels are within what the cables have."""
    held = held_of(starfish, "wave")
    found = propose_network(
        starfish, posed(starfish, held, Wishes.of(winches=2, cables=4, clearance=0.006, mirror="x"))
    )
    assert found.method is DesignMethod.TREES
    assert "no sketched route" in found.words
    robot = starfish.with_network(found.winches, found.cables)
    assert limit_travels(robot).winches == found.winches
    limits = Constraints(clearance=0.006, cable_gap=0.0, max_turn=TreeOptions.turn)
    assert violations(robot, limits, Region.of_body(robot.body, 0.006)) == []
    named = with_pose(robot, POSE, held)
    simulation = Simulation(named)
    reached = solve_ik(simulation, named.pose(POSE), options=OPTIONS)
    assert found.expected_error == pytest.approx(
        expected_error(simulation, [reached], BuildTolerances.of(robot.body)), rel=1e-6
    )
    nothing = propose_network(starfish, by_routes(starfish, Wishes.of(mirror="x")))
    assert nothing.cables == ()
    assert "no cables found" in nothing.words


def test_what_is_asked_follows_the_wishes(starfish: Robot) -> None:
    robot = replace(starfish, poses={POSE: replace(starfish.pose("wave"), name=POSE)})
    asked = request_trees(robot, Wishes.of(winches=0, cables=3, phi=0.2, threshold=33, mirror="x"))
    assert (asked.winches, asked.cables, asked.method) == (2, 3, "trees")
    assert asked.tree_options.phis == (0.2,)
    assert asked.tree_options.thresholds == (33,)
    assert request_trees(robot, Wishes(winches=0, cables=1)).winches == 1
    routes = request_routes(robot, Wishes.of(winches=0, cables=3, mirror="x", simplicity=4.0))
    assert (routes.winches, routes.cables, routes.method, routes.constraints.mirror) == (2, 3, "routes", "x")
    assert routes.route_options.simplicity == 4.0


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
    winches = [item for item in poser.scene_items() if isinstance(item, Dot) and item.look is Look.WINCH]
    assert {item.at for item in winches if item.faint} == {winch.at for winch in found.winches}
    assert all(item.faint for item in winches)
    until(lambda: not poser.proposals.searching, poser)
    found = poser.proposals.network(document.robot)
    assert found is not None
    assert "2 winches" in poser.proposals.keep()
    assert document.robot.cables == found.cables
    assert poser.proposals.is_kept(document.robot)
    assert not any(item.faint for item in poser.scene_items() if isinstance(item, Dot))
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
    wanted = propose_network(starfish, last)
    until(lambda: taken and taken[-1] == wanted)  # nothing is held in the stage, which asks only for that
    assert len(taken) <= 2


@pytest.mark.slow
def test_a_process_that_dies_is_told(starfish: Robot, document: Document, poser: Poser) -> None:
    held = held_of(starfish, "wave")
    poser.proposals.switch(True)
    muscles = MusclePulls(nodes=np.zeros((1, 2)), tensions=np.zeros(1))  # of another body
    poser.proposals.ask(starfish, ProposalInput(held=held, wishes=Wishes.of(mirror="x"), muscles=muscles))
    until(lambda: poser.proposals.latest_proposal(starfish))
    found = poser.proposals.latest_proposal(starfish)
    assert found is not None
    assert "crashed" in found.words
    assert poser.proposals.network(starfish) is None


@pytest.mark.slow
def test_switching_on_asks_for_the_pose_that_is_held(starfish: Robot, document: Document, poser: Poser) -> None:
    """After a drag has ended, and after it was switched off and on again."""
    poser.show_pose("wave")
    until(lambda: not poser.step(0.0), poser)
    for _ in range(2):
        poser.proposals.switch(True)
        until(lambda: poser.proposals.network(document.robot), poser)
        poser.proposals.switch(False)


def test_equal_moments_are_asked_once(
    starfish: Robot, document: Document, poser: Poser, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A body that rests costs no worker anything; muscles that settle are asked again where routes found nothing."""
    proposals = poser.proposals
    monkeypatch.setattr(proposals, "_follow", lambda run: None)
    proposals.switch(True)

    def ask(*, is_settled: bool, cables: int = 6) -> bool:
        proposals._newest = None
        muscles = MusclePulls(nodes=np.zeros((1, 2)), tensions=np.zeros(1))
        moment = replace(by_routes(starfish, Wishes(cables=cables)), muscles=muscles)
        proposals.ask(starfish, moment, is_settled=is_settled)
        return proposals._newest is not None

    assert ask(is_settled=False)
    assert not ask(is_settled=False)
    assert not ask(is_settled=True)  # the answer is awaited
    proposals.searching = False
    proposals._take(proposals._run, starfish, Proposal(words="no cables"))
    assert ask(is_settled=True)
    proposals.searching = False
    assert not ask(is_settled=True)
    assert ask(is_settled=True, cables=2)
    proposals.searching = False
    proposals._take(proposals._run, starfish, Proposal(winches=starfish.winches, cables=starfish.cables))
    assert not ask(is_settled=True, cables=2)


def test_a_thread_that_ends_leaves_the_question_to_the_next(starfish: Robot, poser: Poser) -> None:
    """Switched off and on in a row, the first thread may wake up only then."""
    proposals = poser.proposals
    proposals.on, proposals._run = True, 2
    proposals.ask(starfish, by_routes(starfish, Wishes()))
    assert proposals._next(1) is None
    assert proposals._next(2) is not None
    proposals.on = False
