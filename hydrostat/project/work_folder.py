"""`Work`: a robot's folder with robot.toml and, next to it, studio.json."""

import hashlib
import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from hydrostat.control import Timeline
from hydrostat.errors import InputError
from hydrostat.files import read_text
from hydrostat.project.project_file import PROJECT_FILE, read_project_file, write_project_file
from hydrostat.project.wishes import Wishes
from hydrostat.robot import FILE, Robot, Source, load_robot, lost_comments, merged_text, robot_text, save_robot


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """Robot, keyframes and design settings that a person works on; each change makes a new record."""

    robot: Robot  # body, pins, winches, cables, markers, poses
    timeline: Timeline = field(default_factory=Timeline)  # keyframes
    wishes: Wishes = field(default_factory=Wishes)  # for a design

    def after_design(self, robot: Robot) -> Wishes:
        """Wishes after a design has given the robot another network: what was kept and is there still is kept on."""
        same = {cable.name: cable.name for cable in self.robot.cables if cable in robot.cables}
        wishes = self.follow_robot(robot, cables=same)[1]
        places = {winch.name: winch.at for winch in self.robot.winches}
        stayed = {winch.name for winch in robot.winches if places.get(winch.name) == winch.at}
        return replace(wishes, kept_winches=tuple(name for name in wishes.kept_winches if name in stayed))

    def warnings(self, folder: Path, stamp: str = "") -> list[str]:
        """Questions for a person before work is saved; none if nothing is lost. Stamp: when last saved, "": never."""
        asked = []
        if changed_outside(folder, stamp):
            asked.append(
                "Files of the robot were changed by another program since it was opened; saving replaces that."
                if stamp
                else "There is a robot in this folder already; saving replaces it."
            )
        file = _home(folder) / self.robot.body.file
        if self.robot.body.file != _body_file(_home(folder)) and _is_other(file, self.robot.body.content):
            asked.append(f"There is another {file.name} in this folder, not of this robot; saving replaces it.")
        lost = self.comments_lost(folder)
        most_told = 5  # so many lost comments are told one by one
        if lost:
            told = lost if len(lost) <= most_told else [*lost[:most_told], f"and {len(lost) - most_told} more"]
            asked.append("Comments in robot.toml would be lost, as what they speak of is gone:\n" + "\n".join(told))
        note = open_note(folder)
        if note:
            asked.append(f"{PROJECT_FILE} cannot be read and would be replaced.")
        return asked

    def follow_robot(
        self, robot: Robot, renamed: Mapping[str, str] | None = None, cables: Mapping[str, str] | None = None
    ) -> tuple[Timeline, Wishes]:
        """Timeline and wishes that name only what the robot has now, by new names of winches and cables for old ones.

        Without names of cables, each is in its old place where there are as many as before, else those that are there
        still have their old names.
        """
        names = {winch.name for winch in robot.winches}
        new = dict(renamed or {})
        keys = []
        for key in self.timeline.keys:
            told = {new.get(name, name): value for name, value in key.contractions.items()}
            kept = {name: value for name, value in told.items() if name in names}
            keys.append(key if kept == key.contractions else replace(key, contractions=kept))
        before, now = self.wishes, [cable.name for cable in robot.cables]
        if cables is None:
            were = [cable.name for cable in self.robot.cables]
            cables = dict(zip(were if len(were) == len(now) else now, now, strict=True))
        wishes = replace(
            before,
            poses=tuple(pose for pose in before.poses if pose in robot.poses),
            kept_winches=tuple(name for name in (new.get(name, name) for name in before.kept_winches) if name in names),
            kept_cables=tuple(cables[name] for name in before.kept_cables if name in cables),
        )
        return replace(self.timeline, keys=tuple(keys)), before if wishes == before else wishes

    def comments_lost(self, folder: Path) -> list[str]:
        """Comments of a robot.toml that would be lost by saving, because what they speak of is gone."""
        file = _home(folder) / FILE
        if not file.is_file():
            return []
        try:
            before = read_text(file)
        except InputError:
            return []
        return lost_comments(before, merged_text(before, self.robot))

    def save(self, folder: Path, text: str = "") -> None:
        """Write everything into a folder; a robot.toml that is there keeps its comments and its form where it can.

        Comments of the text, of the robot.toml that the work began with, go along into a new folder. A name that is not
        allowed, or a folder that cannot be written, is an InputError.
        """
        folder = _home(folder)
        save_robot(self.robot, folder, text=_text(self, folder, text))
        kept = (folder / PROJECT_FILE).exists() or self.timeline != Timeline() or self.wishes != Wishes()
        if kept or self.robot.cables:  # a kit keeps the tensions of cables to these limits
            write_project_file(folder, self.timeline, self.wishes)

    @staticmethod
    def open(folder: Path) -> "Work":
        """Read a robot's folder.

        A broken studio.json is left, `open_note` says why (InputError: as for `load_robot`).
        """
        robot = load_robot(folder)
        try:
            timeline, wishes = read_project_file(_home(folder), [cable.name for cable in robot.cables])
        except InputError:
            timeline, wishes = Timeline(), Wishes()
        if wishes == Wishes() and robot.max_tension is not None:
            wishes = wishes.with_values(tension=robot.max_tension)
        return Work(robot=robot, timeline=timeline, wishes=wishes)


