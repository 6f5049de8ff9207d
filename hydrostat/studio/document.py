"""`Document`: the open robot, with all that was done to it."""

from dataclasses import dataclass, replace
from pathlib import Path
from threading import RLock

from hydrostat.control import Timeline
from hydrostat.errors import InputError
from hydrostat.learning import LearnedModel
from hydrostat.project import Wishes, Work, folder_stamp
from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics, Simulation
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.jobs import Slots
from hydrostat.studio.judge import Judge

LOCKED = "your teacher has locked the robots. Wait until they are unlocked"

MAX_STEPS = 500  # changes that can be undone; older ones are dropped


@dataclass(eq=False)
class Change:
    """A state of the work, with what led to it."""

    label: str  # what was done, such as "move marker tip"
    work: Work  # after that
    merge: str = ""  # changes in a row with the same word are one, such as those of one drag; "": a change of its own
    simulation: Simulation | None = None  # physics of the robot as it was then; None: not made yet, or forgotten


class Document:
    """The open robot; every change of it can be undone and done again.

    It can be changed from any thread: each change replaces one frozen `Work` by another.
    """

    def __init__(self, bell: Bell, slots: Slots | None = None) -> None:
        """No robot is open; what is looked into beside all else waits for slots that other sessions share."""
        self.bell = bell  # rung after each change
        self.judge = Judge(bell, slots)  # says what is wrong with the robots that are shown
        self.folder: Path | None = None  # where the robot is saved; None: nowhere yet
        self.model: LearnedModel | None = None  # of the robot as it was opened; None: none was given
        self.text = ""  # of the robot.toml that it was opened from; "": none
        self.stamp = ""  # of that folder when it was opened or saved last (`folder_stamp`)
        self.designs = b""  # networks found for the robot, to be kept for a crash; their room knows what is in them
        self.is_locked = False  # whether nothing of it may be changed
        self.serial = 0  # counts the changes, undoing included; the same number means the same work
        self._lock = RLock()
        self._past: list[Change] = []
        self._future: list[Change] = []
        self._saved: Work | None = None
        self._body: BodyPhysics | None = None

    @property
    def is_open(self) -> bool:
        """True if a robot is open."""
        return bool(self._past)

    @property
    def work(self) -> Work:
        """Present work: robot, keyframes and design settings (InputError: no robot is open)."""
        return self._now.work

    @property
    def robot(self) -> Robot:
        """The robot as it is now (InputError: no robot is open)."""
        return self.work.robot

    @property
    def simulation(self) -> Simulation:
        """Physics of the robot as it is now; made when first asked for, in a while (InputError: no robot is open)."""
        now = self._now
        made = now.simulation
        if made is None:
            made = now.simulation = self._make_simulation(now.work.robot)
        return made

    def simulation_of(self, robot: Robot) -> Simulation:
        """Physics of a robot such as the open one; on a body whose physics were made last, they are soon made."""
        return self.simulation if self.is_open and self.robot is robot else self._make_simulation(robot)

    def _make_simulation(self, robot: Robot) -> Simulation:
        """New physics of a robot, sharing those of its body where only its network was changed."""
        body = self._body
        simulation = Simulation(robot, body=body if body is not None and body.fits(robot) else None)
        self._body = simulation.body
        return simulation

    @property
    def is_saved(self) -> bool:
        """True if all changes are saved."""
        return not self._past or self._past[-1].work is self._saved

    @property
    def undo_label(self) -> str:
        """Label of the change that undo takes back; "" if there is none."""
        return self._past[-1].label if len(self._past) > 1 else ""

    @property
    def redo_label(self) -> str:
        """Label of the change that redo makes again; "" if there is none."""
        return self._future[-1].label if self._future else ""

    def open(
        self,
        work: Work,
        *,
        folder: Path | None = None,
        saved: bool = True,
        stamp: str | None = None,
        text: str = "",
        designs: bytes = b"",
    ) -> None:
        """Begin with a robot; what was open before is left as it was.

        It is saved in the folder, all of it or not; None: nowhere yet. The stamp is that of the folder when the work
        was read from it, if that was not just now; the text that of its robot.toml; the designs are networks that were
        found for it before a crash.
        """
        with self._lock:
            self._require_unlocked()
            self._past, self._future = [Change("open", work)], []
            self._body, self.model, self.designs = None, None, designs
            self.folder, self._saved, self.text = folder, work if saved else None, text
            self.stamp = "" if folder is None else folder_stamp(folder) if stamp is None else stamp
            self.serial += 1
        self.bell.ring(Topic.ROBOT, Topic.STAGE, Topic.SHAPE, Topic.SCENE)

    def change(
        self,
        label: str,
        *,
        robot: Robot | None = None,
        timeline: Timeline | None = None,
        wishes: Wishes | None = None,
        merge: str = "",
    ) -> None:
        """Replace parts of the work (InputError: no robot is open, or it is locked).

        The label says what was done, as a person would. A change in a row with the same word `merge` replaces the one
        before.
        """
        with self._lock:
            self._require_unlocked()
            given = {"robot": robot, "timeline": timeline, "wishes": wishes}
            parts = {key: value for key, value in given.items() if value is not None}
            change = Change(label, replace(self.work, **parts), merge)
            if robot is None:
                change.simulation = self._now.simulation
            if merge and len(self._past) > 1 and self._past[-1].merge == merge:
                self._past.pop()
            self._past.append(change)
            del self._past[: -MAX_STEPS - 1]
            self._future = []
            self._forget_physics()
            self.serial += 1
        self.bell.ring(Topic.ROBOT, Topic.SCENE)

    def seal(self) -> None:
        """End a drag: the next change is one of its own."""
        with self._lock:
            if self._past and self._past[-1].merge:
                last = self._past[-1]
                self._past[-1] = Change(last.label, last.work, simulation=last.simulation)

    def undo(self) -> bool:
        """Take back the last change; whether there was one."""
        return self._move(self._past, self._future, least=2)

    def redo(self) -> bool:
        """Do again what was undone last; whether there was something."""
        return self._move(self._future, self._past, least=1)

    def mark_saved(self, folder: Path | None, work: Work) -> None:
        """Note that this work is saved in this folder, None: taken home; nothing happens if another robot is open."""
        with self._lock:
            if not any(change.work is work for change in (*self._past, *self._future)):
                return
            self.folder, self._saved = folder, work
            self.stamp = "" if folder is None else folder_stamp(folder)
        self.bell.ring(Topic.ROBOT)

    def _move(self, source: list[Change], goal: list[Change], *, least: int) -> bool:
        with self._lock:
            self._require_unlocked()
            if len(source) < least:
                return False
            goal.append(source.pop())
            self._forget_physics()
            self.serial += 1
        self.bell.ring(Topic.ROBOT, Topic.SHAPE, Topic.SCENE)
        return True

    def _require_unlocked(self) -> None:
        if self.is_locked:
            raise InputError(LOCKED)

    def _forget_physics(self) -> None:
        """Physics take megabytes: only the last few states keep theirs."""
        kept = 2  # so many states before, and after, keep the physics that were made for them
        for change in (*self._past[:-kept], *self._future[:-kept]):
            change.simulation = None

    @property
    def _now(self) -> Change:
        past = self._past
        if not past:
            raise InputError("no robot is open. Choose one from the gallery, open a folder or import a drawing")
        return past[-1]
