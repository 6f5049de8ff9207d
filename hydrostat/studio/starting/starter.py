"""`Starter`: the stage "start"."""

import stat
import zlib
from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from lzma import LZMAError
from pathlib import Path, PurePath, PurePosixPath
from tempfile import TemporaryDirectory
from threading import RLock
from typing import Any
from zipfile import BadZipFile, ZipFile, ZipInfo

from hydrostat.errors import InputError
from hydrostat.project import Work, open_note, text_of
from hydrostat.robot import FILE, GALLERY, gallery_folder, get_material, is_of_gallery, load_robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.document import Document
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.robot_link import unpack_robot_link
from hydrostat.studio.skins import SewnSkin
from hydrostat.studio.stage import Stage
from hydrostat.studio.starting.autosave import Autosave
from hydrostat.studio.starting.draft import BodyDraft, new_draft
from hydrostat.studio.starting.loops import fit_loops
from hydrostat.studio.starting.outlining import Outlining
from hydrostat.studio.starting.shelf import Card, Recent, card_of, distinguish_cards, robots_in
from hydrostat.studio.starting.sketch import PartChoice, Sketch, make_sketch
from hydrostat.studio.view.robot_items import robot_items
from hydrostat.studio.view.scene_items import RobotShape, SceneItem, rest_shape
from hydrostat.units import printable, quote

_BROKEN = (BadZipFile, EOFError, NotImplementedError, RuntimeError, OSError, zlib.error, LZMAError)

MAX_FILES = 200  # in an archive
MAX_BYTES = 200_000_000  # of all its files, unpacked


def unpack_robot(name: str, content: bytes) -> tuple[Work, str]:
    """Return the robot and the text of its robot.toml; sizes are checked before anything is unpacked.

    Raises:
        InputError: no archive, too large, a file that would climb out of its folder, or not one robot in it.
    """
    shown = quote(PurePosixPath(name.replace("\\", "/")).name[:60])
    folder = Path()
    try:
        with ZipFile(BytesIO(content)) as archive, TemporaryDirectory() as scratch:
            folder = Path(scratch)
            entries = _check_entries(archive.infolist(), shown)
            home = _home(list(entries), shown)
            for path, entry in entries.items():
                if path.parent == home or home in path.parents:
                    _write(archive, entry, folder / path.relative_to(home), shown)
            if note := open_note(folder):
                raise InputError(f"{shown}: {note}")
            return Work.open(folder), text_of(folder)
    except InputError as error:  # of robot.toml, by the name of a scratch folder that nobody knows
        raise InputError(str(error).replace(f"{folder}/", f"{shown}: ")) from None
    except (
        BadZipFile,
        EOFError,
        NotImplementedError,
        RuntimeError,
        OSError,
        ValueError,
        zlib.error,
        LZMAError,
    ) as error:
        words = printable(str(error).replace(f"{folder}/", ""))[:120]
        raise InputError(f"{shown}: cannot be unpacked ({words}); download the robot again") from None


def _check_entries(entries: list[ZipInfo], shown: str) -> dict[PurePosixPath, ZipInfo]:
    """Files by their paths, none of which leads out of the archive."""
    files = [entry for entry in entries if not entry.is_dir()]
    if len(files) > MAX_FILES:
        raise InputError(f"{shown}: has {len(files)} files, at most {MAX_FILES} are read")
    total = sum(entry.file_size for entry in files)
    if total > MAX_BYTES:
        raise InputError(f"{shown}: has {total / 1e6:.0f} MB unpacked, at most {MAX_BYTES / 1e6:.0f} MB are read")
    found: dict[PurePosixPath, ZipInfo] = {}
    deepest = 4  # folders in one another
    for entry in files:
        path = PurePosixPath(entry.filename)
        odd = path.is_absolute() or ".." in path.parts or "\\" in entry.filename or ":" in entry.filename
        if odd or len(path.parts) > deepest or stat.S_ISLNK(entry.external_attr >> 16):
            raise InputError(f"{shown}: {quote(entry.filename[:60])} would lie outside the robot's folder")
        if path in found:
            raise InputError(f"{shown}: has two files {quote(entry.filename[:60])}")
        found[path] = entry
    return found


