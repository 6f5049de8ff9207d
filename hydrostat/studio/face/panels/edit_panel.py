"""The panel of the stage "edit"."""

from nicegui import ui

from hydrostat.studio.face.page import Page


def edit_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("edit")
