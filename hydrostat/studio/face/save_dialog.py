"""`save_dialog`: where a robot is saved."""

from collections.abc import Callable
from pathlib import Path

from nicegui import ui

from hydrostat.studio.face.page import Page


def save_dialog(page: Page) -> Callable[[], None]:
    """Build the dialog; returns what saves: at once where the robot has a folder, else after asking for one."""
    with ui.dialog() as dialog, ui.card().classes("q-pa-md").style("min-width: 420px"):
        ui.label("Save the robot").classes("studio-title")
        ui.label("A folder with robot.toml and the file of the body.").classes("studio-hint")
        folder = ui.input("Folder").classes("w-full")
        with ui.row().classes("w-full justify-end"):
            ui.button("Cancel", on_click=dialog.close).props("flat no-caps")
            ui.button("Save", on_click=lambda: save()).props("unelevated no-caps")

    async def save() -> None:
        name = (folder.value or "").strip()
        if not name:
            page.tell("name a folder")
            return
        dialog.close()
        await page.act_slowly(page.session.save, Path(name).expanduser())

    async def ask() -> None:
        document = page.session.document
        if document.folder is not None:
            await page.act_slowly(page.session.save)
            return
        folder.set_value(str(Path.cwd() / document.robot.name))
        dialog.open()

    return ask  # type: ignore[return-value]
