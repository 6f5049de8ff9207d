"""`part_card`: name, place and numbers of the part that is chosen; `chip` and `EditNumber`, which it is made of."""

from collections.abc import Callable
from inspect import isawaitable
from typing import Any

from nicegui import ui

from hydrostat.robot import MATERIALS, Mount, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.body_parts import RIGID, filling_of
from hydrostat.studio.editing.change import sheathed_segments, sheaths
from hydrostat.studio.editing.part import Kind, Part, find_part, name_of, place_of, title_of
from hydrostat.studio.face.messages import sent_number
from hydrostat.studio.face.page import WindowPage, icon_button, show_heading


def chip(words: str, press: Callable[[], Any]) -> ui.button:
    """A chip that is off."""
    button = ui.button(words, on_click=press, color=None).props('dense flat padding="1px 10px" no-caps')
    return button.style("font-size: 13px; border-radius: 9px; min-height: 26px")


def light(button: ui.button, on: bool) -> None:
    """Show whether a chip is on."""
    button.props(f'aria-pressed="{str(on).lower()}"')
    button.style(f"background: {'#0b5fa5' if on else 'transparent'}; color: {'white' if on else 'var(--ink)'}")


class EditNumber:
    """Shows a number; calls back once a person has typed another and pressed Enter or gone elsewhere."""

    def __init__(
        self, label: str, unit: str, take: Callable[[float], Any], *, step: float = 1.0, mark: str = ""
    ) -> None:
        """An empty box; `take` is called with the new number, what it returns is awaited, the mark is for tests."""
        self._shown: float | None = None
        self._take = take
        self._box = ui.number(label, suffix=unit, step=step, format="%.6g").props("dense outlined hide-bottom-space")
        self._box.classes("flex-1 studio-figure").style("min-width: 0").mark(mark)
        self._box.on("keydown.enter", self._send)
        self._box.on("blur", self._send)

    def show(self, value: float) -> None:
        """Show a number; one that is being typed is left alone unless another came from elsewhere."""
        rounded = float(f"{value:.6g}")
        if rounded != self._shown:
            self._shown = rounded
            self._box.set_value(rounded)

    async def _send(self) -> None:
        number = sent_number(self._box.value)
        if number is None or self._shown is None:
            self._box.set_value(self._shown)
        elif number != self._shown:
            before, self._shown = self._shown, None
            result = self._take(number)
            if isawaitable(result):
                await result
            if self._shown is None:  # nobody has shown what came of it: it was refused or is as it was
                self.show(before)


Show = Callable[[Robot, Part], None]
Shows = list[Show]  # what shows the numbers of the part as they are now
PIN = (("radius", "Radius", "mm", 1e3),)
WINCH = (
    ("spool_radius", "Spool radius", "mm", 1e3),
    ("travel", "Travel", "mm", 1e3),
    ("release", "Release", "mm", 1e3),
)
CABLE = (("stiffness", "Stiffness", "N/mm", 1e-3), ("slack", "Slack", "mm", 1e3), ("friction", "Friction", "", 1.0))
"""Field, name, unit and how many of these one SI unit is."""


def part_card(page: WindowPage) -> None:
    """Build the card; it is there only while something is chosen."""
    editor, document = page.session.editor, page.session.document
    card = ui.column().classes("studio-card").style("background: transparent; flex-shrink: 0")
    shows: Shows = []
    built: list[str] = []

    def show() -> None:
        key, robot = editor.selected_key, document.robot
        part = find_part(robot, key)
        card.set_visibility(part is not None)
        if part is None:
            built.clear()
            return
        if len(editor.selection) > 1:
            if built != [f"{len(editor.selection)} parts"]:
                built[:] = [f"{len(editor.selection)} parts"]
                card.clear()
                shows.clear()
                with card:
                    _many(page, built[0])
            return
        form = f"{key} {len(robot.cables[part.index].points) if part.kind is Kind.CABLE else ''}"
        if built != [form]:
            built[:] = [form]
            card.clear()
            with card:
                shows[:] = _build(page, key, part)
        for refresh in shows:
            refresh(robot, part)

    page.on(Topic.SCENE, show)


def _many(page: WindowPage, words: str) -> None:
    """Build the actions on several parts."""
    editor = page.session.editor
    with ui.element("div").classes("studio-row"):
        ui.label(words).style("font-weight: 600")
        ui.space()
        icon_button("content_copy", "Duplicate (Ctrl D)", page.doing(editor.duplicate)).mark("edit-duplicate")
        icon_button("delete_outline", "Delete (Del)", page.doing(editor.delete)).mark("edit-delete")


def _build(page: WindowPage, key: str, part: Part) -> Shows:
    """The rows for a part."""
    editor = page.session.editor
    with ui.element("div").classes("studio-row"):
        show_heading(_title(key)).style("margin-top: 0; font-size: 14px")
        ui.space()
        if part.kind is not Kind.VIA:
            icon_button("content_copy", "Duplicate (Ctrl D)", page.doing(editor.duplicate)).mark("edit-duplicate")
        icon_button("delete_outline", "Delete (Del)", page.doing(editor.delete)).mark("edit-delete")
    shows: Shows = []
    if name_of(page.session.document.robot, key):
        shows.append(_name(page, key))
    if place_of(page.session.document.robot, key) is not None:
        shows.append(_place(page, key))
    if part.kind is Kind.REGION:
        shows.append(_filling(page, key))
    if part.kind is Kind.PIN and page.session.document.robot.pins[part.index].box is None:
        shows += _numbers(page, key, PIN)
    if part.kind is Kind.WINCH:
        shows += [*_numbers(page, key, WINCH), _mount(page, key)]
    if part.kind is Kind.CABLE:
        shows += [*_numbers(page, key, CABLE), _sheath(page, key, part)]
    return shows


