"""`build_watch`: a page that shows the robot of a room as it moves, and has nothing that would change it."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import HEARTBEAT, WindowPage
from hydrostat.studio.face.toasts import Toasts
from hydrostat.studio.face.tour import STAGES
from hydrostat.studio.face.view_bar import view_bar
from hydrostat.studio.face.viewport import Viewport
from hydrostat.studio.face.window import dress
from hydrostat.studio.session import Session


def build_watch(session: Session, stream: str) -> WindowPage:
    """Build the page of a browser window that watches a session by the path of its stream."""
    page = WindowPage(session, silent=True)
    dress()
    with ui.header().classes("studio-header"):
        ui.label("hydrostat").classes("studio-brand")
        name = ui.label().classes("studio-name")
        ui.space()
        ui.icon("visibility", size="20px").style("color: var(--muted)")
        stage = ui.label().classes("studio-hint").props('data-testid="watching"')
    with ui.element("div").classes("studio-body"):
        room = ui.element("div").classes("studio-work")
    with room, ui.element("div").classes("studio-view"):
        page.viewport = Viewport(stream=stream).classes("studio-viewport")
        view_bar(page, colors=False)
        page.toasts = Toasts()

    def show() -> None:
        document = session.document
        name.set_text(document.robot.name if document.is_open else "")
        stage.set_text(
            f"View only: {STAGES[session.stage].title}" if document.is_open else "View only: no robot is open"
        )

    page.on((Topic.ROBOT, Topic.STAGE), show, lasting=True)
    ui.timer(HEARTBEAT, page.beat)
    return page
