"""Start: what is being made of a file: its picture, its repair report, its numbers."""

from collections.abc import Callable
from typing import Any

from nicegui import ui

from hydrostat.errors import HydrostatError
from hydrostat.robot import MATERIALS
from hydrostat.studio.face.dialogs import may_leave
from hydrostat.studio.face.page import Page
from hydrostat.studio.stage import StageName
from hydrostat.studio.starting.draft import BodyDraft, material_words, young_words
from hydrostat.studio.starting.sketch import Sketch

FINENESS = {True: (120, 250, 600), False: (400, 900, 2500)}
"""Nodes of a coarse, a medium and a fine body, flat or not."""


def draft_view(page: Page) -> Callable[[], None]:
    """Build it; returns what shows it anew."""
    starter = page.session.starter
    with ui.row().classes("items-center no-wrap w-full gap-3"):
        ui.button(icon="arrow_back", on_click=page.doing(starter.drop)).props('flat round aria-label="Back"').mark(
            "back"
        )
        title = ui.label().classes("start-title")
    with ui.element("div").classes("start-split"):
        with ui.column().classes("w-full gap-4"):
            show_state = _state(page)
            show_pictures = _pictures()
        with ui.element("div").classes("start-card"):
            show_fields = _fields(page)

    def refresh() -> None:
        draft = starter.draft
        title.set_text("" if draft is None else draft.file)
        show_state()
        show_pictures(starter.sketch)
        if draft is not None:
            show_fields(draft, starter.sketch)

    return refresh


def _state(page: Page) -> Callable[[], None]:
    """How far it is, or why it cannot be."""
    starter, jobs = page.session.starter, page.session.jobs
    with ui.element("div").classes("start-card") as busy, ui.row().classes("items-center w-full no-wrap"):
        ui.spinner(size="20px")
        stage = ui.label()
        ui.space()
        ui.button("Stop", on_click=page.doing(starter.stop)).props("flat no-caps dense padding='2px 12px'")
    with ui.element("div").classes("start-card") as wrong, ui.element("div").classes("start-problem"):
        ui.icon("error_outline").classes("text-lg")
        problem = ui.label().props('data-testid="problem"')

    def refresh() -> None:
        busy.set_visibility(starter.meshing)
        words = jobs.state.stage if jobs.state is not None else ""
        stage.set_text({"starting": "Reading ..."}.get(words, f"{words.capitalize()} ..."))
        wrong.set_visibility(bool(starter.problem))
        problem.set_text(starter.problem)

    return refresh


def _pictures() -> Callable[[Sketch | None], None]:
    """The robot at rest, and what was mended."""
    with ui.element("div").classes("start-card") as card:
        words = ui.label().classes("start-small studio-figure").props('data-testid="sketch-words"')
        picture = ui.html("", sanitize=False).classes("start-figure")
    with ui.element("div").classes("start-card") as report:
        head = ui.label().classes("start-head").props('data-testid="report-head"')
        lines = ui.column().classes("gap-1 w-full")
        repair = ui.html("", sanitize=False).classes("start-figure")
    shown: Sketch | None = None

    def refresh(sketch: Sketch | None) -> None:
        nonlocal shown
        card.set_visibility(sketch is not None)
        report.set_visibility(sketch is not None and bool(sketch.lines))
        if sketch is None or sketch is shown:
            shown = sketch
            return
        if shown is None or shown.picture != sketch.picture:
            picture.set_content(sketch.picture)
            repair.set_content(sketch.repair)
        shown = sketch
        mesh = sketch.robot.body.mesh
        kind = "triangles" if mesh.dim == 2 else "tetrahedra"
        words.set_text(f"{1e3 * mesh.size:.0f} mm, {len(mesh.nodes)} nodes, {len(mesh.elements)} {kind}")
        head.set_text("Nothing had to be mended" if sketch.clean else "What was found and done")
        lines.clear()
        with lines:
            for line in sketch.lines:
                _line(line)

    return refresh


def _line(words: str) -> None:
    icons = {
        "found": "search",
        "done": "build",
        "removed": "content_cut",
        "volume": "straighten",
        "largest": "straighten",
    }
    with ui.element("div").classes("start-line"):
        ui.icon(icons.get(words.split(":")[0].split(" ")[0], "info"))
        ui.label(words)


