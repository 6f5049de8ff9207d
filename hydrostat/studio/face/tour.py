"""`offer_tour`, `help_dialog`: five steps for who is here for the first time, and the keys."""

from collections.abc import Callable

from nicegui import ui

from hydrostat.studio.face.keys import KEYS
from hydrostat.studio.face.page import Page


def help_dialog() -> Callable[[], None]:
    """Build the page of keys; returns what opens it."""
    with ui.dialog() as dialog, ui.card().classes("q-pa-md").style("min-width: 420px"):
        ui.label("Keys").classes("studio-title")
        with ui.grid(columns="auto 1fr").classes("gap-x-6 gap-y-2"):
            for key, words in KEYS:
                ui.label(key).style("font-weight: 600")
                ui.label(words)
    return dialog.open


def offer_tour(page: Page) -> None:
    """Show the tour if this browser has not seen it."""
