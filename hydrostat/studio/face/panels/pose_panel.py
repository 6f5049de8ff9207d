"""The panel of the stage "pose": what moves the body, what is held, what winches do, poses, what a marker can reach."""

from nicegui import ui

from hydrostat.drawing import Color
from hydrostat.project import fresh_name
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.elements import winch_badge
from hydrostat.studio.face.page import WindowPage, icon_button, pressable, show_heading
from hydrostat.studio.face.panels.edit_body import contact_switch, touch_label
from hydrostat.studio.face.panels.motors_card import motors_card
from hydrostat.studio.face.panels.photographs_card import photographs_card
from hydrostat.studio.face.panels.proposals_card import proposals_card
from hydrostat.studio.posing import Mode, same_as
from hydrostat.studio.stage import format_error
from hydrostat.studio.view.coloring import Coloring
from hydrostat.studio.view.robot_items import Bar
from hydrostat.studio.view.scene_items import RobotShape
from hydrostat.units import plural


def muscles_card(page: WindowPage) -> None:
    """Build the switch; with cables there is none."""
    session, poser = page.session, page.session.poser
    with ui.column().classes("w-full").style("gap: 6px") as room:
        show_heading("Muscles")
        colors = ui.switch("Show muscle activation").props("dense").style("font-size: 13px").mark("pose-colors")

    def color(on: bool) -> None:
        if on != (session.coloring is Coloring.MUSCLES):
            page.act(session.color_by, Coloring.MUSCLES if on else Coloring.FELT)

    def show() -> None:
        room.set_visibility(poser.mode is Mode.MUSCLES)
        colors.set_value(session.coloring is Coloring.MUSCLES)

    colors.on_value_change(lambda event: color(bool(event.value)))
    page.on((Topic.SCENE, Topic.ROBOT), show)


MODES = {Mode.CABLES: "Cables", Mode.MUSCLES: "Muscles"}

HINTS = {
    Mode.CABLES: "Drag a marker or any point of the body. The winches follow by inverse kinematics.",
    Mode.MUSCLES: "Drag a marker or any point of the body. The body follows as if it were full of muscle.",
}


def pose_panel(page: WindowPage) -> None:
    """Build the panel."""
    poser = page.session.poser
    with ui.element("div").classes("studio-row"):
        show_heading("Pose", 1)
        ui.space()
        rest = ui.button("Rest", icon="restart_alt", on_click=page.doing(poser.rest), color=None)
        rest.props("flat dense no-caps").style("color: var(--accent)")
        rest.tooltip("Clear targets and release all cables (R)").mark("pose-rest")
    choice = ui.toggle(MODES, value=poser.mode).props("spread no-caps unelevated toggle-color=primary")
    choice.classes("w-full").style("flex: none; border-radius: 10px; overflow: hidden; border: 1px solid var(--line)")
    choice.mark("pose-mode").props('role="group" aria-label="Moved by"')
    hint = ui.label().classes("studio-hint").style("min-height: 38px")

    def choose() -> None:
        if choice.value is not poser.mode:
            page.act(poser.set_mode, choice.value)
            choice.set_value(poser.mode)

    def show() -> None:
        choice.set_value(poser.mode)
        hint.set_text("Click the target position." if poser.is_armed else HINTS[poser.mode])

    choice.on_value_change(choose)
    page.on(Topic.SCENE, show)
    held_card(page)
    bars_card(page)
    contact_switch(page, "pose-contact")
    touch_label(page, poser.shape, "pose-touches")
    motors_card(page)
    muscles_card(page)
    proposals_card(page)
    poses_card(page)
    reach_card(page)
    photographs_card(page)


TARGET_TOLERANCE = 5e-4  # a marker so near to its target is there [m]