def _home(paths: list[PurePosixPath], shown: str) -> PurePosixPath:
    """The folder of the robot in the archive."""
    homes = sorted((path.parent for path in paths if path.name == FILE), key=lambda home: len(home.parts))
    if not homes:
        raise InputError(f"{shown}: no {FILE} found. This is not a robot: use Download robot, not a kit or pictures")
    if len(homes) > 1 and len(homes[1].parts) == len(homes[0].parts):
        raise InputError(f"{shown}: has {len(homes)} robots in it. Import one at a time")
    return homes[0]


def _write(archive: ZipFile, entry: ZipInfo, goal: Path, shown: str) -> None:
    """One file, and no more of it than its entry says."""
    goal.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(entry) as source:
        data = source.read(entry.file_size + 1)
    if len(data) > entry.file_size:
        raise InputError(f"{shown}: {quote(entry.filename[:60])} is larger than its header states")
    goal.write_bytes(data)


TITLE = "Meshing"

_MODULES = (  # what a process that meshes needs; a process that has them already answers at once
    "hydrostat.studio.starting.sketch",
    "hydrostat.geometry.files.outline_file",
    "hydrostat.geometry.tetrahedra.tetrahedralize",
    "hydrostat.plot",
)

_LIGHT = {"name", "material"}  # what can be changed without a new mesh


