"""The panel of the stage "design"."""

from nicegui import ui

from hydrostat.studio.face.page import Page


def design_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("design")
