"""`propose_work`: winch trees for the muscles that pull just now, again and again, in a process of its own (X1)."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from threading import Condition, Thread
from typing import Any

from hydrostat.arrays import Nodes, Vector
from hydrostat.design import (
    Activation,
    DesignMethod,
    DesignRequest,
    TreeOptions,
    edge_fibres,
    propose_trees,
)
from hydrostat.errors import HydrostatError, InputError
from hydrostat.ik import IKOptions, solve_ik
from hydrostat.project import Wishes, after_design
from hydrostat.robot import Cable, Robot, Winch
from hydrostat.simulation import BodyPhysics, Simulation
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Slots
from hydrostat.studio.posing.movers import same_physics
from hydrostat.studio.posing.pose_state import Anchored, HeldPoint, Mode, with_pose

POSE = "held"  # name of the pose that is held, in that process alone
STEPS = 12  # of inverse kinematics: enough to say what a network is worth
OPTIONS = IKOptions(iterations=STEPS, restarts=0, min_tension=False)


@dataclass(frozen=True, kw_only=True, eq=False)
class ProposalInput:
    """A body as muscles hold it."""

    held: Mapping[str, HeldPoint]  # points by name, with where they should be
    nodes: Nodes  # where the body is [m]
    tensions: Vector  # of the muscle on each edge of its mesh [N]
    wishes: Wishes  # for a design: counts, limits, knobs


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Result of one proposal input: a network, or why there is none."""

    winches: tuple[Winch, ...] = ()  # of the network
    cables: tuple[Cable, ...] = ()  # of the network
    error: float | None = None  # rms error of the held points that it reaches [m]; None: not known
    words: str = ""  # why there is no network; "" if there is one


def asked_of_trees(robot: Robot, wishes: Wishes) -> DesignRequest:
    """Build the request to the thesis's search for the held pose; the search ignores painted zones and a mirror.

    Raises InputError for counts that do not fit each other.
    """
    winches = 2  # where their number is left open
    shares = 12  # ways to share the cables among the winches that are tried until a network can be built
    return DesignRequest(
        poses=(robot.pose(POSE),),
        winches=wishes.winches or min(winches, wishes.cables),
        cables=wishes.cables,
        method=DesignMethod.TREES,
        constraints=wishes.constraints.restrict_to_trees(),
        options=replace(wishes.tree_options, shares=shares),
    ).fit_robot(robot)


def propose_network(robot: Robot, moment: ProposalInput, body: BodyPhysics) -> Proposal:
    """Find the network for one proposal input, with the pose that it reaches."""
    posed = with_pose(robot, POSE, moment.held)
    activation = Activation(
        target=posed.pose(POSE),
        fibres=edge_fibres(robot.body.mesh),
        tensions=moment.tensions,
        nodes=moment.nodes,
        errors=Anchored(robot.body.mesh).errors(moment.held, moment.nodes),
    )
    request = asked_of_trees(posed, moment.wishes)
    found = propose_trees(posed, request, [activation], body=body)
    if found is None:  # the knobs as wished give none that can be built
        usual = replace(TreeOptions(), phis=request.tree_options.phis)
        found = propose_trees(posed, replace(request, options=usual), [activation], body=body)
    if found is None:
        return Proposal(words="no cables found for these muscles. Bend the body more, or ask for fewer in Design")
    reached = solve_ik(Simulation(found, body=body), posed.pose(POSE), options=OPTIONS)
    return Proposal(winches=found.winches, cables=found.cables, error=reached.rms_error)


def propose_work(pipe: Connection) -> None:
    """Answer each `ProposalInput` from the pipe with a `Proposal`; a `Robot` in the pipe replaces the robot."""
    polite = 10  # the process steps back by so much, so that what a person drags comes first
    if hasattr(os, "nice"):
        os.nice(polite)
    robot: Robot | None = None
    body: BodyPhysics | None = None
    try:
        while True:
            given: Any = pipe.recv()
            if isinstance(given, Robot):
                robot, body = given, None
            elif robot is not None:
                body = body or BodyPhysics(robot)
                pipe.send(_answer(robot, given, body))
    except (EOFError, OSError, KeyboardInterrupt):
        return