class Starter(Stage):
    """The stage where work begins: a robot of the gallery, a folder, a file, or an outline drawn by hand."""

    def __init__(self, document: Document, jobs: Jobs, state: Path | None = None, *, guest: bool = False) -> None:
        """A stage that opens robots in a document, meshes in jobs, and remembers in a folder; None: nothing."""
        self._document, self._jobs = document, jobs
        # keeps the work of the session
        self.autosave = Autosave(document, None if state is None else state / "work", guest=guest)
        self.draft: BodyDraft | None = None  # what is to become a robot; None: nothing was brought
        self.sketch: Sketch | None = None  # what was made of a draft, perhaps one before the present; None: nothing yet
        self.choice: PartChoice | None = None  # shapes of the draft's file that may be the body; None: no choice
        self.problem = ""  # why nothing can be made of the draft; "" if something can
        self.outlining: Outlining | None = None  # the outline that is drawn; None: none
        self._recent = Recent(None if state is None else state / "recent.json")
        self._known: Path | None = None
        self._working: BodyDraft | None = None
        self._halted = self._eager = False
        self._lock = RLock()
        document.bell.listen(self._on_topic)

    def shape(self) -> RobotShape:
        """The rest shape."""
        return rest_shape(self._document.robot)

    def scene_items(self) -> Sequence[SceneItem]:
        """All parts of the robot."""
        return robot_items(self._document.robot)

    def open_gallery(self, folder: Path) -> None:
        """Open a copy of a gallery robot, which Save asks a folder for."""
        self._document.open(Work(robot=load_robot(folder)), text=text_of(folder))

    def open_folder(self, text: str) -> None:
        """Open the robot in a folder, or a copy of gallery:NAME (InputError: there is none, or it is wrong)."""
        if not text.strip():
            raise InputError("folder name missing")
        if is_of_gallery(text.strip()):
            self.open_gallery(gallery_folder(text.strip().removeprefix(GALLERY)))
            return
        try:
            folder = Path(text.strip()).expanduser()
            work = Work.open(folder)
        except (OSError, ValueError, RuntimeError) as error:
            raise InputError(f"cannot read this folder ({error})") from None
        home = folder.parent if folder.suffix == ".toml" else folder
        self._document.open(work, folder=home, text=text_of(home))

    def open_zip(self, name: str, content: bytes) -> None:
        """Open the robot in a .zip, such as Export makes; Save asks for a folder (InputError: there is none in it)."""
        work, text = unpack_robot(name, content)
        self._document.open(work, text=text)

    def open_link(self, link: str) -> None:
        """Open the robot in a link that Share made (InputError: there is none in it, or it is wrong)."""
        self.open_zip("the link", unpack_robot_link(link))

    def recent(self) -> list[Card]:
        """Robots that were open lately, then those of the working folder; each once, those of one name told apart."""
        return distinguish_cards([*map(card_of, self._recent.folders()), *robots_in(Path.cwd())])

    @property
    def is_meshing(self) -> bool:
        """True if a sketch is being meshed."""
        return self._working is not None

    @property
    def is_current(self) -> bool:
        """True if the sketch is that of the present draft."""
        return self.sketch is not None and self.sketch.draft is self.draft and not self.problem

    def get_ready(self) -> None:
        """Keep a process ready from now on that meshes files, which may be brought soon."""
        self._eager = True
        self._jobs.warm(*_MODULES)

    def bring(self, name: str, content: bytes) -> None:
        """Mesh a file that a person brings, as a job (InputError: empty, too large, no known kind, or other work)."""
        draft = new_draft(name, content)
        with self._lock:
            self.sketch = self.choice = None
            self._take(draft)

    def revise(self, **changes: Any) -> None:
        """Ask for other numbers of the `BodyDraft`; a new mesh only where needed (InputError: one out of range)."""
        with self._lock:
            if self.draft is None:
                return
            draft = replace(self.draft, **changes)
            if self.sketch is not None and self.is_current and not self.is_meshing and set(changes) <= _LIGHT:
                self.draft, self.sketch = draft, _with_light(self.sketch, draft)
                self._look_at_skin()
                self._document.bell.ring(Topic.JOB)
            elif draft != self.draft or self.problem:
                self._take(draft)

    def make(self) -> None:
        """Open the robot that was sketched (InputError: there is none, or it is not what was asked for last)."""
        with self._lock:
            sketch = self.sketch
            if sketch is None or not self.is_current or self.is_meshing:
                raise InputError(self.problem or "meshing in progress. Wait a moment")
            self._document.open(Work(robot=sketch.robot), saved=False)
            self.drop()

    def drop(self) -> None:
        """Begin with nothing again."""
        with self._lock:
            self.draft = self.sketch = self.outlining = self.choice = None
            self.problem = ""
            self._end()
        self._document.bell.ring(Topic.JOB)

    def stop(self) -> None:
        """End meshing; what was sketched before stays."""
        with self._lock:
            if self.sketch is None:
                self.drop()
            elif self._working is not None:
                self.draft, self._halted = self.sketch.draft, True
                self._end()

    def outline_new(self) -> None:
        """Begin to draw an outline."""
        self.outlining = Outlining()
        self._document.bell.ring(Topic.JOB)

    def outline_open(self) -> None:
        """Begin to edit the outline of the open robot (InputError: it was not drawn)."""
        self.outlining = Outlining.of(self._document.robot)
        self._document.bell.ring(Topic.JOB)

    def outline_correct(self) -> None:
        """Begin to correct the outline of the sketch, over its picture if there is one (InputError: it is not flat)."""
        sketch = self.sketch
        if sketch is None or sketch.robot.body.outline is None:
            raise InputError("no flat outline yet")
        self.outlining = Outlining(fit_loops(sketch.robot.body.outline), behind=sketch.behind)
        self._document.bell.ring(Topic.JOB)

    def outline_cancel(self) -> None:
        """Draw no further; what was brought is there still."""
        self.outlining = None
        self._document.bell.ring(Topic.JOB)

    def outline_done(self) -> None:
        """Make a draft of the outline that was drawn (InputError: it is no body)."""
        if self.outlining is None:
            return
        content, before = self.outlining.drawing(), self.draft
        if before is None:
            self.bring("outline.svg", content)
        else:  # what was chosen for the picture that was corrected stays
            kept = {key: getattr(before, key) for key in ("name", "material", "nodes", "element_size", "thickness")}
            draft = replace(new_draft(f"{PurePath(before.file).stem}.svg", content), **kept)
            with self._lock:
                self.sketch = None
                self._take(draft)
        self.outlining = None
        self._document.bell.ring(Topic.JOB)

    def outline_apply(self) -> None:
        """Give the open robot the outline that was drawn; one change, which can be undone.

        After an InputError, for what is no body, holds no pin or was drawn for another body, nothing has changed.
        """
        outlining = self.outlining
        if outlining is None:
            return
        asked = outlining.loops
        while True:
            before = self._document.work
            if outlining.robot is not None and outlining.robot.body.content != before.robot.body.content:
                raise InputError("outline not applied: another body was opened meanwhile")
            work = outlining.apply_outline(before).work
            if self.outlining is not outlining or outlining.loops != asked:
                raise InputError("the outline changed meanwhile. Apply it again when it is done")
            if self._document.work is before:  # else it is made again, for what was changed meanwhile
                break
        self._document.change("edit outline", robot=work.robot, timeline=work.timeline, wishes=work.wishes)
        self.outlining = None
        self._document.bell.ring(Topic.JOB)

    def _take(self, draft: BodyDraft) -> None:
        """Make a sketch of a draft as soon as the one before is out of the way."""
        self.draft, self.problem, self._halted = draft, "", False
        if self._working is None:
            self._begin(draft)
        else:
            self._end()
        self._document.bell.ring(Topic.JOB)

    def _begin(self, draft: BodyDraft) -> None:
        self._working = draft
        try:
            self._jobs.start(
                TITLE, make_sketch, draft, on_part=self._on_choice, on_done=self._on_found, on_end=self._on_end
            )
        except InputError as error:
            self._working, self.problem = None, str(error)

    def _end(self) -> None:
        """Stop the sketch that is being made."""
        if self._working is not None:
            self._jobs.stop()
            self._jobs.stop()  # asked twice, it is ended at once

    def _on_choice(self, choice: PartChoice) -> None:
        with self._lock:
            if self.draft is not None and self.draft.file == choice.file:
                self.choice = choice

    def _on_found(self, sketch: Sketch) -> None:
        with self._lock:
            if self.draft is not None and sketch.draft == self.draft:
                self.sketch = replace(sketch, draft=self.draft)  # what came from the process is a copy

    def _on_end(self, error: str) -> None:
        with self._lock:
            again = self.draft is not None and self.draft is not self._working and not self._halted
            if self.draft is not None and not again and not self._halted:
                self.problem = error
            self._working, self._halted = None, False
            self._look_at_skin()
            if again and self.draft is not None:
                self._begin(self.draft)
            elif self._eager:
                self.get_ready()
        self._document.bell.ring(Topic.JOB)

    @property
    def skin(self) -> SewnSkin | None:
        """Skin of the sketched body, sewn or refused; None without a sketch, or for a body that needs no skin."""
        return None if self.sketch is None else self._document.judge.skin(self.sketch.robot)

    def _look_at_skin(self) -> None:
        if self.sketch is not None and self.is_current:
            self._document.judge.skins.look(self.sketch.robot.body, self._document.judge.options)

    def _on_topic(self, topic: Topic) -> None:
        """Remember the folder of the robot."""
        folder = self._document.folder
        if topic is Topic.ROBOT and folder is not None and folder != self._known:
            self._known = folder
            self._recent.add(folder)


def _with_light(sketch: Sketch, draft: BodyDraft) -> Sketch:
    """The same sketch of another name and material."""
    body = replace(sketch.robot.body, material=get_material(draft.material))
    return replace(sketch, draft=draft, robot=replace(sketch.robot, name=draft.name, body=body))
