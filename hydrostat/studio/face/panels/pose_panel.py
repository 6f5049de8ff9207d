"""The panel of the stage "pose"."""

from nicegui import ui

from hydrostat.studio.face.page import Page


def pose_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("pose")
