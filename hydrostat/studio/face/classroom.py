"""`Classroom`: what a teacher decides for all rooms of a class; nicknames; all that a class made, to take home."""

from contextlib import suppress
from dataclasses import dataclass, field

from hydrostat.errors import HydrostatError, InputError
from hydrostat.project import Work
from hydrostat.studio.bell import Bell
from hydrostat.studio.exporting.class_work import PupilWork, pack_class
from hydrostat.studio.exporting.download import Download
from hydrostat.studio.face.rooms import Room, Rooms, new_key
from hydrostat.studio.jobs import Jobs
from hydrostat.studio.starting.autosave import RecoveredWork


@dataclass(eq=False)
class Classroom:
    """The teacher's side of some rooms."""

    rooms: Rooms
    key: str = field(default_factory=new_key)  # who knows it is the teacher
    made: Download | None = None  # what was packed last
    jobs: Jobs = field(init=False)  # packs, in line with the pupils' work

    def __post_init__(self) -> None:
        self.jobs = Jobs(Bell(), self.rooms.slots)

    def close(self) -> None:
        """End what is being packed."""
        self.jobs.close()

    def list_rooms(self) -> list[Room]:
        """Rooms of the pupils, by nickname."""
        return sorted(self.rooms.list_rooms(), key=lambda room: room.name.casefold())

    def lock(self, on: bool) -> None:
        """Let no pupil change anything, now and in rooms that open later, or let all again."""
        self.rooms.locked = on
        for room in self.rooms.list_rooms():
            room.session.lock(on)

    def hand_out(self, work: Work, text: str = "") -> None:
        """Show a robot, with the text of its robot.toml, in all rooms, now and later; each pupil can undo it."""
        self.rooms.first = work, text
        for room in self.rooms.list_rooms():
            _give(room, work)

    def give_back(self, room: Room, left: RecoveredWork) -> None:
        """Show work of an earlier lesson in a room; the pupil can undo it (InputError: it cannot be read)."""
        _give(room, Work.open(left.folder / "work"), verb="give back", past="gave back")

    def pack(self, *, kits: bool = False, pages: bool = False) -> None:
        """Begin to pack all robots as one zip (InputError: it is being packed, or there is no robot)."""
        works = []
        for room in self.list_rooms():
            session = room.session
            if session.document.is_open:
                document = session.document
                works.append(PupilWork(room.name, document.work, document.text, session.exporter.kit_options()))
        if not works:
            raise InputError("no robots yet. Wait until pupils have opened the link")
        self.made = None
        self.jobs.start("Packing", pack_class, works, kits, pages, on_done=self._keep)

    def _keep(self, made: Download) -> None:
        self.made = made


def _give(room: Room, work: Work, *, verb: str = "hand out", past: str = "handed out") -> None:
    """Show a robot in a room, and set a copy of the pupil's own aside, as undo ends with the studio."""
    with suppress(OSError, HydrostatError):  # of a full disk, autosave tells the pupil
        room.session.starter.autosave.set_aside()
    room.session.receive(work, verb=verb, past=past)
    room.session.starter.autosave.note_received()
