"""Start: what is being made of a file: its picture, its repair report, its numbers."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

from nicegui import events, ui

from hydrostat.errors import HydrostatError, InputError, in_words
from hydrostat.geometry import Inner
from hydrostat.robot import MATERIALS, get_material, own_materials
from hydrostat.studio.face.dialogs import may_leave
from hydrostat.studio.face.messages import sent_number
from hydrostat.studio.face.page import WindowPage, show_heading
from hydrostat.studio.skins import SewnSkin
from hydrostat.studio.stage import StageName
from hydrostat.studio.starting.draft import SMOOTHINGS, THRESHOLDS, BodyDraft, PhotoReading, material_words
from hydrostat.studio.starting.photo import overlay
from hydrostat.studio.starting.sketch import PartChoice, Sketch

LEVELS = ("Coarse", "Medium", "Fine")
ICONS = {
    "found": "search",
    "done": "build",
    "removed": "content_cut",
    "volume": "straighten",
    "largest": "straighten",
    "cannot": "block",
}
FINENESS = {True: (120, 250, 600), False: (400, 900, 2500)}  # nodes of a coarse, a medium and a fine body, flat or not


def draft_view(page: WindowPage) -> Callable[[], None]:
    """Build it; returns what shows it again."""
    starter = page.session.starter
    with ui.row().classes("items-center no-wrap w-full gap-3"):
        back = ui.button(icon="arrow_back", on_click=page.doing(starter.drop)).mark("back")
        back.props('flat round aria-label="Back"')
        title = show_heading("", 1).classes("start-title", remove="studio-title")
    with ui.element("div").classes("start-split"):
        with ui.column().classes("w-full gap-4"):
            show_state = _state(page)
            show_parts = _parts(page)
            show_photo = _photo(page)
            show_pictures, show_skin = _pictures(), _skin()
        with ui.element("div").classes("start-card"):
            fields = _Fields(page)

    def refresh() -> None:
        draft = starter.draft
        title.set_text("" if draft is None else draft.file)
        show_state()
        show_parts()
        show_photo()
        show_pictures(starter.sketch)
        show_skin(starter.skin)
        if draft is not None:
            fields.show(draft, starter.sketch)

    return refresh


def _state(page: WindowPage) -> Callable[[], None]:
    """Build the progress of meshing, or the reason why it failed."""
    starter, jobs = page.session.starter, page.session.jobs
    with ui.element("div").classes("start-card") as busy, ui.row().classes("items-center w-full no-wrap"):
        ui.spinner(size="20px")
        stage = ui.label().props("role=status")
        ui.space()
        ui.button("Stop", on_click=page.doing(starter.stop)).props("flat no-caps dense padding='2px 12px'")
    with ui.element("div").classes("start-card") as wrong, ui.element("div").classes("start-problem"):
        ui.icon("error_outline").classes("text-lg")
        problem = ui.label().props('data-testid="problem" role="alert"')

    def refresh() -> None:
        busy.set_visibility(starter.is_meshing)
        words = jobs.state.stage if jobs.state is not None else ""
        stage.set_text({"starting": "Reading…"}.get(words, f"{words[:1].upper()}{words[1:]}…"))
        wrong.set_visibility(bool(starter.problem))
        problem.set_text(starter.problem)

    return refresh


def _parts(page: WindowPage) -> Callable[[], None]:
    """Build the picture of the shapes that may be the body; a click chooses one."""
    starter = page.session.starter
    with ui.element("div").classes("start-card") as card:
        ui.label("Click the shape that is the body").classes("start-head")
        view = ui.html("", sanitize=False).classes("start-parts").props('data-testid="parts"')
        with ui.row().classes("gap-2") as buttons:
            pass
    shown: tuple[PartChoice | None, int | None] = (None, None)

    def choose(part: int) -> None:
        page.act(lambda: starter.revise(part=part))

    def choose_clicked(event: events.GenericEventArguments) -> None:
        part = sent_number(event.args)
        if part is not None and starter.choice is not None and part in starter.choice.rings:
            choose(int(part))

    view.on("click", choose_clicked, js_handler=_CLICKED_PART)

    def refresh() -> None:
        nonlocal shown
        choice, draft = starter.choice, starter.draft
        card.set_visibility(choice is not None)
        now = (choice, None if draft is None else draft.part)
        if choice is None or now == shown:
            return
        shown = now
        view.set_content(choice.picture(now[1]))
        buttons.clear()
        with buttons:
            for number in choice.rings:
                button = ui.button(f"Shape {number}", on_click=partial(choose, number))
                button.props(f"no-caps dense padding='2px 12px' {'unelevated' if number == now[1] else 'outline'}")

    return refresh


_CLICKED_PART = """(event) => {
    const part = event.target.closest('[data-part]');
    if (part) emit(Number(part.dataset.part));
}"""


def _photo(page: WindowPage) -> Callable[[], None]:
    """The outline over the picture that it was read from, and how it is read."""
    starter = page.session.starter
    with ui.element("div").classes("start-card") as card:
        with ui.element("div").classes("studio-row"):
            ui.label("Outline on the picture").classes("start-head")
            ui.space()
            correct = ui.button("Edit outline", icon="draw", on_click=page.doing_slowly(starter.outline_correct))
            correct.props("outline no-caps dense padding='4px 12px' data-testid=\"outline-correct\"")
        view = ui.html("", sanitize=False).classes("start-photo")
        threshold = _Reading(page, "threshold", "Background threshold (0–441)", THRESHOLDS)
        smoothing = _Reading(page, "smoothing", "Edge smoothing", SMOOTHINGS)
    shown: Sketch | None = None

    def refresh() -> None:
        nonlocal shown
        draft, sketch = starter.draft, starter.sketch
        card.set_visibility(draft is not None and draft.is_picture)
        correct.set_enabled(starter.is_current and sketch is not None and sketch.behind is not None)
        if draft is None or not draft.is_picture:
            return
        threshold.show(draft.reading)
        smoothing.show(draft.reading)
        if sketch is not shown:
            shown = sketch
            behind = None if sketch is None else sketch.behind
            outline = None if sketch is None else sketch.robot.body.outline
            view.set_content("" if behind is None or outline is None else overlay(behind, outline))

    return refresh


class _Reading:
    """A slider for one number of how a picture is read, and a button that leaves it to the program."""

    def __init__(self, page: WindowPage, key: str, words: str, ends: tuple[float, float]) -> None:
        self._page, self._key, self._words = page, key, words
        with ui.element("div").classes("w-full"):
            with ui.element("div").classes("studio-row").style("min-height: 30px"):
                self._label = ui.label().classes("start-small studio-figure")
                ui.space()
                self._auto = ui.button("Auto", on_click=lambda: self._ask(None if key == "threshold" else 0.0))
                self._auto.props("flat no-caps dense size=sm")
            self._slider = ui.slider(min=ends[0], max=ends[1], step=1.0, value=ends[0])
            self._slider.props(f'aria-label="{words}"').mark(f"reading-{key}")
        self._slider.on("change", lambda event: self._ask(sent_number(event.args)), args=[None])

    def show(self, reading: PhotoReading) -> None:
        """Show what is asked for."""
        value = getattr(reading, self._key)
        found = value is None or (self._key == "smoothing" and value == 0)
        self._auto.set_visibility(not found)
        unit = " px" if self._key == "smoothing" else ""
        self._label.set_text(f"{self._words}: {'auto' if found else f'{value:g}{unit}'}")
        self._slider.set_value(60.0 if value is None else value)

    def _ask(self, value: float | None) -> None:
        starter = self._page.session.starter
        if starter.draft is not None:
            reading = replace(starter.draft.reading, **{self._key: value})
            self._page.act(lambda: starter.revise(reading=reading))


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
        words.set_text(f"{1e3 * mesh.size:.0f} mm, {mesh.describe()}")
        head.set_text("No repairs needed" if sketch.clean else "Repairs")
        lines.clear()
        with lines:
            for line in sketch.lines:
                _line(line)

    return refresh


def _skin() -> Callable[[SewnSkin | None], None]:
    """Build the card on the skin of a body in space: its sewing, or why it cannot be sewn."""
    with ui.element("div").classes("start-card") as card:
        ui.label("Skin pattern").classes("start-head")
        lines = ui.column().classes("gap-1 w-full").props('data-testid="sewing"')
    shown: SewnSkin | None = None

    def refresh(skin: SewnSkin | None) -> None:
        nonlocal shown
        card.set_visibility(skin is not None)
        if skin is None or skin is shown:
            return
        shown = skin
        lines.clear()
        with lines:
            if skin.words:
                _line(skin.words[0].upper() + skin.words[1:])
            for finding in skin.findings:
                _line(f"cannot be built: {in_words(finding.text)}")

    return refresh


def _line(words: str) -> None:
    with ui.element("div").classes("start-line"):
        ui.icon(ICONS.get(words.split(":")[0].split(" ")[0], "info"))
        ui.label(words)


class _Fields:
    """Numbers and material, and the button that makes the robot."""

    def __init__(self, page: WindowPage) -> None:
        self._page, self._starter = page, page.session.starter
        spread = "no-caps spread unelevated role=group"
        materials = {key: f"{key}, {found.young_text}" for key, found in MATERIALS.items()}
        with suppress(InputError):  # a file of own materials that is wrong
            materials |= {key: f"{key}, {found.young_text}" for key, found in own_materials().items()}
        with ui.element("div").classes("start-fields"):
            self._name = ui.input("Name").props("outlined dense debounce=500")
            self._size = _Length("Longest side", lambda value: self._ask(size=value), "size")
            self._kind = (
                ui.toggle({"flat": "Flat", "round": "Inflated"}).props(f'{spread} aria-label="Form"').classes("w-full")
            )
            self._thick = _Length("Thickness", self._thicken, "thickness")
            with ui.element("div").classes("w-full") as self._within:
                ui.label("Shapes inside the outline").classes("start-small")
                self._inner = ui.toggle({Inner.HOLES: "Holes", Inner.DRAWN: "Surface lines"}).props(
                    f'{spread} aria-label="Inside"'
                )
                self._inner.classes("w-full").props('data-testid="inner"')
            self._fine = ui.toggle(list(LEVELS)).props(f'{spread} aria-label="Mesh"').classes("w-full")
            self._element = _Length(
                "Element size", lambda value: self._ask(element_size=value, nodes=None), "element-size"
            )
            self._material = ui.select(materials, label="Material").props('outlined dense data-testid="material"')
            self._words = ui.label().classes("start-small")
            self._wrong = ui.label().classes("start-problem").props('data-testid="wrong-number"')
            self._wrong.bind_visibility_from(self._wrong, "text", bool)
            self._make = ui.button("Make robot", icon="check", on_click=self._begin)
            self._make.props('unelevated no-caps size=md data-testid="make-robot"')
        self._name.on_value_change(lambda event: self._ask(name=str(event.value or "")))
        self._kind.on_value_change(lambda event: self._choose(str(event.value)))
        self._inner.on("update:model-value", lambda: self._ask(inner=Inner(str(self._inner.value))))
        self._fine.on("update:model-value", lambda: self._refine(str(self._fine.value)))
        self._material.on_value_change(lambda event: self._ask(material=str(event.value)))

    def show(self, draft: BodyDraft, sketch: Sketch | None) -> None:
        """Show what is asked for, and where nothing is, what came of it."""
        flat = _is_flat(draft)
        self._name.set_value(draft.name)
        self._kind.set_visibility(draft.is_drawing)
        self._kind.set_value("flat" if flat else "round")
        self._thick.set_visibility(draft.is_drawing)
        self._within.set_visibility(draft.is_drawing)
        self._inner.set_value(draft.inner)
        self._material.set_value(draft.material)
        self._words.set_text(material_words(get_material(draft.material)))
        self._enable()
        self._fine.set_value(_level(draft, flat))
        body = None if sketch is None else sketch.robot.body
        self._size.show(draft.size or (None if body is None else body.mesh.size))
        self._thick.show((draft.thickness if flat else draft.inflate) or (None if body is None else body.thickness))
        self._element.show(draft.element_size or (None if body is None else body.element_size))

    def _ask(self, **changes: Any) -> None:
        try:
            self._starter.revise(**changes)
            self._wrong.set_text("")
        except HydrostatError as error:
            self._wrong.set_text(str(error))
        self._enable()

    def _enable(self) -> None:
        ready = self._starter.is_current and not self._starter.is_meshing
        self._make.set_enabled(not self._wrong.text and ready)

    def _thicken(self, value: float) -> None:
        draft = self._starter.draft
        self._ask(**{"inflate" if draft is not None and draft.inflate is not None else "thickness": value})

    def _choose(self, kind: str) -> None:
        draft, sketch = self._starter.draft, self._starter.sketch
        if draft is not None and draft.is_drawing and kind != ("flat" if draft.inflate is None else "round"):
            thickness = 0.04 if sketch is None else 0.25 * sketch.robot.body.mesh.size
            inflate = None if kind == "flat" else round(thickness, 3)
            self._ask(inflate=inflate, thickness=None, element_size=None, nodes=None)

    def _refine(self, level: str) -> None:
        draft = self._starter.draft
        if draft is not None and level in LEVELS:
            self._ask(nodes=FINENESS[_is_flat(draft)][LEVELS.index(level)], element_size=None)

    async def _begin(self) -> None:
        if await may_leave(self._page):
            serial = self._page.session.document.serial
            self._page.act(self._starter.make)
            if self._page.session.document.serial != serial:
                self._page.go(StageName.POSE)


def _is_flat(draft: BodyDraft) -> bool:
    return draft.is_drawing and draft.inflate is None


def _level(draft: BodyDraft, flat: bool) -> str | None:
    """Return the mesh fineness that the draft asks for; None for a size of its own."""
    if draft.element_size is not None or (draft.nodes is not None and draft.nodes not in FINENESS[flat]):
        return None
    return LEVELS[1 if draft.nodes is None else FINENESS[flat].index(draft.nodes)]


class _Length:
    """A length that a person reads and types in millimeters."""

    def __init__(self, label: str, ask: Callable[[float], None], mark: str) -> None:
        self._ask, self._shown = ask, None
        self._field = ui.number(label, suffix="mm", format="%.4g")
        self._field.props(f'outlined dense debounce=700 data-testid="{mark}"')
        self._field.on_value_change(lambda event: self._on_typed(event.value))

    def show(self, value: float | None) -> None:
        """Show a length [m]."""
        self._shown = None if value is None else float(f"{1e3 * value:.4g}")
        self._field.set_value(self._shown)

    def set_visibility(self, visible: bool) -> None:
        self._field.set_visibility(visible)

    def _on_typed(self, value: float | None) -> None:
        if value is not None and value != self._shown:
            self._ask(1e-3 * value)
