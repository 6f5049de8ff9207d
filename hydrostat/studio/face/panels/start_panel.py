"""The panel of the stage "start"."""

from nicegui import ui

from hydrostat.studio.face.page import Page


def start_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("start")