def held_card(page: WindowPage) -> None:
    """Build the list."""
    poser = page.session.poser
    with ui.element("div").classes("studio-card"):
        empty = ui.label("No targets yet. Drag a point, or select a marker and press arrow keys.").classes(
            "studio-hint"
        )
        rows = ui.column().classes("w-full").style("gap: 2px")
        told = ui.label().classes("studio-hint studio-figure").style("margin-top: 6px").mark("pose-prediction")
        notes = ui.label().classes("studio-hint").style("white-space: pre-line; margin-top: 6px").mark("pose-notes")
        notes.props("role=status")
    shown: list[_PointRow] = []

    def list_points() -> tuple[str, ...]:
        markers = [marker.name for marker in page.session.document.robot.markers]
        return *markers, *(name for name in poser.held_points if name not in markers)

    def build() -> None:
        shown[:] = [_PointRow(page, name) for name in list_points()]

    def show() -> None:
        shape = poser.shape()
        empty.set_visibility(not poser.held_points)
        for row in shown:
            row.show(
                shape.errors.get(row.name), held=row.name in poser.held_points, chosen=row.name == poser.chosen_name
            )
        told.set_text(prediction_words(shape))
        told.set_visibility(shape.prediction is not None)
        words = "\n".join(f"{note[:1].upper()}{note[1:]}" for note in shape.notes)
        notes.set_text(words)
        notes.set_visibility(bool(words))

    page.on_new((Topic.SCENE, Topic.SHAPE), list_points, rows, build)
    page.on((Topic.SCENE, Topic.SHAPE), show)


def prediction_words(shape: RobotShape) -> str:
    """State of the shown answer and the networks' predicted error [mm], in words; "" without networks."""
    told = shape.prediction
    if told is None:
        return ""
    known = f"predicted error {format_error(told.error)} ± {format_error(told.uncertainty)}"
    left = format_error(sum(shape.errors.values()) / max(len(shape.errors), 1))
    if told.exact:
        return f"Exact: mean error {left}. Surrogate model: {known}."
    return f"Dots by surrogate model: {known}. Exact solve in progress: mean error {left}."


class _PointRow:
    """A marker or held point: pressed, it is chosen, and arrow keys move its target; the cross releases it."""

    def __init__(self, page: WindowPage, name: str) -> None:
        self.name, self._state = name, None
        poser = page.session.poser
        with ui.element("div").classes("studio-row").style("gap: 2px; min-height: 28px"):
            self._line = pressable("studio-row studio-nudges cursor-pointer", page.doing(poser.choose, name))
            with self._line.style("min-width: 0; padding: 2px 4px; border-radius: 8px").mark(f"pose-point-{name}"):
                self._ring = ui.icon("radio_button_unchecked", size="16px")
                ui.label(name).style("overflow: hidden; text-overflow: ellipsis; white-space: nowrap; min-width: 0")
                ui.space()
                self._error = ui.label().classes("studio-figure").mark(f"pose-error-{name}")
            self._release = icon_button("close", f"Release {name}", page.doing(poser.clear, name))
            self._release.style("color: var(--muted)")

    def show(self, error: float | None, *, held: bool, chosen: bool) -> None:
        """Show the distance from the target [m], if it is held; only what has changed is sent."""
        words = format_error(error) if held and error is not None else ""
        state = (words, held, chosen)
        if state == self._state:
            return
        self._state = state
        self._line.props(f'aria-pressed="{str(chosen).lower()}"')
        self._line.style(f"font-weight: {600 if chosen else 400}; color: var(--{'ink' if held or chosen else 'muted'})")
        self._ring.style(f"color: var(--{'accent' if chosen else 'muted'}); opacity: {1 if held or chosen else 0.4}")
        self._error.set_text(words)
        near = error is not None and error < TARGET_TOLERANCE
        self._error.style(f"color: {'var(--q-positive)' if near else 'inherit'}")
        self._release.set_visibility(held)


FULL_BAR = 0.999  # a bar this full is at its limit


