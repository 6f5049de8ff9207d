"""`design_paint`, `design_limits`: zones on the body, limits, and what stays of the robot's own network."""

from collections.abc import Callable
from functools import partial
from typing import Any

from nicegui import ui

from hydrostat.project import WISH_RANGES, Paint, Wishes
from hydrostat.studio.bell import Topic
from hydrostat.studio.designing.painter import COLORS, WORDS
from hydrostat.studio.face.messages import sent_number
from hydrostat.studio.face.page import WindowPage, pressable, show_heading

SHORT = {Paint.KEEP_OUT: "No-cable zone", Paint.WINCH_ZONES: "Winch zone", Paint.STILL: "Keep rigid (sheathed)"}

FLAT = "Drag on the body from the center outward. With Shift, draw around a part. Or click corner after corner."
SPACE = "Drag on the body from the center of a ball outward."
CHOSEN = "Drag the zone to move it, or a handle to resize it. Press Delete to remove it."


def design_paint(page: WindowPage) -> None:
    """Build the section."""
    designer, document = page.session.designer, page.session.document
    show_heading("Painted zones")
    buttons: dict[Paint, ui.element] = {}
    with ui.element("div").classes("studio-row").style("gap: 6px; align-items: stretch"):
        for paint, words in SHORT.items():
            button = pressable("design-paint", partial(_take, page, paint)).style(f"--tint: {COLORS[paint]}")
            with button.props(f'data-testid="paint-{paint}"'):
                ui.element("span").classes("design-spot")
                ui.label(words)
            buttons[paint] = button
    hint = ui.label().classes("studio-hint")
    zones = ui.column().classes("w-full").style("gap: 2px")

    def show() -> None:
        painter = designer.painter
        for paint, button in buttons.items():
            button.classes(**{"add" if paint is painter.paint else "remove": "design-paint-on"})
            button.props(f'aria-pressed="{str(paint is painter.paint).lower()}"')
        flat = document.robot.body.mesh.dim == 2
        hint.set_text((FLAT if flat else SPACE) if painter.paint else CHOSEN if painter.chosen is not None else "")
        hint.set_visibility(bool(hint.text))

    def build() -> None:
        for index, (paint, zone) in enumerate(designer.wishes.zones):
            size = f", {2e3 * zone.radius:.0f} mm" if zone.radius is not None else ""
            _zone(page, index, paint, size, chosen=index == designer.painter.chosen)

    page.on(Topic.SCENE, show)
    page.on_new(Topic.SCENE, lambda: (tuple(designer.wishes.zones), designer.painter.chosen), zones, build)


def _take(page: WindowPage, paint: Paint) -> None:
    designer = page.session.designer
    page.act(designer.take, None if designer.painter.paint is paint else paint)


def _zone(page: WindowPage, index: int, paint: Paint, size: str, *, chosen: bool) -> None:
    designer = page.session.designer
    row = ui.element("div").classes("studio-row design-zone" + (" design-zone-on" if chosen else ""))
    with row.style(f"--tint: {COLORS[paint]}"):
        line = pressable("studio-row", page.doing(designer.choose_zone, index))
        with line.props(f'aria-pressed="{str(chosen).lower()}"'):
            ui.element("span").classes("design-spot")
            ui.label(WORDS[paint] + size).style("font-size: 13px")
        remove = ui.button(icon="close", color=None).props('flat round dense size=sm aria-label="Delete zone"')
        remove.on("click", page.doing(designer.painter.remove, index))


OPEN = {"depth": "anywhere"}
"""Placeholder of a number that is left open, where it is not "auto"."""

Show = Callable[[Wishes], Any]


def design_limits(page: WindowPage) -> None:
    """Build the sections, closed."""
    designer = page.session.designer
    shows: list[Show] = []
    with _more("Limits"):
        with ui.element("div").classes("studio-row"):
            shows += [
                number_box(page, "Maximum tension", "tension"),
                number_box(page, "Edge clearance", "clearance"),
            ]
        if page.session.document.robot.body.mesh.dim == 3:
            shows.append(number_box(page, "Cable depth below the skin", "depth"))
        shows.append(_mirror(page))
        with ui.element("div").classes("studio-row"):
            shows += [
                number_box(page, "Tolerance", "tolerance"),
                number_box(page, "Maximum slack", "slack"),
            ]
        with ui.element("div").classes("studio-row"):
            shows += [
                number_box(page, "Cables per winch", "cables_per_winch"),
                number_box(page, "Maximum torque", "torque"),
            ]
        shows.append(_switch(page, "Different spool radii", "stepped"))
        shows.append(_switch(page, "Winches pull both ways", "two_way"))
    _own(page, shows)

    def show() -> None:
        for refresh in shows:
            refresh(designer.wishes)

    page.on(Topic.ROBOT, show)


