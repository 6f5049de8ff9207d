"""The panel of the stage "start"."""

from pathlib import Path

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import Page
from hydrostat.studio.face.panels.start_draft import draft_view
from hydrostat.studio.face.panels.start_outline import outline_view
from hydrostat.studio.face.panels.start_shelf import shelf_view

STYLE = Path(__file__).parents[1] / "static" / "start.css"

VIEWS = {"shelf": shelf_view, "draft": draft_view, "outline": outline_view}
"""Each builds itself and returns what shows it anew."""


def start_panel(page: Page) -> None:
    """Build the whole page: robots to choose, or what is being made of a file, or an outline that is drawn."""
    starter = page.session.starter
    with page.whole:
        ui.html(f"<style>{STYLE.read_text(encoding='utf-8')}</style>", sanitize=False)
        room = ui.column().classes("start-room")
    shown, refresh = "", lambda: None

    def show() -> None:
        nonlocal shown, refresh
        wanted = "outline" if starter.outlining else "draft" if starter.draft or starter.problem else "shelf"
        if wanted != shown:
            shown = wanted
            room.clear()
            with room:
                refresh = VIEWS[wanted](page)
        refresh()

    starter.get_ready()
    page.on(Topic.JOB, show)