def bars_card(page: WindowPage) -> None:
    """Build the bars; with muscles there are none."""
    poser, document = page.session.poser, page.session.document
    with ui.column().classes("w-full").style("gap: 6px") as room:
        with ui.element("div").classes("studio-row"):
            show_heading("Winches")
            ui.space()
            limit = ui.label().classes("studio-hint studio-figure").style("margin-top: 8px")
        box = ui.element("div").classes("studio-card").style("display: flex; flex-direction: column; gap: 10px")
    rows: list[_BarRow] = []

    def build() -> None:
        rows[:] = [_BarRow(bar) for bar in poser.bars()]

    def show() -> None:
        room.set_visibility(poser.mode is Mode.CABLES)
        if poser.mode is not Mode.CABLES:
            return
        found = poser.bars()
        for row, bar in zip(rows, found, strict=False):
            row.show(bar)
        if found:
            limit.set_text(f"limit {found[0].limit:g} N")

    page.on_new(Topic.ROBOT, lambda: document.robot.winches, box, build)
    page.on((Topic.ROBOT, Topic.SCENE, Topic.SHAPE), show)


class _BarRow:
    """A winch: its name, how much it has taken in, and the largest tension of its cables."""

    def __init__(self, bar: Bar) -> None:
        with ui.element("div").style("width: 100%").mark(f"pose-bar-{bar.winch}"):
            with ui.element("div").classes("studio-row").style("gap: 8px; font-size: 13px"):
                winch_badge(bar.mark, bar.color)
                name = ui.label(bar.winch).style(
                    "flex: 1; min-width: 0; white-space: nowrap; overflow: hidden; text-overflow: ellipsis"
                )
                name.tooltip(f"contraction up to {1e3 * bar.travel:g} mm, payout up to {1e3 * bar.release:g} mm")
                figure = "width: 66px; text-align: right"
                self._length = ui.label().classes("studio-figure").style(figure)
                self._pull = ui.label().classes("studio-figure").style(figure)
            with ui.element("div").classes("studio-row").style("gap: 8px; margin-top: 4px"):
                self._taken, self._tension = _track(), _track()
        self._shown: tuple[int, int] | None = None

    def show(self, bar: Bar) -> None:
        """Show what the winch does; only what has changed is sent."""
        state = (round(1e4 * bar.contraction), round(10 * bar.tension))
        if state == self._shown:
            return
        self._shown = state
        self._length.set_text(f"{round(1e3 * bar.contraction, 1) + 0.0:.1f} mm")
        self._pull.set_text(f"{bar.tension:.1f} N")
        _fill(self._taken, max(bar.contraction, 0.0) / bar.travel, bar.color)
        _fill(self._tension, bar.tension / bar.limit, bar.color)


def _track() -> ui.element:
    with ui.element("div").style("flex: 1; height: 6px; border-radius: 3px; background: var(--line); overflow: hidden"):
        return ui.element("div").style("height: 6px; border-radius: 3px; width: 0%")


def _fill(bar: ui.element, share: float, color: str) -> None:
    full = Color.ERROR if share >= FULL_BAR else f"color-mix(in oklab, {color}, white var(--lift, 0%))"
    bar.style(f"width: {100 * min(share, 1.0):.1f}%; background: {full}")


def poses_card(page: WindowPage) -> None:
    """Build the list."""
    poser, document = page.session.poser, page.session.document
    show_heading("Poses")
    with ui.element("div").classes("studio-card").style("display: flex; flex-direction: column"):
        rows = ui.column().classes("w-full").style("gap: 2px")
        with ui.element("div").classes("studio-row"):
            name = ui.input(placeholder="name").props('dense outlined aria-label="Name of the pose"')
            name.classes("flex-1").mark("pose-name")
            button = ui.button("Store", icon="bookmark_add").props("unelevated no-caps")
            button.tooltip("Store the targets as a pose").mark("pose-store")

    def store() -> None:
        given = name.value or fresh_name("pose", document.robot.poses)
        before, replaced = document.serial, given in document.robot.poses
        page.act(poser.store, given)
        if document.serial != before:
            if replaced:
                page.tell(f"pose {given} replaced. Undo restores it")
            elif twin := same_as(document.robot, given.strip()):
                page.tell(f"pose {given.strip()} stored. It equals pose {twin}")
            name.set_value("")

    def draw() -> None:
        if not document.robot.poses:
            ui.label("No poses yet. Drag points to targets, then store them.").classes("studio-hint")
        for own in document.robot.poses:
            _pose_row(page, own)

    def ready() -> None:
        button.set_enabled(bool(poser.held_points))

    button.on_click(store)
    name.on("keydown.enter", store)
    page.on_new(Topic.ROBOT, lambda: tuple(document.robot.poses), rows, draw)
    page.on(Topic.SCENE, ready)
    page.on(Topic.SHAPE, ready)