def fresh_name(stem: str, taken: Collection[str]) -> str:
    """The first of stem_1, stem_2 ... that is not taken."""
    number = 1
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"


def open_note(folder: Path) -> str:
    """Reason why keyframes and wishes of a folder could not be read; "" if they could."""
    try:
        read_project_file(_home(folder))
    except InputError as error:
        return f"keyframes and wishes were not read: {error}"
    return ""


def folder_stamp(folder: Path) -> str:
    """Hash that changes when robot.toml, studio.json or the body's file do; "" for a folder without a robot."""
    home = _home(folder)
    if not (home / FILE).is_file():
        return ""
    body = _body_file(home)
    files = [home / FILE, home / PROJECT_FILE, *([home / body] if body else [])]
    stamp = hashlib.sha256()
    try:
        for file in files:
            stamp.update(file.read_bytes() if file.is_file() else b"")
            stamp.update(b"\0")
    except OSError:
        return "cannot be read"
    return stamp.hexdigest()


def changed_outside(folder: Path, stamp: str) -> bool:
    """Return True if someone else wrote into a folder since it had this `folder_stamp`."""
    return folder_stamp(folder) not in ("", stamp)


def _body_file(home: Path) -> str:
    """Name of the body's file in a robot.toml; "" where none is said."""
    try:
        body = tomllib.loads(read_text(home / FILE))["body"]
        return next(str(body[kind.value]) for kind in Source if isinstance(body.get(kind.value), str))
    except (InputError, tomllib.TOMLDecodeError, KeyError, AttributeError, StopIteration):
        return ""


def _is_other(file: Path, content: bytes) -> bool:
    """Return True if there is a file of other content; also one that cannot be read."""
    try:
        return file.exists() and file.read_bytes() != content
    except OSError:
        return True


def _text(work: Work, folder: Path, origin: str) -> str:
    """The text of robot.toml that will be."""
    try:
        before = read_text(folder / FILE) if (folder / FILE).is_file() else origin
        return merged_text(before, work.robot) if before else robot_text(work.robot)
    except InputError:
        return robot_text(work.robot)


def text_of(folder: Path) -> str:
    """The text of robot.toml in a folder; "" if there is none."""
    try:
        return read_text(_home(folder) / FILE)
    except InputError:
        return ""


def _home(folder: Path) -> Path:
    """The folder itself, also where its robot.toml is named."""
    return folder.parent if folder.suffix == ".toml" and not folder.is_dir() else folder