def _more(title: str) -> ui.expansion:
    return ui.expansion(title).classes("design-more").props('dense header-class="studio-section"')


def number_box(page: WindowPage, words: str, name: str, unit: str = "") -> Show:
    """Build a box for a number that can be wished, in the unit of its range; empty where it is left open."""
    designer, allowed = page.session.designer, WISH_RANGES[name]
    scale, own_unit = allowed.display_unit
    unit, whole, optional = unit or own_unit, allowed.whole, allowed.optional
    box = ui.number(words, suffix=unit or None, format="%.6g").props("dense outlined hide-bottom-space stack-label")
    box.classes("flex-1 studio-figure").style("min-width: 0").props(f'data-testid="wish-{name}"')
    if optional:
        box.props(f'placeholder="{OPEN.get(name, "auto")}" clearable')

    def send() -> None:
        value = sent_number(box.value)
        if value is None and not (optional and box.value is None):
            show(designer.wishes)
            return
        number = None if value is None else int(value) if whole else value / scale
        page.act(lambda: designer.wish(**{name: number}))
        show(designer.wishes)

    def show(wishes: Wishes) -> None:
        value = wishes.value(name)
        box.set_value(None if value is None else float(f"{scale * value:.6g}"))

    for event in ("blur", "keydown.enter", "clear"):
        box.on(event, send)
    return show


def _switch(page: WindowPage, words: str, name: str) -> Show:
    designer = page.session.designer
    switch = ui.switch(words).props(f'dense data-testid="wish-{name}"').style("font-size: 13px")
    switch.on_value_change(lambda event: page.act(lambda: designer.wish(**{name: bool(event.value)})))
    return lambda wishes: switch.set_value(wishes.value(name))


def _mirror(page: WindowPage) -> Show:
    designer, robot = page.session.designer, page.session.document.robot
    choices = {"": "off", **{axis: axis for axis in "xyz"[: robot.body.mesh.dim]}}
    with ui.element("div").classes("studio-row"):
        ui.label("Mirror symmetry").classes("flex-1").style("font-size: 13px")
        choice = ui.toggle(choices, value="").props('dense no-caps unelevated padding="2px 12px"')
        choice.props("toggle-color=primary color=transparent text-color=primary toggle-text-color=white")
        choice.classes("design-toggle")
        choice.props('data-testid="wish-mirror" role="group" aria-label="Mirror symmetry"')
    choice.on_value_change(lambda event: page.act(lambda: designer.wish(mirror=event.value or None)))
    return lambda wishes: choice.set_value(wishes.constraints.mirror or "")


def _own(page: WindowPage, shows: list[Show]) -> None:
    """Build the section on the robot's own network: keep parts of it, or start from it."""
    designer, document = page.session.designer, page.session.document
    with _more("Current network") as more:
        shows.append(_switch(page, "Start from the current network", "improve"))
        keep = ui.select([], multiple=True, label="Lock these parts").props("dense outlined use-chips options-dense")
        keep.classes("w-full").props('data-testid="wish-keep"')
    shown: list[str] = []

    def send() -> None:
        if set(keep.value) == set(shown):  # it was not the person
            return
        names = [name.partition(" ") for name in keep.value]
        winches = tuple(name for kind, _, name in names if kind == "winch")
        cables = tuple(name for kind, _, name in names if kind == "cable")
        page.act(lambda: designer.wish(kept_winches=winches, kept_cables=cables))

    def show(wishes: Wishes) -> None:
        robot = document.robot
        more.set_visibility(bool(robot.winches or robot.cables))
        options = {f"winch {winch.name}": f"winch {winch.name}" for winch in robot.winches}
        options |= {f"cable {cable.name}": f"cable {cable.name}" for cable in robot.cables}
        kept = [f"winch {name}" for name in wishes.kept_winches] + [f"cable {name}" for name in wishes.kept_cables]
        shown[:] = [name for name in kept if name in options]
        if keep.options != options:
            keep.set_options(options, value=list(shown))
        else:
            keep.set_value(list(shown))

    keep.on_value_change(send)
    shows.append(show)
