"""The panel of the stage "drive"."""

from nicegui import ui

from hydrostat.studio.face.page import Page


def drive_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("drive")
