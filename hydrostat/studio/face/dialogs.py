"""`SaveDialog`, `may_leave`: questions asked before something is lost."""

from functools import partial
from itertools import count
from pathlib import Path

from nicegui import ui

from hydrostat.studio.face.page import WindowPage, show_heading


class SaveDialog:
    """Saves: at once where nothing can be lost by it, else after asking. A guest takes the robot home."""

    def __init__(self, page: WindowPage) -> None:
        """Build the dialogs of a window."""
        self._page, self._document = page, page.session.document
        with ui.dialog() as self._dialog, ui.card().classes("q-pa-md").style("min-width: 420px"):
            show_heading("Save robot", 1)
            ui.label("A folder with robot.toml and the file of the body.").classes("studio-hint")
            self._folder = ui.input("Folder").classes("w-full").mark("save-folder")
            with ui.row().classes("w-full justify-end"):
                ui.button("Cancel", on_click=lambda: self._dialog.submit("")).props("flat no-caps")
                ui.button("Save", on_click=lambda: self._dialog.submit(self._folder.value)).props(
                    "unelevated no-caps"
                ).mark("save-now")
        self._sure = _Sure()

    async def save(self) -> None:
        """Save where the robot is, else where a person says."""
        if self._page.session.guest:
            await self.take_home()
        elif self._document.folder is None:
            await self.save_as()
        else:
            await self._save_in(self._document.folder)

    async def save_as(self) -> None:
        """Save where a person says; at first a folder beside that of the robot."""
        now = self._document.folder
        self._folder.set_value(str(Path.cwd() / self._document.robot.name if now is None else beside(now)))
        told = await self._dialog
        name = (told or "").strip()
        if name:
            await self._save_in(Path(name).expanduser())
        elif told is not None and self._folder.value is not None and not self._folder.value.strip():
            self._page.tell("folder name missing")

    async def take_home(self) -> None:
        """Hand the robot over as a zip."""
        made = await self._page.act_slowly(self._page.session.take_home)
        if made is not None:
            ui.download.content(made.content, made.name, media_type=made.media_type)

    async def _save_in(self, goal: Path) -> None:
        document = self._document
        same = document.folder is not None and goal.resolve() == document.folder.resolve()
        told = await self._page.act_slowly(document.work.warnings, goal, document.stamp if same else "")
        if told is None:
            return
        answer = await self._sure.ask(told) if told else "save"
        if answer == "save":
            await self._page.act_slowly(self._page.session.save, goal)
        elif answer == "elsewhere":
            await self.save_as()


def beside(folder: Path) -> Path:
    """A folder of nearly the same name that is not there yet, such as fish_2."""
    tried = (folder.with_name(f"{folder.name}_{number}") for number in count(2))
    return next(place for place in tried if not place.exists())


class _Sure:
    """Tells what would be lost, and asks whether it may be."""

    def __init__(self) -> None:
        with ui.dialog() as self._dialog, ui.card().classes("q-pa-md").style("width: 480px"):
            show_heading("Overwrite existing files?", 1)
            self._words = ui.column().classes("w-full gap-2")
            with ui.row().classes("w-full justify-end"):
                self._button("Cancel", "", "flat").mark("save-cancel")
                self._button("Save as…", "elsewhere", "flat").mark("save-elsewhere")
                self._button("Overwrite", "save", "unelevated color=negative").mark("save-over")

    async def ask(self, told: list[str]) -> str:
        """Show the questions and return the choice: "save", "elsewhere", or "" to cancel."""
        self._words.clear()
        with self._words:
            for words in told:
                ui.label(words).style(
                    "font-size: 14px; line-height: 1.45; white-space: pre-line; overflow-wrap: anywhere"
                )
        return await self._dialog or ""

    def _button(self, words: str, answer: str, look: str) -> ui.button:
        return ui.button(words, on_click=lambda: self._dialog.submit(answer)).props(f"no-caps {look}")


async def may_leave(page: WindowPage) -> bool:
    """Ask if there is work that is not saved, and save it if a person says so; whether it may be left now."""
    document = page.session.document
    if document.is_saved:
        return True
    with page.whole, ui.dialog() as dialog, ui.card().classes("q-pa-md"):
        show_heading(f"Unsaved changes in {document.robot.name}", 1)
        ui.label("If you open another robot now, they are lost.").classes("studio-hint")
        with ui.row().classes("w-full justify-end items-center"):
            for words, answer, look in (
                ("Cancel", "no", "flat"),
                ("Discard changes", "yes", "flat color=negative"),
                ("Download" if page.session.guest else "Save", "save", "unelevated"),
            ):
                button = ui.button(words, on_click=partial(dialog.submit, answer))
                button.props(f'{look} no-caps data-testid="leave-{answer}"')
    answer = await dialog
    dialog.delete()
    if answer == "save":
        await page.save()
        return document.is_saved
    return answer == "yes"


async def ask(
    page: WindowPage, title: str, words: str, no: str, yes: str, *, name: str, negative: bool = False
) -> bool:
    """Ask a person of this window for a yes or no; a click beside it means no. Negative: something is lost by a yes."""
    look = "unelevated color=negative" if negative else "unelevated"
    with page.whole, ui.dialog() as dialog, ui.card().classes("q-pa-md"):
        show_heading(title, 1)
        ui.label(words).classes("studio-hint")
        with ui.row().classes("w-full justify-end"):
            ui.button(no, on_click=lambda: dialog.submit(False)).props(f'flat no-caps data-testid="{name}-no"')
            ui.button(yes, on_click=lambda: dialog.submit(True)).props(f'{look} no-caps data-testid="{name}-yes"')
    answer = bool(await dialog)
    dialog.delete()
    return answer
