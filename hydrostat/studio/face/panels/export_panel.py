"""The panel of the stage "export"."""

from nicegui import ui

from hydrostat.studio.face.page import Page


def export_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("export")
