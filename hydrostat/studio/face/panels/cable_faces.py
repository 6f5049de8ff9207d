"""`face_choice`: on which face of a flat robot its cables run, beside the choices of its kit."""

from nicegui import ui

from hydrostat.robot import CableSide
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage

UNSAID = "Default: front"

FACES = {
    "": UNSAID,
    CableSide.FRONT.value: "Front",
    CableSide.BACK.value: "Back",
    CableSide.PAIRS.value: "Both, in pairs",
    CableSide.MIDDLE.value: "Middle, cast",
}

HINT = "Side of the body that cables run on. Cables on one side curl a stuffed body out of its plane; pairs do not."


def face_choice(page: WindowPage) -> None:
    """Build the choice of the side on which cables of a flat robot run; hidden for a robot in space."""
    document, exporter = page.session.document, page.session.exporter
    with ui.element("div").classes("export-form") as row:
        ui.label("Cable side")
        choice = (
            ui.select(FACES, value="")
            .props("dense outlined options-dense")
            .props('data-testid="cable-face" aria-label="Cable side"')
        )
        choice.tooltip(HINT)

    def show() -> None:
        flat = document.is_open and document.robot.body.mesh.dim == 2
        row.set_visibility(flat)
        choice.set_value((document.robot.face or "") if flat else "")

    def take() -> None:
        if choice.value:
            page.act(lambda: exporter.lay_cables(CableSide(choice.value)))
        else:
            show()  # what is said is not unsaid

    choice.on_value_change(take)
    page.on(Topic.ROBOT, show)
