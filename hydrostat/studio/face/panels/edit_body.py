"""`body_card`: what the body is made of, its elements and its weight."""

from nicegui import ui

from hydrostat.robot import MATERIALS, Source
from hydrostat.robot.gravity import DIRECTIONS, direction_of
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import Page
from hydrostat.studio.face.panels.edit_number import EditNumber
from hydrostat.studio.stage import StageName

OWN = "its own numbers"
"""What a material is called that is not of the table."""


def body_card(page: Page) -> None:
    """Build the card, folded at first."""
    fold = ui.expansion("Body").classes("w-full").props('dense header-class="q-px-none text-weight-bold"')
    with fold.mark("edit-body").style("flex-shrink: 0; font-size: 13px"), ui.column().classes("w-full gap-2"):
        _material(page)
        _lengths(page)
        _gravity(page)
        _outline(page)


def _material(page: Page) -> None:
    editor, document = page.session.editor, page.session.document
    choice = ui.select({}, label="Material").props("dense outlined options-dense").classes("w-full")
    choice.mark("edit-material")
    note = ui.label().classes("studio-hint")
    shown = [""]

    async def send() -> None:
        name = choice.value
        if name in MATERIALS and name != shown[0]:
            await page.act_slowly(lambda: editor.set_body(material=name))
            show()

    def show() -> None:
        material = document.robot.body.material
        shown[0] = material.name if material.name in MATERIALS else OWN
        names = {name: name for name in MATERIALS}
        choice.set_options(names if shown[0] in names else {OWN: OWN, **names}, value=shown[0])
        note.set_text(
            f"{material.young / 1e3:.4g} kPa, Poisson's ratio {material.poisson:g}, {material.density:.4g} kg/m³"
        )

    choice.on_value_change(send)
    page.on(Topic.ROBOT, show)


def _lengths(page: Page) -> None:
    """Element size and thickness, each where the body has one."""
    editor, document = page.session.editor, page.session.document
    boxes: dict[str, EditNumber] = {}

    async def send(field: str, value: float) -> None:
        await page.act_slowly(lambda: editor.set_body(**{field: 1e-3 * value}))
        show()

    def show() -> None:
        for field, box in boxes.items():
            value = getattr(document.robot.body, field)
            if value is not None:
                box.show(1e3 * value)

    body = document.robot.body
    with ui.element("div").classes("studio-row"):
        if body.source is not Source.MESH:
            boxes["element_size"] = EditNumber(
                "Element size", "mm", lambda value: send("element_size", value), mark="edit-element-size"
            )
        if body.thickness is not None:
            boxes["thickness"] = EditNumber(
                "Thickness", "mm", lambda value: send("thickness", value), mark="edit-thickness"
            )
    page.on(Topic.ROBOT, show)


def _gravity(page: Page) -> None:
    editor, document = page.session.editor, page.session.document
    choice = ui.select({}, label="Gravity").props("dense outlined options-dense").classes("w-full")
    choice.mark("edit-gravity")
    words = {"": "none", **{way: f"towards {way}" for way in DIRECTIONS[: 2 * document.robot.body.mesh.dim]}}
    own = "by its components"

    def now() -> str:
        gravity = document.robot.gravity
        return "" if gravity is None else direction_of(gravity) or own

    def send() -> None:
        if choice.value in words and choice.value != now():
            page.act(editor.set_gravity, choice.value)

    def show() -> None:
        choice.set_options(words if now() in words else {own: own, **words}, value=now())

    choice.on_value_change(send)
    page.on(Topic.ROBOT, show)


def _outline(page: Page) -> None:
    """For a body that was drawn: its outline can be drawn anew."""
    starter, document = page.session.starter, page.session.document

    async def draw() -> None:
        body = document.robot.body
        await page.act_slowly(starter.outline_open)
        outlining = starter.outlining
        if outlining is not None and outlining.robot is not None and outlining.robot.body is body:
            page.go(StageName.START)

    button = ui.button("Edit outline", icon="draw", on_click=draw).props("outline no-caps dense padding='4px 12px'")
    button.mark("edit-outline").props('data-testid="edit-outline"')
    page.on(Topic.ROBOT, lambda: button.set_visibility(document.robot.body.outline is not None))
