"""`body_card`, `check_card`: what the body is made of, and what the check says of the robot."""

from collections.abc import Callable
from functools import partial

from nicegui import ui

from hydrostat.robot import DIRECTIONS, MATERIALS, Source, direction_of
from hydrostat.simulation import ContactPatch
from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.tools import Findings
from hydrostat.studio.face.page import WindowPage, show_heading
from hydrostat.studio.face.panels.edit_part import EditNumber
from hydrostat.studio.face.panels.finding_list import finding_list
from hydrostat.studio.stage import StageName
from hydrostat.studio.view.scene_items import RobotShape
from hydrostat.units import plural


def contact_switch(page: WindowPage, mark: str) -> None:
    """Build the switch, found under a mark; obstacles are written into robot.toml."""
    editor, document = page.session.editor, page.session.document
    switch = ui.switch("Self-contact").mark(mark)
    switch.tooltip("The body cannot pass through itself. Solving takes longer. Add obstacles in robot.toml.")

    def send() -> None:
        if switch.value != (document.robot.contact is not None):
            page.act(editor.set_contact, switch.value)

    def show() -> None:
        switch.set_value(document.robot.contact is not None)

    switch.on_value_change(send)
    page.on(Topic.ROBOT, show)


def touch_label(page: WindowPage, shape: Callable[[], RobotShape], mark: str) -> None:
    """Build the line that says what the body touches, and how hard; found under a mark."""
    label = ui.label().classes("studio-hint").mark(mark)

    def show() -> None:
        words = ContactPatch.describe_all(shape().touches)
        label.set_text(f"{words[:1].upper()}{words[1:]}")
        label.set_visibility(bool(words))

    page.on((Topic.ROBOT, Topic.SHAPE), show)


OWN = "custom"  # what a material is called that is not of the table


def body_card(page: WindowPage) -> None:
    """Build the card, folded at first."""
    fold = ui.expansion("Body").classes("w-full").props('dense header-class="q-px-none text-weight-bold"')
    with fold.mark("edit-body").style("flex-shrink: 0; font-size: 13px"), ui.column().classes("w-full gap-2"):
        _material(page)
        _lengths(page)
        _gravity(page)
        contact_switch(page, "edit-contact")
        _outline(page)


def _material(page: WindowPage) -> None:
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
        numbers = f"Poisson's ratio {material.poisson:g}, {material.density:.4g} kg/m³"
        note.set_text(f"{material.young / 1e3:.4g} kPa, {numbers}")

    choice.on_value_change(send)
    page.on(Topic.ROBOT, show)


def _lengths(page: WindowPage) -> None:
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
    fields = ["element_size"] * (body.source is not Source.MESH) + ["thickness"] * (body.thickness is not None)
    with ui.element("div").classes("studio-row"):
        for field in fields:
            words = field.replace("_", " ").capitalize()
            boxes[field] = EditNumber(words, "mm", partial(send, field), mark=f"edit-{field.replace('_', '-')}")
    page.on(Topic.ROBOT, show)


def _gravity(page: WindowPage) -> None:
    editor, document = page.session.editor, page.session.document
    choice = ui.select({}, label="Gravity").props("dense outlined options-dense").classes("w-full")
    choice.mark("edit-gravity")
    words = {"": "none", **{way: f"along {way}" for way in DIRECTIONS[: 2 * document.robot.body.mesh.dim]}}
    own = "custom"

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


def _outline(page: WindowPage) -> None:
    """For a body that was drawn: its outline can be drawn again."""
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


def check_card(page: WindowPage) -> None:
    """Build the card."""
    editor, document = page.session.editor, page.session.document
    show_heading("Check")
    with ui.column().classes("studio-card").style("gap: 6px; flex-shrink: 0").mark("edit-check"):
        counts = ui.column().classes("w-full").style("gap: 6px")
        finding_list(page, lambda: document.robot)

    def build() -> None:
        if editor.findings is not None:
            _tell_counts(editor.findings)

    page.on_new((Topic.JOB, Topic.ROBOT), lambda: editor.findings, counts, build)


def _tell_counts(findings: Findings) -> None:
    length = f"{plural(findings.cables, 'cable')}, {1e3 * findings.cable_length:.0f} mm in all"
    for line in (
        f"{findings.nodes} nodes, {findings.elements} {findings.kind}, {1e3 * findings.mass:.3g} g",
        length if findings.cables else "no cables yet",
    ):
        ui.label(line).classes("studio-hint studio-figure")