def _pose_row(page: WindowPage, name: str) -> None:
    """One pose: a click shows it."""
    poser = page.session.poser
    with ui.element("div").classes("studio-row").style("min-height: 32px; gap: 2px"):
        show = ui.button(name, icon="accessibility_new", on_click=page.doing(poser.show_pose, name), color=None)
        show.props("flat dense no-caps align=left").classes("flex-1").style("min-width: 0; color: var(--ink)")
        show.tooltip("Show this pose").mark(f"pose-show-{name}")
        for icon, words, action in (
            ("edit", "Rename", lambda: _ask_name(page, name)),
            ("delete_outline", "Delete", page.doing(poser.delete_pose, name)),
        ):
            icon_button(icon, f"{words} {name}", action).style("color: var(--muted)")


def _ask_name(page: WindowPage, old: str) -> None:
    """Ask for another name of a pose."""
    with page.panel, ui.dialog(value=True) as dialog, ui.card().classes("q-pa-md").style("min-width: 300px"):
        show_heading(f"Rename {old}", 1)
        name = ui.input(value=old).props('dense outlined autofocus aria-label="New name"').classes("w-full")

        def rename() -> None:
            page.act(page.session.poser.rename_pose, old, name.value or "")
            dialog.close()

        name.on("keydown.enter", rename)
        with ui.element("div").classes("studio-row"):
            ui.space()
            ui.button("Cancel", on_click=dialog.close).props("flat no-caps")
            ui.button("Rename", on_click=rename).props("unelevated no-caps")
    dialog.on("hide", dialog.delete)


def reach_card(page: WindowPage) -> None:
    """Build the choice of a marker and what begins and ends the search."""
    poser, document = page.session.poser, page.session.document
    with ui.column().classes("w-full").style("gap: 6px") as room:
        show_heading("Workspace")
        with ui.element("div").classes("studio-row"):
            marker = ui.select([], label=None).props('dense outlined options-dense aria-label="Marker"')
            marker.classes("flex-1").style("min-width: 0").mark("pose-reach-marker")
            start = ui.button("Show", icon="scatter_plot").props("unelevated no-caps").mark("pose-reach")
            start.tooltip("Sample the workspace of this marker")
            stop = ui.button("Stop", icon="stop", on_click=page.doing(poser.reach.stop)).props("unelevated no-caps")
            clear = icon_button("close", "Hide workspace", page.doing(poser.reach.clear))
        words = ui.label().classes("studio-hint studio-figure")
    start.on_click(lambda: page.act(poser.reach.start, marker.value or ""))

    def draw() -> None:
        names = [own.name for own in document.robot.markers]
        if marker.options != names or marker.value not in names:
            kept = marker.value if marker.value in names else (poser.reach.marker or next(iter(names), None))
            marker.set_options(names, value=kept if kept in names else None)
        show()

    def show() -> None:
        reach = poser.reach
        room.set_visibility(poser.mode is Mode.CABLES and bool(document.robot.markers))
        start.set_visibility(not reach.running)
        stop.set_visibility(reach.running)
        clear.set_visibility(bool(reach.marker) and not reach.running)
        words.set_visibility(bool(reach.marker))
        words.set_text(f"{reach.marker}: {plural(reach.count, 'pose')}" + (" so far" if reach.running else ""))

    page.on(Topic.ROBOT, draw)
    page.on((Topic.SCENE, Topic.JOB), show)
