"""`CableProposals`: cables for the pose that is held just now, found again and again by a process of its own (X1)."""

from dataclasses import dataclass
from multiprocessing.connection import Connection
from threading import Condition, Thread

from hydrostat.design import DesignMethod, assign_cable_sides
from hydrostat.errors import InputError
from hydrostat.robot import Mount, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Slots
from hydrostat.studio.posing.movers import MuscleMover, same_physics
from hydrostat.studio.posing.pose_state import Mode, PoseTargets
from hydrostat.studio.posing.proposal_work import MusclePulls, Proposal, ProposalInput, propose_work
from hydrostat.studio.worker_context import start_worker
from hydrostat.units import plural

LOST = "the proposal process crashed. Switch proposals off and on again"


@dataclass(frozen=True, eq=False)
class _Question:
    """A moment of a robot."""

    robot: Robot
    moment: ProposalInput
    is_settled: bool  # whether the body has come to rest, so that its muscles stay as they are

    def asks_same(self, other: "_Question") -> bool:
        """True if routes have the same answer to both."""
        return _same_body(self.robot, other.robot) and self.moment.asks_same(other.moment)


class CableProposals:
    """A thread hands the newest moment to a process of its own and takes in what it finds; older moments are lost.

    Asking costs the thread that moves the body nothing but a comparison and two assignments.
    """

    def __init__(self, document: Document, slots: Slots | None = None) -> None:
        """None are made before they are switched on; then slots, if any, say whether they may."""
        self._document, self._slots = document, slots
        self._news = Condition()
        self._newest: _Question | None = None  # to be asked
        self._asked: _Question | None = None  # last
        self._found: tuple[Robot, Proposal] | None = None
        self._made: tuple[Robot, Proposal, Robot] | None = None
        self._run = 0  # counts how often it was switched; a thread of another number ends
        self.on = False  # whether networks are proposed
        self.with_poses = False  # whether they should reach the stored poses, too
        self.searching = False  # whether an answer is awaited

    def switch(self, on: bool) -> None:
        """Begin to propose networks, or end it and forget what there is (InputError: too many rooms do)."""
        with self._news:
            if on == self.on:
                return
            if self._slots is not None:
                (self._slots.take_live if on else self._slots.give_live)()
            self.on, self.searching = on, False
            self._newest = self._asked = self._found = None
            self._run += 1
            self._news.notify_all()
        if on:
            Thread(target=self._follow, args=(self._run,), name="proposals", daemon=True).start()
        self._document.bell.ring(Topic.SCENE)

    def include_poses(self, on: bool) -> None:
        """Let networks reach the stored poses that Design is to reach, too, or the held one alone."""
        self.with_poses = on
        self._document.bell.ring(Topic.SCENE)

    def follow(self, robot: Robot, targets: PoseTargets, muscles: MuscleMover | None, *, is_settled: bool) -> None:
        """Want a network for the pose that is held now; where nothing is held, the process prepares for the body."""
        if not self.on:
            return
        if not targets.held:
            self.forget()
        wishes, pulls = self._document.work.wishes, None
        if targets.held and targets.mode is Mode.MUSCLES and muscles is not None:
            nodes, tensions = muscles.pulls
            pulls = MusclePulls(nodes=nodes, tensions=tensions)
        poses = wishes.to_poses(robot) if self.with_poses and robot.poses else ()
        moment = ProposalInput(held=targets.held, wishes=wishes, markers=robot.markers, poses=poses, muscles=pulls)
        self.ask(robot, moment, is_settled=is_settled)

    def ask(self, robot: Robot, moment: ProposalInput, *, is_settled: bool = False) -> None:
        """Want a network for this moment, rather than for any before; asked again, nothing is done twice.

        Winch trees are asked again once the body has settled: they follow its muscles.
        """
        if not self.on:
            return
        question = _Question(robot, moment, is_settled)
        with self._news:
            asked = self._asked
            if asked is not None and question.asks_same(asked):
                has_muscles = is_settled and not asked.is_settled and moment.muscles is not None
                if self.searching or self._is_by_routes or not has_muscles:
                    return
            self._newest = self._asked = question
            self.searching = bool(moment.held)
            self._news.notify_all()

    @property
    def _is_by_routes(self) -> bool:
        """True if the last answer is a network by routes."""
        found = self._found
        return found is not None and bool(found[1].cables) and found[1].method is DesignMethod.ROUTES

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
            proposed = assign_cable_sides(robot).with_network(found.winches, found.cables)
            self._made = made = robot, found, proposed
        return made[2]

    def is_kept(self, robot: Robot) -> bool:
        """True if the robot has the network proposed last."""
        found = self.network(robot)
        return found is not None and (found.winches, found.cables) == (robot.winches, robot.cables)

    def keep(self) -> str:
        """Put the proposed network into the robot, one step to undo; a word on it (InputError: there is none)."""
        work = self._document.work
        robot = self.network(work.robot)
        if robot is None:
            raise InputError("no network proposed yet. Drag the body until one appears")
        self._document.change("keep proposed cables", robot=robot, wishes=work.after_design(robot))
        self._document.bell.ring(Topic.SCENE)
        counts = f"{plural(len(robot.winches), 'winch')} and {plural(len(robot.cables), 'cable')}"
        return f"kept {counts}. Undo takes them back"

    def forget(self) -> None:
        """Show no network until the next moment."""
        with self._news:
            if self._found is None and (self._asked is None or not self._asked.moment.held):
                return
            self._newest = self._asked = self._found = None
            self.searching = False
        self._document.bell.ring(Topic.SCENE)

    def close(self) -> None:
        """End the process; there will be no more."""
        self.switch(False)

    def _follow(self, run: int) -> None:
        """Ask and listen until it is switched off; the process ends when its pipe is closed."""
        process, here = start_worker(propose_work)
        known: Robot | None = None
        try:
            while (question := self._next(run)) is not None:
                if known is None or not _same_body(known, question.robot):
                    known = question.robot
                    here.send(known)
                here.send(question.moment)
                self._receive(run, here, question.robot)
        except (EOFError, OSError):
            self._take(run, self._document.robot, Proposal(words=LOST))
        finally:
            here.close()
            process.kill()
            process.join()

    def _receive(self, run: int, pipe: Connection, robot: Robot) -> None:
        """Take what is found until the answer is complete; where something else is asked, it ends early."""
        tick, is_called_off = 0.02, False  # seconds between two looks at what is asked
        while self._run == run:
            if pipe.poll(tick):
                proposal = pipe.recv()
                if proposal is None:
                    break
                self._take(run, robot, proposal)
            elif self._newest is not None and not is_called_off:
                is_called_off = True
                pipe.send(None)
        with self._news:
            if self._run == run:
                self.searching = self.searching and self._newest is not None
        self._document.bell.ring(Topic.SCENE)

    def _next(self, run: int) -> _Question | None:
        """Wait for the next question; None: it is over."""
        with self._news:
            self._news.wait_for(lambda: self._newest is not None or self._run != run)
            if self._run != run:  # what is asked now is for the next process
                return None
            question, self._newest = self._newest, None
            return question

    def _take(self, run: int, robot: Robot, found: Proposal) -> None:
        with self._news:
            is_wanted = self._asked is not None and bool(self._asked.moment.held)
            if self._run == run and (is_wanted or found.words == LOST):
                self._found = (robot, found)
                self.searching = self.searching and found.words != LOST
        self._document.bell.ring(Topic.SCENE, Topic.SHAPE)


def _same_body(one: Robot, other: Robot) -> bool:
    """True if networks for both are the same: all that matters but markers, poses and winches in the body."""
    if one is other:
        return True
    worlds = [[winch for winch in robot.winches if winch.mount is Mount.WORLD] for robot in (one, other)]
    same = (one.contact, one.obstacles, one.face, worlds[0]) == (other.contact, other.obstacles, other.face, worlds[1])
    return same and same_physics(one, other, Mode.MUSCLES)