def _fields(page: Page) -> Callable[[BodyDraft, Sketch | None], None]:
    """Numbers and material, and the button that makes the robot."""
    starter = page.session.starter

    def ask(**changes: Any) -> None:
        try:
            starter.revise(**changes)
            wrong.set_text("")
        except HydrostatError as error:
            wrong.set_text(str(error))
        make.set_enabled(not wrong.text and starter.is_current and not starter.meshing)

    with ui.element("div").classes("start-fields"):
        name = ui.input("Name", on_change=lambda event: ask(name=str(event.value or ""))).props(
            "outlined dense debounce=500"
        )
        size = _Length("Longest side", lambda value: ask(size=value), "size")
        kind = ui.toggle({"flat": "Flat", "round": "Blown up"}).props("no-caps spread unelevated").classes("w-full")
        thick = _Length("Thickness", lambda value: ask(**{_thick_key(starter.draft): value}), "thickness")
        fine = ui.toggle(["Coarse", "Medium", "Fine"]).props("no-caps spread unelevated").classes("w-full")
        element = _Length("Element size", lambda value: ask(element_size=value, nodes=None), "element-size")
        options = {key: f"{key}, {young_words(found)}" for key, found in MATERIALS.items()}
        material = (
            ui.select(options, label="Material", with_input=False)
            .props("outlined dense")
            .props('data-testid="material"')
        )
        words = ui.label().classes("start-small")
        wrong = ui.label().classes("start-problem").props('data-testid="wrong-number"')
        wrong.bind_visibility_from(wrong, "text", bool)
        make = (
            ui.button("Make robot", icon="check").props("unelevated no-caps size=md").props('data-testid="make-robot"')
        )

    def choose(kind_name: str) -> None:
        draft = starter.draft
        if draft is None or kind_name == ("flat" if draft.inflate is None else "round"):
            return
        thickness = 0.04 if starter.sketch is None else 0.25 * starter.sketch.robot.body.mesh.size
        ask(inflate=None if kind_name == "flat" else round(thickness, 3), thickness=None, element_size=None, nodes=None)

    def refine(level: str) -> None:
        draft = starter.draft
        if draft is not None and level:
            flat = draft.is_drawing and draft.inflate is None
            ask(nodes=FINENESS[flat][("Coarse", "Medium", "Fine").index(level)], element_size=None)

    async def begin() -> None:
        if await may_leave(page):
            serial = page.session.document.serial
            page.act(starter.make)
            if page.session.document.serial != serial:
                page.go(StageName.POSE)

    kind.on_value_change(lambda event: choose(str(event.value)))
    fine.on("update:model-value", lambda: refine(str(fine.value)))
    material.on_value_change(lambda event: ask(material=str(event.value)))
    make.on_click(begin)

    def refresh(draft: BodyDraft, sketch: Sketch | None) -> None:
        flat = draft.is_drawing and draft.inflate is None
        _quietly(name, draft.name)
        kind.set_visibility(draft.is_drawing)
        _quietly(kind, "flat" if flat else "round")
        thick.set_visibility(draft.is_drawing)
        _quietly(material, draft.material)
        words.set_text(material_words(MATERIALS[draft.material]))
        make.set_enabled(not wrong.text and starter.is_current and not starter.meshing)
        fine.set_value(_level(draft, flat))
        body = None if sketch is None else sketch.robot.body
        size.show(draft.size or (None if body is None else body.mesh.size))
        thick.show((draft.thickness if flat else draft.inflate) or (None if body is None else body.thickness))
        element.show(draft.element_size or (None if body is None else body.element_size))

    return refresh


def _level(draft: BodyDraft, flat: bool) -> str | None:
    """Which fineness was asked for."""
    if draft.element_size is not None or (draft.nodes is not None and draft.nodes not in FINENESS[flat]):
        return None
    return ("Coarse", "Medium", "Fine")[1 if draft.nodes is None else FINENESS[flat].index(draft.nodes)]


def _thick_key(draft: BodyDraft | None) -> str:
    return "inflate" if draft is not None and draft.inflate is not None else "thickness"


def _quietly(control: Any, value: Any) -> None:
    """Show a value where it is another; what is asked for then is what is there already."""
    if control.value != value:
        control.set_value(value)


class _Length:
    """A length that a person reads and types in millimetres."""

    def __init__(self, label: str, ask: Callable[[float], None], mark: str) -> None:
        self._ask, self._shown = ask, None
        self._field = (
            ui.number(label, suffix="mm", format="%.4g")
            .props("outlined dense debounce=700")
            .props(f'data-testid="{mark}"')
        )
        self._field.on_value_change(lambda event: self._typed(event.value))

    def show(self, value: float | None) -> None:
        """Show a length [m]."""
        self._shown = None if value is None else float(f"{1e3 * value:.4g}")
        if self._field.value != self._shown:
            self._field.set_value(self._shown)

    def set_visibility(self, visible: bool) -> None:
        self._field.set_visibility(visible)

    def _typed(self, value: float | None) -> None:
        if value is not None and value != self._shown:
            self._ask(1e-3 * value)
