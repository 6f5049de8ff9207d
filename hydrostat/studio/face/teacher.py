"""`build_teacher`: the page of a teacher: a wall of all robots, what is handed out, the lock, all to take home."""

from collections.abc import Callable
from functools import partial

from nicegui import events, run, ui

from hydrostat.errors import HydrostatError
from hydrostat.project import Work
from hydrostat.robot import gallery_folder, list_gallery, load_robot
from hydrostat.studio.face.classroom import Classroom
from hydrostat.studio.face.page import Toasts, icon_button, show_heading
from hydrostat.studio.face.rooms import Room
from hydrostat.studio.face.share import Links, share_dialog
from hydrostat.studio.face.tour import STAGES
from hydrostat.studio.face.window import dress
from hydrostat.studio.session import Tone
from hydrostat.studio.starting.autosave import RecoveredWork
from hydrostat.studio.starting.starter import unpack_robot
from hydrostat.units import plural

BEAT = 1.0  # the wall follows the rooms within this time [s]


def build_teacher(classroom: Classroom, link: str, pictures: str) -> None:
    """Build the page; the link is that of the pupils, pictures of rooms are at a path with their watch keys."""
    _TeacherPage(classroom, link, pictures)


def _named_dialog(name: str) -> ui.dialog:
    """Dialog that a screen reader announces by its name."""
    return ui.dialog().props(f'aria-label="{name}"')


