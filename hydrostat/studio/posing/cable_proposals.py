"""`CableProposals`: cables that would do what the muscles do, found while a person drags (X1)."""

from dataclasses import dataclass
from multiprocessing import get_context
from threading import Condition, Thread

from hydrostat.errors import InputError
from hydrostat.project import after_design
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Slots
from hydrostat.studio.posing.held import Mode
from hydrostat.studio.posing.movers import same_physics
from hydrostat.studio.posing.propose_work import Proposal, ProposalInput, propose_work

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