def _title(key: str) -> str:
    """Without the name where that can be changed below."""
    kind = key.partition(":")[0]
    return (kind if kind in ("winch", "marker", "region") else title_of(key)).capitalize()


def _name(page: WindowPage, key: str) -> Show:
    document = page.session.document
    box = ui.input("Name", value=name_of(document.robot, key)).classes("w-full").mark("edit-name")
    box.props("dense outlined maxlength=60")

    def send() -> None:
        typed = (box.value or "").strip()
        if typed:
            page.act(page.session.editor.rename, key, typed)
        if page.session.editor.selected_key == key:
            show(document.robot)

    def show(robot: Robot, _: Part | None = None) -> None:
        box.set_value(name_of(robot, key))

    box.on("keydown.enter", send)
    box.on("blur", send)
    return show


def _place(page: WindowPage, key: str) -> Show:
    """One box for each coordinate."""
    document, boxes = page.session.document, []

    def take(axis: int, value: float) -> None:
        at = place_of(document.robot, key)
        if at is not None:
            page.act(page.session.editor.place, key, (*at[:axis], 1e-3 * value, *at[axis + 1 :]))
            show(document.robot)

    def show(robot: Robot, _: Part | None = None) -> None:
        for box, value in zip(boxes, place_of(robot, key) or (), strict=False):
            box.show(1e3 * value)

    with ui.element("div").classes("studio-row"):
        for axis, name in enumerate("xyz"[: document.robot.body.mesh.dim]):
            boxes.append(EditNumber(f"{name}, mm", "", lambda value, axis=axis: take(axis, value), mark=f"edit-{name}"))
    return show


def _numbers(page: WindowPage, key: str, fields: tuple[tuple[str, str, str, float], ...]) -> Shows:
    """A box for each number of a part, two in a row."""
    with ui.element("div").classes("w-full").style("display: grid; grid-template-columns: 1fr 1fr; gap: 8px"):
        return [_number(page, key, *field) for field in fields]


def _number(page: WindowPage, key: str, field: str, label: str, unit: str, scale: float) -> Show:
    editor, document = page.session.editor, page.session.document

    def take(value: float) -> None:
        page.act(lambda: editor.set(key, **{field: value / scale}))
        part = find_part(document.robot, key)
        if part is not None:
            show(document.robot, part)

    def show(robot: Robot, part: Part) -> None:
        record = {Kind.PIN: robot.pins, Kind.WINCH: robot.winches}.get(part.kind, robot.cables)[part.index]
        box.show(scale * getattr(record, field))

    box = EditNumber(label, unit, take, step=0.1 if field == "friction" else 1.0, mark=f"edit-{field}")
    return show


def _mount(page: WindowPage, key: str) -> Show:
    """Return True if a winch sits in the body."""
    switch = ui.switch("Fixed outside the body").props("dense").style("font-size: 13px").mark("edit-mount")
    switch.tooltip("The winch stays in place while the body moves")
    shown = [False]

    def send() -> None:
        if switch.value != shown[0]:
            mount = Mount.WORLD if switch.value else Mount.BODY
            if page.act(lambda: page.session.editor.set(key, mount=mount) or True) is None:
                switch.set_value(shown[0])

    def show(robot: Robot, part: Part) -> None:
        shown[0] = robot.winches[part.index].mount is Mount.WORLD
        switch.set_value(shown[0])

    switch.on_value_change(send)
    return show


def _filling(page: WindowPage, key: str) -> Show:
    """Build the choice of a region's material; one that is not of the table is shown as it is called."""
    editor = page.session.editor
    choice = ui.select({}, label="Material").props("dense outlined options-dense").classes("w-full")
    choice.mark("edit-region-material")
    shown = [""]

    def send() -> None:
        if choice.value != shown[0]:
            page.act(lambda: editor.set(key, filling=choice.value))

    def show(robot: Robot, part: Part) -> None:
        shown[0] = filling_of(robot.body.parts[part.index])
        choice.set_options(list(dict.fromkeys([shown[0], RIGID, *MATERIALS])), value=shown[0])

    choice.on_value_change(send)
    return show


def _sheath(page: WindowPage, key: str, part: Part) -> Show:
    """Build the choice of sheathed segments, as chips in the order of the cable."""
    cable = page.session.document.robot.cables[part.index]
    buttons: list[ui.button] = []

    def toggle(segment: int) -> None:
        now = set(sheathed_segments(page.session.document.robot.cables[part.index]))
        page.session.editor.set(key, sheathed=sheaths(now ^ {segment}))

    ui.label("Sheathed segments, from the winch").classes("studio-hint")
    with ui.element("div").classes("w-full").style("display: flex; flex-wrap: wrap; gap: 4px"):
        for segment in range(len(cable.points) - 1):
            button = chip(f"{segment + 1}", page.doing(toggle, segment))
            buttons.append(button.mark(f"edit-sheath-{segment}"))

    def show(robot: Robot, part: Part) -> None:
        inside = set(sheathed_segments(robot.cables[part.index]))
        for segment, button in enumerate(buttons):
            light(button, segment in inside)

    return show