class _TeacherPage:
    def __init__(self, classroom: Classroom, link: str, pictures: str) -> None:
        self._class, self._pictures = classroom, pictures
        dark = dress()
        with ui.header().classes("studio-header"):
            ui.label("hydrostat").classes("studio-brand")
            self._count = ui.label().classes("class-count").props('data-testid="pupils" role="heading" aria-level="1"')
            ui.space()
            lock = ui.switch(
                "Lock", value=classroom.rooms.locked, on_change=lambda event: self._lock(bool(event.value))
            )
            lock.props('data-testid="lock"').tooltip("Nobody can drag or change a robot")
            for words, icon, build in (
                ("Hand out", "redeem", self._hand_out_dialog),
                ("Take home", "download", self._pack_dialog),
            ):
                button = ui.button(words, icon=icon, color=None, on_click=build())
                button.props["aria-label"] = words
                button.props(f'flat no-caps dense data-testid="{words.lower().replace(" ", "-")}"').classes(
                    "class-tool"
                )
            show_link = share_dialog(Links(link, ""))
            button = ui.button("Link", icon="qr_code_2", color=None, on_click=show_link)
            button.props('aria-label="Link" flat no-caps dense data-testid="link"').classes("class-tool")
            icon_button("dark_mode", "Light or dark", dark.toggle, small=False).classes("studio-tool")
        with ui.element("div").classes("class-room"):
            self._hint = ui.label("No pupils yet. Show them the link.").classes("studio-hint")
            self.wall = ui.element("div").classes("class-wall")
            self._toasts = Toasts()
        self._cards: dict[str, _PupilCard] = {}
        ui.timer(BEAT, self._beat)
        self._beat()

    def _beat(self) -> None:
        """Follow the rooms."""
        rooms = self._class.list_rooms()
        self._count.set_text(f"Class, {plural(len(rooms), 'pupil')}")
        self._hint.set_visibility(not rooms)
        for key in self._cards.keys() - {room.key for room in rooms}:
            self._cards.pop(key).element.delete()
        for place, room in enumerate(rooms):
            if room.key not in self._cards:
                with self.wall:
                    self._cards[room.key] = _PupilCard(self, room, self._pictures)
            card = self._cards[room.key]
            if self.wall.default_slot.children[place : place + 1] != [card.element]:
                card.element.move(self.wall, place)
            card.show()
        self._show_packing()

    async def act_slowly(self, done: str, action: Callable[..., object], *arguments: object) -> None:
        """Run an action in a thread, then report that it is done, or its error."""
        try:
            await run.io_bound(action, *arguments)
        except (HydrostatError, OSError) as error:
            self.tell(str(error), Tone.BAD)
        else:
            self.tell(done, Tone.GOOD)

    def act(self, action: Callable[..., object], *arguments: object) -> None:
        """Do something; what was wrong is told."""
        try:
            action(*arguments)
        except HydrostatError as error:
            self.tell(str(error), Tone.BAD)

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Show a note."""
        self._toasts.show(text, tone)

    def _lock(self, on: bool) -> None:
        self._class.lock(on)
        self.tell("All robots are locked" if on else "Robots are unlocked")

    async def hand_out(self, work: Work, text: str = "") -> None:
        """Give a robot to all."""
        await self.act_slowly(f"Handed out {work.robot.name}", self._class.hand_out, work, text)

    async def give_back(self, room: Room) -> None:
        """Let the teacher choose a robot of an earlier lesson for a pupil; own ones come first."""
        most, own = 200, room.name.casefold()
        try:
            earlier = await run.io_bound(self._class.rooms.list_earlier) or []
        except OSError as error:
            self.tell(str(error), Tone.BAD)
            return
        if not earlier:
            self.tell("No earlier robots on this laptop")
            return
        listed = sorted(earlier, key=lambda left: left.owner.casefold() != own)[:most]
        with self.wall, _named_dialog("Earlier robots") as dialog, ui.card().classes("q-pa-md class-dialog"):
            show_heading(f"Earlier robots, for {room.name}", 1)
            with ui.column().classes("w-full gap-0").style("max-height: 50vh; overflow: auto; flex-wrap: nowrap"):
                for left in listed:
                    words = f"{left.owner or 'Pupil'}, {left.words}"
                    row = ui.button(words, color=None, on_click=partial(dialog.submit, left))
                    row.props('flat no-caps align=left data-testid="earlier"').classes("w-full")
            with ui.row().classes("w-full justify-end"):
                ui.button("Cancel", on_click=dialog.close).props("flat no-caps")
        chosen = await dialog
        dialog.delete()
        if isinstance(chosen, RecoveredWork):
            await self.act_slowly(f"Gave {chosen.name} to {room.name}", self._class.give_back, room, chosen)

    def rename(self, room: Room, name: str) -> None:
        """Give a pupil another nickname (InputError: nothing is left of it)."""
        self._class.rooms.rename(room, name)

    def _hand_out_dialog(self) -> Callable[[], object]:
        with _named_dialog("Hand out") as dialog, ui.card().classes("q-pa-md gap-3 class-dialog"):
            show_heading("Hand out a robot", 1)
            ui.label(
                "Everybody gets a copy. Undo brings their own robot back; Start keeps it too. New pupils start with it."
            ).classes("studio-hint")
            chosen = ui.select(list_gallery(), value="starfish", label="Gallery").classes("w-full")

            async def give() -> None:
                dialog.close()
                robot = await run.io_bound(load_robot, gallery_folder(str(chosen.value)))
                if robot is not None:  # else the studio ends
                    await self.hand_out(Work(robot=robot))

            async def brought(event: events.UploadEventArguments) -> None:
                content = await event.file.read()
                dialog.close()
                upload.reset()
                try:
                    found = await run.io_bound(unpack_robot, event.file.name, content)
                except HydrostatError as error:
                    self.tell(str(error), Tone.BAD)
                    return
                if found is not None:  # else the studio ends
                    await self.hand_out(*found)

            upload = ui.upload(label="Or a robot as .zip", max_files=1, max_file_size=20_000_000, auto_upload=True)
            upload.props("accept=.zip flat bordered").classes("w-full").on_upload(brought)
            with ui.row().classes("w-full justify-end"):
                ui.button("Cancel", on_click=dialog.close).props("flat no-caps")
                ui.button("Hand out", on_click=give).props('unelevated no-caps data-testid="hand-out-now"')
        return dialog.open

    def _pack_dialog(self) -> Callable[[], object]:
        with _named_dialog("Take home") as dialog, ui.card().classes("q-pa-md gap-3 class-dialog"):
            show_heading("Take home", 1)
            ui.label("One .zip with a folder for each pupil. Its class.txt lists what could not be made.").classes(
                "studio-hint"
            )
            ui.checkbox("Robots", value=True).props("disable")
            kits = ui.checkbox("Kits, about 10 s each").props('data-testid="kits"')
            pages = ui.checkbox("Pages to share, up to 20 s each").props('data-testid="pages"')
            self._packing = ui.label().classes("studio-hint").props('role="status" data-testid="packing"')
            with ui.row().classes("w-full justify-end"):
                ui.button("Close", on_click=dialog.close).props("flat no-caps")
                self._stop = ui.button("Stop", on_click=self._class.jobs.stop).props("flat no-caps color=negative")
                pack = ui.button("Pack", on_click=lambda: self._begin_packing(bool(kits.value), bool(pages.value)))
                self._pack = pack.props('unelevated no-caps data-testid="pack"')
                self._download = ui.button("Download", on_click=self._take).props(
                    'unelevated no-caps data-testid="take-zip"'
                )
        return dialog.open

    def _begin_packing(self, kits: bool, pages: bool) -> None:
        if not self._class.jobs.is_running:  # a second click of a double click
            self.act(lambda: self._class.pack(kits=kits, pages=pages))
            self._show_packing()

    def _show_packing(self) -> None:
        state, made = self._class.jobs.state, self._class.made
        running = state is not None and state.running
        self._stop.set_visibility(running)
        self._pack.set_enabled(not running)  # it keeps its place: a double click must not press Stop
        self._download.set_visibility(made is not None)
        if state is not None and running:
            self._packing.set_text(f"{state.done + 1} of {state.total}: {state.stage}" if state.total else state.stage)
        elif made is not None:
            self._packing.set_text(f"{made.name}, {made.size}")
        else:
            self._packing.set_text(state.error if state is not None else "")

    def _take(self) -> None:
        made = self._class.made
        if made is not None:
            ui.download.content(made.content, made.name, media_type=made.media_type)


class _PupilCard:
    """A pupil on the wall. Nicknames are set as text and attributes, never as markup."""

    def __init__(self, page: _TeacherPage, room: Room, pictures: str) -> None:
        self._page, self._room, self._pictures = page, room, pictures
        self._serial = -1
        self._named = ""
        with ui.element("article").classes("class-card") as self.element:
            with ui.link(target=f"/room/{room.key}", new_tab=True).classes("class-open") as self._open:
                self._picture = ui.element("img").classes("class-picture").props('alt=""')
            with ui.row().classes("w-full items-center no-wrap gap-1"):
                self._name = ui.label().classes("class-name")
                ui.space()
                self._menu = icon_button("more_vert", "", None)
                with self._menu, ui.menu():
                    ui.menu_item("Rename", self._rename)
                    ui.menu_item("Hand out to all", self._hand_out)
                    ui.menu_item("Restore earlier", lambda: page.give_back(room)).props('data-testid="restore-earlier"')
                    ui.menu_item("Stop job", room.session.jobs.stop)
            self._state = ui.label().classes("studio-hint class-state")

    def show(self) -> None:
        """Follow the room."""
        session, room = self._room.session, self._room
        if room.name != self._named:
            self._named = room.name
            self._name.set_text(room.name)
            self._open.props["aria-label"] = f"Open the robot of {room.name}"
            self._menu.props["aria-label"] = f"Menu of {room.name}"
            self._open.update()
            self._menu.update()
        robot = session.document.robot.name if session.document.is_open else "no robot"
        job = session.jobs.state
        doing = job.title if job is not None and job.running else STAGES[session.stage].title
        self._state.set_text(f"{robot}, {doing}" if room.stream.screens else f"{robot}, away")
        self.element.classes(**{"remove" if room.stream.screens else "add": "class-away"})
        if room.stream.serial != self._serial:
            self._serial = room.stream.serial
            self._picture.props["src"] = f"{self._pictures}/{room.watch_key}?{self._serial}"
            self._picture.update()

    async def _rename(self) -> None:
        with self._page.wall, _named_dialog("Rename") as dialog, ui.card().classes("q-pa-md class-dialog"):
            name = ui.input("Nickname", value=self._room.name).classes("w-full").props("autofocus")
            name.on("keydown.enter", lambda: dialog.submit(name.value))
            with ui.row().classes("w-full justify-end"):
                ui.button("Cancel", on_click=dialog.close).props("flat no-caps")
                ui.button("Rename", on_click=lambda: dialog.submit(name.value)).props("unelevated no-caps")
        found = await dialog
        dialog.delete()
        if found is not None:
            self._page.act(self._page.rename, self._room, str(found))

    async def _hand_out(self) -> None:
        document = self._room.session.document
        if document.is_open:
            await self._page.hand_out(document.work, document.text)
        else:
            self._page.tell(f"{self._room.name} has no robot yet")