def _answer(robot: Robot, moment: ProposalInput, body: BodyPhysics) -> Proposal:
    try:
        return propose_network(robot, moment, body)
    except HydrostatError as error:
        return Proposal(words=str(error))


LOST = "the proposal process crashed. Switch proposals off and on again"


@dataclass(frozen=True, eq=False)
class _Question:
    """A moment of a robot."""

    robot: Robot
    moment: ProposalInput


class CableProposals:
    """A thread hands the newest moment to a process of its own and takes in what it finds; older moments are lost.

    Asking costs the thread that moves the body nothing but two assignments.
    """

    def __init__(self, document: Document, slots: Slots | None = None) -> None:
        """None are made before they are switched on; then slots, if any, say whether they may."""
        self._document, self._slots = document, slots
        self._news = Condition()
        self._newest: _Question | None = None
        self._found: tuple[Robot, Proposal] | None = None
        self._made: tuple[Robot, Proposal, Robot] | None = None
        self._run = 0  # counts how often it was switched; a thread of another number ends
        self.on = False  # whether networks are proposed

    def switch(self, on: bool) -> None:
        """Begin to propose networks, or end it and forget what there is (InputError: too many rooms do)."""
        with self._news:
            if on == self.on:
                return
            if self._slots is not None:
                (self._slots.take_live if on else self._slots.give_live)()
            self.on, self._newest, self._found = on, None, None
            self._run += 1
            self._news.notify_all()
        if on:
            Thread(target=self._follow, args=(self._run,), name="proposals", daemon=True).start()
        self._document.bell.ring(Topic.THINGS)

    def ask(self, robot: Robot, moment: ProposalInput) -> None:
        """Want a network for this moment, rather than for any before."""
        if not self.on:
            return
        with self._news:
            self._newest = _Question(robot, moment)
            self._news.notify_all()

    def latest_proposal(self, robot: Robot) -> Proposal | None:
        """Return the latest proposal, if it is for a body as this robot has it."""
        found = self._found
        if found is None or not self.on or not same_physics(found[0], robot, Mode.MUSCLES):
            return None
        return found[1]

    def network(self, robot: Robot) -> Robot | None:
        """The robot with the network proposed last; None if there is none."""
        found = self.latest_proposal(robot)
        if found is None or not found.cables:
            return None
        made = self._made  # asked for with every frame, and the checks of a robot take a while
        if made is None or made[0] is not robot or made[1] is not found:
            self._made = made = robot, found, robot.with_network(found.winches, found.cables)
        return made[2]

    def keep(self) -> None:
        """Put the proposed network into the robot, one step to undo (InputError: there is none)."""
        work = self._document.work
        robot = self.network(work.robot)
        if robot is None:
            raise InputError("no network proposed yet. Drag the body until one appears")
        self._document.change("keep proposed cables", robot=robot, wishes=after_design(work, robot))

    def forget(self) -> None:
        """Show no network until the next moment."""
        with self._news:
            self._newest = self._found = None
        self._document.bell.ring(Topic.THINGS)

    def close(self) -> None:
        """End the process; there will be no more."""
        self.switch(False)

    def _follow(self, run: int) -> None:
        """Ask and listen until it is switched off; the process ends when its pipe is closed."""
        context = get_context("spawn")
        here, there = context.Pipe()
        process = context.Process(target=propose_work, args=(there,), daemon=True)
        process.start()
        there.close()
        known: Robot | None = None
        try:
            while (question := self._next(run)) is not None:
                if known is not question.robot:
                    known = question.robot
                    here.send(known)
                here.send(question.moment)
                while not here.poll(0.1):
                    if self._run != run:
                        return
                self._take(run, question.robot, here.recv())
        except (EOFError, OSError):
            self._take(run, self._document.robot, Proposal(words=LOST))
        finally:
            here.close()
            process.kill()
            process.join()

    def _next(self, run: int) -> _Question | None:
        """Wait for the next question; None: it is over."""
        with self._news:
            self._news.wait_for(lambda: self._newest is not None or self._run != run)
            question, self._newest = self._newest, None
            return question if self._run == run else None

    def _take(self, run: int, robot: Robot, found: Proposal) -> None:
        with self._news:
            if self._run == run:
                self._found = (robot, found)
        self._document.bell.ring(Topic.THINGS, Topic.SHAPE)
