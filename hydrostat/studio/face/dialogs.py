"""`save_dialog`, `may_leave`: questions asked before something is lost."""

from collections.abc import Callable
from pathlib import Path

from nicegui import ui

from hydrostat.studio.face.page import WindowPage
from hydrostat.studio.work_folder import doubts


def save_dialog(page: WindowPage) -> Callable[[], None]:
    """Build the dialogs; returns what saves: at once where nothing can be lost by it, else after asking."""
    document = page.session.document
    with ui.dialog() as dialog, ui.card().classes("q-pa-md").style("min-width: 420px"):
        ui.label("Save the robot").classes("studio-title")
        ui.label("A folder with robot.toml and the file of the body.").classes("studio-hint")
        folder = ui.input("Folder").classes("w-full").mark("save-folder")
        with ui.row().classes("w-full justify-end"):
            ui.button("Cancel", on_click=dialog.close).props("flat no-caps")
            ui.button("Save", on_click=lambda: save()).props("unelevated no-caps").mark("save-now")
    sure = _Sure()

    async def save() -> None:
        name = (folder.value or "").strip()
        if not name:
            page.tell("name a folder")
            return
        dialog.close()
        await save_in(Path(name).expanduser())

    async def save_in(goal: Path) -> None:
        same = document.folder is not None and goal.resolve() == document.folder.resolve()
        told = await page.act_slowly(doubts, document.work, goal, document.stamp if same else "")
        if told is None:
            return
        answer = await sure.ask(told) if told else "save"
        if answer == "save":
            await page.act_slowly(page.session.save, goal)
        elif answer == "elsewhere":
            ask_where()

    def ask_where() -> None:
        folder.set_value(str(document.folder or Path.cwd() / document.robot.name))
        dialog.open()

    async def ask() -> None:
        if document.folder is None:
            ask_where()
        else:
            await save_in(document.folder)

    return ask  # type: ignore[return-value]


class _Sure:
    """Tells what would be lost, and asks whether it may be."""

    def __init__(self) -> None:
        with ui.dialog() as self._dialog, ui.card().classes("q-pa-md").style("width: 480px"):
            ui.label("Save over what is there?").classes("studio-title")
            self._words = ui.column().classes("w-full gap-2")
            with ui.row().classes("w-full justify-end"):
                self._button("Cancel", "", "flat").mark("save-cancel")
                self._button("Save elsewhere", "elsewhere", "flat").mark("save-elsewhere")
                self._button("Save over it", "save", "unelevated color=negative").mark("save-over")

    async def ask(self, told: list[str]) -> str:
        """What a person chooses: "save", "elsewhere", or "" to leave all as it is."""
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
    """Ask if there is work that is not saved; what the person says."""
    document = page.session.document
    if document.saved:
        return True
    title, words = f"{document.robot.name} is not saved", "Another robot takes its place, and what was changed is lost."
    return await ask(page, title, words, "Go back", "Throw the changes away", name="leave", negative=True)


async def ask(
    page: WindowPage, title: str, words: str, no: str, yes: str, *, name: str, negative: bool = False
) -> bool:
    """Ask a person of this window for a yes or no; a click beside it means no. Negative: something is lost by a yes."""
    look = "unelevated color=negative" if negative else "unelevated"
    with page.whole, ui.dialog() as dialog, ui.card().classes("q-pa-md"):
        ui.label(title).classes("studio-title")
        ui.label(words).classes("studio-hint")
        with ui.row().classes("w-full justify-end"):
            ui.button(no, on_click=lambda: dialog.submit(False)).props(f'flat no-caps data-testid="{name}-no"')
            ui.button(yes, on_click=lambda: dialog.submit(True)).props(f'{look} no-caps data-testid="{name}-yes"')
    answer = bool(await dialog)
    dialog.delete()
    return answer
