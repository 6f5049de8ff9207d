"""`Links`, `share_dialog`: addresses of a room, to work in it together or only to watch."""

from collections.abc import Callable
from dataclasses import dataclass

from nicegui import ui


@dataclass(frozen=True)
class Links:
    """The two addresses of a room."""

    work: str  # who opens it works in the room
    watch: str  # who opens it sees the robot, and can change nothing


def share_dialog(links: Links) -> Callable[[], object]:
    """Build the dialog with both addresses; returns what opens it."""
    with ui.dialog() as dialog, ui.card().classes("q-pa-md gap-3").style("width: 520px; max-width: 92vw"):
        ui.label("Share this room").classes("studio-title")
        for words, hint, link, name in (
            ("Work together", "People with this link can edit everything.", links.work, "share-work"),
            ("View only", "People with this link see the robot move and cannot edit.", links.watch, "share-watch"),
        ):
            with ui.column().classes("w-full gap-1"):
                ui.label(words).classes("studio-section")
                ui.label(hint).classes("studio-hint")
                box = ui.input(value=link).props(f'readonly dense outlined aria-label="{words}" data-testid="{name}"')
                box.classes("w-full studio-figure").on("focus", js_handler="(event) => event.target.select()")
        with ui.row().classes("w-full justify-end"):
            ui.button("Close", on_click=dialog.close).props("flat no-caps")
    return dialog.open
