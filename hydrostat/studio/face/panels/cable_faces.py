"""`face_choice`: on which face of a flat robot its cables run, beside the choices of its kit."""

from nicegui import ui

from hydrostat.robot import Face
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage

UNSAID = "Not said: the front"

FACES = {
    "": UNSAID,
    Face.FRONT.value: "On the front",
    Face.BACK.value: "On the back",
    Face.PAIRS.value: "On both, in pairs",
    Face.MIDDLE.value: "In the middle, cast",
}

HINT = "On one face alone cables also curl a stuffed body out of its plane; in pairs they do not."


def face_choice(page: WindowPage) -> None:
    """Build the choice of the side on which cables of a flat robot run; hidden for a robot in space."""
    document, exporter = page.session.document, page.session.exporter
    with ui.element("div").classes("export-form") as row:
        ui.label("Cables")
        choice = ui.select(FACES, value="").props("dense outlined options-dense").props('data-testid="cable-face"')
        choice.tooltip(HINT)

    def show() -> None:
        flat = document.is_open and document.robot.body.mesh.dim == 2
        row.set_visibility(flat)
        choice.set_value((document.robot.face or "") if flat else "")

    def take() -> None:
        if choice.value:
            page.act(lambda: exporter.lay_cables(Face(choice.value)))
        else:
            show()  # what is said is not unsaid

    choice.on_value_change(take)
    page.on(Topic.ROBOT, show)
