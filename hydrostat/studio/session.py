"""`Session`: one person's studio, all of it but its face."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from threading import RLock
from typing import Any

from hydrostat.closed_set import parse_choice
from hydrostat.errors import HydrostatError, InputError, in_words
from hydrostat.learning import LearnedModel
from hydrostat.project import Work, open_note
from hydrostat.robot import Contact, Robot
from hydrostat.studio.bell import Bell, Topic
from hydrostat.studio.designing.designer import Designer
from hydrostat.studio.document import LOCKED, Document
from hydrostat.studio.driving.driver import Driver
from hydrostat.studio.driving.hardware import Hardware
from hydrostat.studio.editing.editor import Editor
from hydrostat.studio.exporting.download import Download
from hydrostat.studio.exporting.exporter import Exporter
from hydrostat.studio.jobs import Jobs, Slots
from hydrostat.studio.posing import Photographs, Poser
from hydrostat.studio.skins import SewnSkin
from hydrostat.studio.stage import Hit, Stage, StageName
from hydrostat.studio.starting.starter import Starter
from hydrostat.studio.view.coloring import Coloring, Scale, node_values, scale
from hydrostat.studio.view.picture import Show, Shown
from hydrostat.studio.view.scene_items import RobotShape, rest_shape
from hydrostat.studio.view.thumbnail import draw_thumbnail


class Tone(StrEnum):
    """Tone of a note."""

    GOOD = "good"
    PLAIN = "plain"
    BAD = "bad"


@dataclass(frozen=True)
class Note:
    """A line for the person."""

    number: int  # counts the notes
    text: str  # of it
    tone: Tone  # good news, plain or bad


class Session:
    """One open robot and all that can be done with it (R2, R30, R46, R58). It knows no network, so tests are plain.

    Methods return at once, but for `step`, which a thread of its own calls again and again. Several screens may use one
    session: they all see the same, and one of them at a time holds something with its pointer.
    """

    def __init__(self, state: Path | None = None, *, guest: bool = False, slots: Slots | None = None) -> None:
        """An empty studio that remembers in the folder `state`, over runs and crashes; None: nothing.

        A guest of this machine reads and writes none of its folders, and shares its slots for long work with others.
        """
        self.guest = guest  # whether folders of this machine are not this person's
        self.bell = Bell()  # rings when something has changed
        self.document = Document(self.bell, slots)  # the robot, with undo
        self.jobs = Jobs(self.bell, slots)  # long work
        self.starter = Starter(self.document, self.jobs, state, guest=guest)
        self.editor = Editor(self.document, self.jobs)
        self.poser = Poser(self.document, self.jobs)
        self.photographs = Photographs(self.document, self.jobs)  # of the built robot
        self.designer = Designer(self.document, self.jobs)
        self.driver = Driver(self.document, self.jobs)
        self.hardware = Hardware(self.document, self.bell, allowed=not guest)  # motors that do what is shown
        self.exporter = Exporter(self.document, self.jobs)
        self.stages: Mapping[StageName, Stage] = {
            StageName.START: self.starter,
            StageName.EDIT: self.editor,
            StageName.POSE: self.poser,
            StageName.DESIGN: self.designer,
            StageName.DRIVE: self.driver,
            StageName.EXPORT: self.exporter,
        }
        self.stage = StageName.START  # that is shown
        self.coloring = Coloring.FELT  # of the body
        most_notes = 50  # so many notes are kept
        self.notes: deque[Note] = deque(maxlen=most_notes)
        self._told = 0
        self._holder: str | None = None
        self._stamp = self.answered = 0.0  # stamps of the last drag, and of that which the present shape answers
        self._complaint = self._unkept = ""
        self.before = 0  # drags of other rooms that came before the last of this one; 0 where nobody felt it
        self._unsewn: SewnSkin | None = None
        self._show = Show()
        self._lock = RLock()

    @property
    def current(self) -> Stage:
        """The stage that is shown."""
        return self.stages[self.stage]

    def go(self, name: StageName | str) -> None:
        """Show another stage (InputError: there is none of this name, or it needs a robot, and none is open).

        Where it is shown already nothing happens, and nothing is let go.
        """
        name = parse_choice(StageName, name, what="stage")
        if name is not StageName.START:
            _ = self.document.work
        with self._lock:
            if name is self.stage:
                return
            self._let_go()
            self.current.leave()
            self.hardware.hold("stage changed: motors holding. Re-arm to continue")
            self.stage = name
            self.current.enter()
        self.bell.ring(Topic.STAGE, Topic.SHAPE, Topic.SCENE)

    def open_folder(self, folder: Path | str, model: Path | None = None) -> None:
        """Open the robot in a folder and show it; networks of the model answer drags first, as those beside it do.

        Raises:
            InputError: as for `load_robot`; or the model is another robot's, or no model.
        """
        self._at_home()
        self.starter.open_folder(str(folder))
        self._take_model(model)
        self.go(StageName.POSE)
        if self.document.folder is not None and (note := open_note(self.document.folder)):
            self.tell(note, Tone.BAD)

    def _take_model(self, given: Path | None) -> None:
        """Take a model that is given, or else the only one in the folder, which is told where it does not fit."""
        folder, document = self.document.folder, self.document
        beside = sorted(folder.glob("*.model")) if folder is not None and given is None else []
        if given is None and len(beside) != 1:
            return
        try:
            model = LearnedModel.load(given or beside[0])
            if silent := model.card.contact and document.robot.contact is None:
                model.check(replace(document.robot, contact=Contact()))
                self.editor.set_contact(True)
            model.check(document.robot)
        except InputError as error:
            if given is not None:
                raise
            self.tell(f"{beside[0].name}: {error}", Tone.BAD)
            return
        document.model = model
        note = "; trained with contact: self-contact enabled" if silent else ""
        self.tell(f"surrogate model {(given or beside[0]).name} predicts drags first{note}")

    def grab(self, screen: str, hit: Hit, stamp: float = 0.0) -> bool:
        """Take hold of a hit by a screen's pointer; whether it did. The first frame with the answer has the stamp."""
        with self._lock:
            if self._is_refused():
                return False
            if self._holder is not None and self._holder != screen:
                self.tell("another window is dragging. Wait until it releases", Tone.PLAIN)
                return False
            self._let_go()
            held = self._try(lambda: self.document.is_open and self.current.grab(hit))
            self._holder = screen if held else None
            self._stamp = stamp
        self.bell.ring(Topic.SHAPE)
        return bool(held)

    def drag(self, screen: str, hit: Hit, stamp: float = 0.0) -> None:
        """Follow the pointer of a screen, which has moved; nothing happens if it holds nothing."""
        with self._lock:
            if self._holder != screen:
                return
            self._try(lambda: self.current.drag(hit))
            self._stamp = stamp
        self.bell.ring(Topic.SHAPE)

    def release(self, screen: str) -> None:
        """Let go of what the pointer of a screen held."""
        with self._lock:
            if self._holder != screen:
                return
            self._let_go()
        self.bell.ring(Topic.SHAPE, Topic.SCENE)

    def click(self, screen: str, hit: Hit) -> None:
        """Take a click of a screen's pointer."""
        with self._lock:
            if self._holder in (None, screen) and self.document.is_open and not self._is_refused():
                self._try(lambda: self.current.click(hit))
        self.bell.ring(Topic.SHAPE, Topic.SCENE)

    def key(self, name: str) -> bool:
        """Heed a key of the current stage; whether it meant something."""
        if name == "escape":
            self.hardware.hold()  # without waiting for whoever works with the session just now
        with self._lock:
            if name != "escape" and self._is_refused():
                return False
            meant = self.document.is_open and bool(self._try(lambda: self.current.key(name)))
        self.bell.ring(Topic.SHAPE, Topic.SCENE)
        return meant

    @property
    def undo_label(self) -> str:
        """Label of the change that undo takes back; "" if there is none."""
        return (self.current.undo_label if self.document.is_open else "") or self.document.undo_label

    @property
    def redo_label(self) -> str:
        """Label of the change that redo makes again; "" if there is none."""
        return (self.current.redo_label if self.document.is_open else "") or self.document.redo_label

    def undo(self) -> None:
        """Take back the last change: a drag of the stage that is shown, else one of the document."""
        label = self.undo_label
        with self._lock:
            if self._is_refused():
                return
            done = self.current.undo if self.document.is_open and self.current.undo_label else self.document.undo
            done()
        self.tell(f"undone: {label}" if label else "nothing to undo")

    def redo(self) -> None:
        """Do again what was undone."""
        label = self.redo_label
        with self._lock:
            if self._is_refused():
                return
            done = self.current.redo if self.document.is_open and self.current.redo_label else self.document.redo
            done()
        self.tell(f"redone: {label}" if label else "nothing to redo")

    @property
    def is_locked(self) -> bool:
        """True while a teacher has locked it."""
        return self.document.is_locked

    def lock(self, on: bool) -> None:
        """Let nothing be dragged or changed, or let it again."""
        with self._lock:
            self._let_go()
            self.document.is_locked = on
        self.bell.ring(Topic.LOCK, Topic.SHAPE)

    def receive(self, work: Work, *, verb: str = "hand out", past: str = "handed out") -> None:
        """Show a robot that a teacher hands out, or gives back; one step to undo where a robot is open."""
        with self._lock:
            self._let_go()
            locked, self.document.is_locked = self.document.is_locked, False
            try:
                if self.document.is_open:
                    parts = {"robot": work.robot, "timeline": work.timeline, "wishes": work.wishes}
                    self.document.change(f"{verb} {work.robot.name}", **parts)
                else:
                    self.document.open(work)
            finally:
                self.document.is_locked = locked
        if self.stage is StageName.START:
            self.go(StageName.POSE)
        undo = ". Undo brings your robot back" if self.document.undo_label else ""
        self.tell(f"your teacher {past} {work.robot.name}{undo}")

    def save(self, folder: Path | None = None) -> None:
        """Save the robot where it was, or in another folder (InputError: it has none yet, or cannot be written)."""
        self._at_home()
        folder = folder or self.document.folder
        if folder is None:
            raise InputError("choose a folder to save this robot in")
        work = self.document.work  # it may be changed while it is written
        work.save(folder, self.document.text)
        self.document.mark_saved(folder, work)
        self.tell(f"saved in {folder}", Tone.GOOD)

    def take_home(self) -> Download:
        """The robot as a zip, which Start reads; saved by it if it is in no folder (InputError: no robot is open)."""
        work = self.document.work
        made = self.exporter.robot_zip()
        if self.document.folder is None:
            self.document.mark_saved(None, work)
        return made

    def _at_home(self) -> None:
        if self.guest:
            raise InputError("guests cannot open or save folders of this machine. Upload or download a .zip")

    @property
    def waiting(self) -> bool:
        """True if a drag waits for its answer."""
        return self._stamp != self.answered

    @property
    def legend(self) -> Scale | None:
        """Scale of the body's colors; None for plain felt, and for muscles where none move the body."""
        if not self.document.is_open or (self.coloring is Coloring.MUSCLES and self.current.shape().muscles is None):
            return None
        return scale(self.document.robot, self.coloring)

    def color_by(self, coloring: Coloring | str) -> None:
        """Choose what the colors of the body mean (InputError: there is no coloring of this name)."""
        self.coloring = parse_choice(Coloring, coloring, what="coloring")
        self.bell.ring(Topic.SHAPE, Topic.SCENE)

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Leave a note for the person."""
        self._told += 1
        self.notes.append(Note(self._told, text, tone))
        self.bell.ring(Topic.NOTE)

    def step(self, now: float) -> bool:
        """Do a bit of the stage's work; whether there is more. A thread calls it by a clock [s] that only grows."""
        self.starter.autosave.step(now)
        self._tell_unkept()
        if not self.document.is_open:
            return False
        self._tell_unsewn()
        asked, more, complaint = self._stamp, False, ""
        try:
            more = self.current.step(now)
        except HydrostatError as error:
            complaint = str(error)
        if self.hardware.state is not None and self.stage in (StageName.POSE, StageName.DRIVE):
            shape = self.current.shape()
            if shape.muscles is None:  # muscles are imagined: no motor can do what they do
                self.hardware.show(self.document.robot, shape)
        if complaint and complaint != self._complaint:  # a step is tried again and again: it complains once
            self.tell(complaint, Tone.BAD)
        self._complaint, self.answered = complaint, asked
        return more

    def current_view(self) -> Shown | None:
        """Return the content of all screens now; None without a robot."""
        if not self.document.is_open:
            return None
        with self._lock:
            robot, shape, items = *self._look(), self.current.scene_items()
        head = {"stage": str(self.stage), "stamp": self.answered, "errors": shape.errors, "notes": list(shape.notes)}
        head["before"] = self.before
        return self._show.moment(robot, shape, items, head, node_values(robot, shape, self.coloring))

    def thumbnail(self) -> bytes:
        """Return a small picture of the robot as it is shown now, as WebP; empty without a robot."""
        if not self.document.is_open:
            return b""
        with self._lock:
            robot, shape = self._look()
        return draw_thumbnail(robot, shape)

    def _look(self) -> tuple[Robot, RobotShape]:
        """Return the robot and its shape."""
        robot, shape = self.document.robot, self.current.shape()
        if len(shape.nodes) != len(robot.body.mesh.nodes):
            shape = rest_shape(robot)  # the body was changed at this very moment; the next one is right
        return robot, shape

    def close(self) -> None:
        """End all work; what is not saved is there next time."""
        self.poser.proposals.close()
        self.hardware.close()
        self.driver.leave()
        self.driver.motors.link.close()
        self.jobs.close()
        self.document.judge.skins.close()
        self.starter.autosave.close()

    def _tell_unkept(self) -> None:
        """Tell that work cannot be kept for a crash, once for each reason."""
        problem = self.starter.autosave.problem
        if problem and problem != self._unkept:
            self.tell(problem, Tone.BAD)
        self._unkept = problem

    def _tell_unsewn(self) -> None:
        """Tell that a skin cannot be sewn, once, where no list says so."""
        skin = self.document.judge.skin(self.document.robot)
        if skin is None or skin is self._unsewn or not skin.findings:
            return
        self._unsewn = skin
        if self.stage in (StageName.POSE, StageName.DRIVE):
            self.tell(f"skin cannot be sewn: {in_words(skin.findings[0].text)}", Tone.BAD)

    def _is_refused(self) -> bool:
        """True if the room is locked, which is told."""
        if self.is_locked:
            self.tell(LOCKED, Tone.BAD)
        return self.is_locked

    def _let_go(self) -> None:
        if self._holder is not None:
            self._holder = None
            self._try(self.current.release)
            self.document.seal()

    def _try(self, action: Callable[[], Any]) -> Any:
        """Do it; what a person did wrong is told."""
        try:
            return action()
        except HydrostatError as error:
            self.tell(str(error), Tone.BAD)
            return None
