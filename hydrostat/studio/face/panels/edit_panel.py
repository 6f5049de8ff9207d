"""The panel of the stage "edit": tools, the mirror, all parts, the chosen one, the body, and what the check says."""

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import events, ui

from hydrostat.drawing import Color
from hydrostat.fabrication import winch_marks_of
from hydrostat.robot import MATERIALS, Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.body_parts import RIGID, filling_of
from hydrostat.studio.editing.part import Kind, find_part, keys_of
from hydrostat.studio.editing.part_brush import region_color
from hydrostat.studio.editing.tools import KEYS, Tool
from hydrostat.studio.face.page import WindowPage, show_heading
from hydrostat.studio.face.panels.edit_body import body_card, check_card
from hydrostat.studio.face.panels.edit_part import EditNumber, chip, light, part_card
from hydrostat.studio.shape_draft import Form

TOOLS = {  # icon, name and what to do with each tool
    Tool.MOVE: (
        "near_me",
        "Select and move",
        "Drag a part, or a cable to add a via point. Shift-click, or switch on Multiple, to select several.",
    ),
    Tool.PIN: ("push_pin", "Place pins", "Click the body where it should be fixed. Enter shows a cross-hair."),
    Tool.MARKER: ("my_location", "Place markers", "Click a point to track. Enter shows a cross-hair."),
    Tool.WINCH: ("album", "Place winches", "Click the body where a winch should sit. Enter shows a cross-hair."),
    Tool.CABLE: ("polyline", "Lay cables", "Click a winch, then point after point. Enter or double-click to finish."),
    Tool.PART: ("texture", "Paint regions", "Draw a region of another material or a rigid one on the body."),
    Tool.RULER: ("straighten", "Measure", "Click two parts or points to measure their distance at rest."),
}

AIM = "Arrows move the cross-hair by 1 mm, with Shift by 10 mm. Enter places. Esc ends."


def edit_panel(page: WindowPage) -> None:
    """Build the panel."""
    show_heading("Edit", 1)
    _tools(page)
    _mirror(page)
    _snap(page)
    _several(page)
    part_card(page)
    parts_list(page)
    body_card(page)
    check_card(page)


def _tools(page: WindowPage) -> None:
    """A row of tools, and what to do with the one in the hand."""
    editor = page.session.editor
    letters = {tool: letter.upper() for letter, tool in KEYS.items()}
    buttons: dict[Tool, ui.button] = {}
    with ui.element("div").classes("studio-row").style("gap: 4px"):
        for tool, (icon, name, _) in TOOLS.items():
            button = ui.button(icon=icon, on_click=page.doing(editor.take, tool))
            button.props(f'unelevated no-caps padding="8px 0" aria-label="{name}"').classes("flex-1")
            button.style("border-radius: 10px")
            buttons[tool] = button.tooltip(f"{name} ({letters[tool]})").mark(f"edit-{tool}")
    hint = ui.label().classes("studio-hint").style("min-height: 38px").props("role=status")
    _brush(page)
    with ui.element("div").classes("studio-row") as laying:
        done = ui.button("Done", icon="check", on_click=page.doing(editor.finish)).classes("flex-1")
        done.props("unelevated no-caps").mark("edit-done")
        drop = ui.button("Cancel", on_click=page.doing(editor.cancel)).classes("flex-1")
        drop.props("outline no-caps").mark("edit-cancel")

    def show() -> None:
        for tool, button in buttons.items():
            now = tool is editor.tool
            button.props(f"color={'primary' if now else 'transparent'} text-color={'white' if now else 'primary'}")
            button.props(add="" if now else "flat", remove="flat" if now else "")
            button.props(f'aria-pressed="{str(now).lower()}"')
        measured = "" if editor.ruler is None else editor.ruler.words
        hint.set_text(measured or (TOOLS[editor.tool][2] if editor.cross_hair.at is None else AIM))
        corners = editor.brush.drawn.corners
        laying.set_visibility(editor.draft is not None or bool(corners))
        done.set_enabled(len(corners) > 2 if editor.draft is None else len(editor.draft.points) > 1)

    page.on(Topic.SCENE, show)


FORMS = {
    Form.DISC: ("circle", "edit-form-disc", "Drag from the center outward"),
    Form.BOX: ("box", "edit-form-box", "Drag from corner to corner"),
    Form.FREE: ("free", "edit-form-free", "Drag around a part, or click corner after corner"),
}


def _brush(page: WindowPage) -> None:
    """Material and form of the region that is painted next, while its tool is in the hand."""
    editor = page.session.editor
    with ui.column().classes("w-full gap-2") as rows:
        choice = ui.select([RIGID, *MATERIALS], label="Material", value=editor.brush.filling)
        choice.props("dense outlined options-dense").classes("w-full").mark("edit-brush-material")
        choice.on_value_change(lambda: setattr(editor.brush, "filling", choice.value))
        if page.session.document.robot.body.mesh.dim == 2:
            _choice(page, "category", "Form", FORMS, editor.brush.choose_form, lambda: editor.brush.form)

    def show() -> None:
        rows.set_visibility(editor.tool is Tool.PART)
        choice.set_value(editor.brush.filling)

    page.on(Topic.SCENE, show)


def _mirror(page: WindowPage) -> None:
    """Build the choice of the mirror axis, and for a body in space the depth at which parts are placed."""
    editor, document = page.session.editor, page.session.document
    axes = "xyz"[: document.robot.body.mesh.dim]
    with ui.element("div").classes("studio-row").props('role="group" aria-label="Mirror"'):
        ui.icon("flip", size="20px").style("color: var(--muted)")
        ui.label("Mirror").style("font-size: 13px")
        ui.space()
        chips = {axis: chip(axis or "off", page.doing(editor.mirror_about, axis)) for axis in ("", *axes)}
        for axis, button in chips.items():
            button.tooltip(f"Mirror edits across {axis} = 0" if axis else "No mirror")
            button.mark(f"edit-mirror-{axis or 'off'}")

    def show() -> None:
        now = "" if editor.mirror is None else "xyz"[editor.mirror.axis]
        for axis, button in chips.items():
            light(button, axis == now)

    page.on(Topic.SCENE, show)
    if len(axes) == 3:
        _depth(page)


SNAPS = {0.0: "off", 1e-3: "1", 5e-3: "5", 1e-2: "10 mm"}  # steps of the grid [m], and their words


def _snap(page: WindowPage) -> None:
    """On which grid parts are placed."""
    editor = page.session.editor
    words = {step: (word, f"edit-snap-{word.split()[0]}", "") for step, word in SNAPS.items()}
    _choice(page, "grid_on", "Snap", words, editor.set_snap, lambda: editor.snap)


def _several(page: WindowPage) -> None:
    """Build the switch for multiple selection: a touch screen has no Shift key."""
    editor = page.session.editor
    words = {
        False: ("off", "edit-several-off", "Each click selects one part"),
        True: ("on", "edit-several-on", "Each click adds a part to the selection"),
    }
    _choice(page, "checklist", "Multiple", words, editor.choose_several, lambda: editor.several)


def _choice(
    page: WindowPage,
    icon: str,
    title: str,
    words: Mapping[Any, tuple[str, str, str]],
    choose: Callable[[Any], None],
    chosen: Callable[[], Any],
) -> None:
    """A row of chips, one of which is chosen: for each value its word, its mark for tests, and a tooltip."""
    with ui.element("div").classes("studio-row").props(f'role="group" aria-label="{title}"'):
        ui.icon(icon, size="20px").style("color: var(--muted)")
        ui.label(title).style("font-size: 13px")
        ui.space()
        chips = {value: chip(word, page.doing(choose, value)) for value, (word, _, _) in words.items()}
        for value, button in chips.items():
            _, mark, hint = words[value]
            button.mark(mark)
            if hint:
                button.tooltip(hint)

    def show() -> None:
        for value, button in chips.items():
            light(button, value == chosen())

    page.on(Topic.SCENE, show)


def _depth(page: WindowPage) -> None:
    editor = page.session.editor

    def take(value: float) -> None:
        page.act(editor.set_depth, 1e-3 * value)
        depth.show(1e3 * editor.depth)

    with ui.element("div").classes("studio-row"):
        depth = EditNumber("Depth of winches and cables below the skin", "mm", take, mark="edit-depth")
    depth.show(1e3 * editor.depth)


HEIGHT = "min(420px, 40vh)"  # of the list; longer ones are scrolled
ICONS = {Kind.PIN: "push_pin", Kind.WINCH: "album", Kind.CABLE: "timeline", Kind.MARKER: "my_location",
         Kind.REGION: "texture"}  # fmt: skip


def parts_list(page: WindowPage) -> None:
    """Build the list."""
    editor, document = page.session.editor, page.session.document
    with ui.element("div").classes("studio-row"):
        show_heading("Parts")
        ui.space()
        count = ui.label().classes("studio-hint studio-figure").style("margin-top: 8px")
    box = ui.column().classes("w-full").props('role="listbox" aria-label="Parts" aria-multiselectable="true"').style(
        f"max-height: {HEIGHT}; overflow-y: auto; gap: 0; flex-wrap: nowrap; border: 1px solid var(--line);"
        "border-radius: 12px; padding: 4px; flex-shrink: 0"
    )  # fmt: skip
    rows: dict[str, ui.element] = {}

    def entries() -> list[tuple[str, str, str]]:
        return [(key, *_part_words(document.robot, key)) for key in keys_of(document.robot)]

    def build() -> None:
        rows.clear()
        rows.update({key: _part_row(page, document.robot, key, *words) for key, *words in entries()})
        count.set_text(f"{len(rows)}")

    def show() -> None:
        chosen = {f"cable:{key.split(':')[1]}" if key.startswith("via:") else key for key in editor.selection}
        for key, row in rows.items():
            row.style("background: color-mix(in srgb, var(--accent) 16%, transparent)" if key in chosen else
                      "background: transparent")  # fmt: skip
            row.props(f'aria-selected="{str(key in chosen).lower()}"')

    page.on_new(Topic.SCENE, entries, box, build)
    page.on(Topic.SCENE, show)


def _part_row(page: WindowPage, robot: Robot, key: str, words: str, number: str) -> ui.element:
    part = find_part(robot, key)
    kind = Kind.PIN if part is None else part.kind
    editor = page.session.editor

    def press(event: events.GenericEventArguments) -> None:
        also = bool((event.args or {}).get("shiftKey"))
        page.act(lambda: editor.choose(key, also=also or editor.several))

    row = ui.element("div").classes("studio-row cursor-pointer").mark(f"part-{key}").props('role="option" tabindex="0"')
    for kind_of_press in ("click", "keydown.enter", "keydown.space.prevent.stop"):
        row.on(kind_of_press, press, args=["shiftKey"])
    row.style(
        f"padding: 3px 8px 3px {24 if kind is Kind.CABLE else 8}px; border-radius: 8px; font-size: 13px; flex-shrink: 0"
    )
    with row:
        ui.icon(ICONS[kind], size="17px").style(f"color: {_color(robot, key)}")
        ui.label(words).style("overflow: hidden; text-overflow: ellipsis; white-space: nowrap")
        ui.space()
        ui.label(number).classes("studio-hint studio-figure").style("white-space: nowrap")
    return row


def _part_words(robot: Robot, key: str) -> tuple[str, str]:
    """Name of a part, and a number that tells it from others."""
    part = find_part(robot, key)
    if part is None:
        return key, ""
    if part.kind is Kind.CABLE:
        return f"Cable {part.index + 1}", f"{1e3 * robot.cables[part.index].length:.0f} mm"
    if part.kind is Kind.PIN:
        radius = robot.pins[part.index].radius
        return f"Pin {part.index + 1}", f"{1e3 * radius:.3g} mm" if radius else "box"
    if part.kind is Kind.WINCH:
        name = robot.winches[part.index].name
        return name, f"winch {winch_marks_of(robot)[name]}"
    if part.kind is Kind.REGION:
        return robot.body.parts[part.index].name, filling_of(robot.body.parts[part.index])
    return robot.markers[part.index].name, "marker"


def _color(robot: Robot, key: str) -> str:
    """Color of its winch; the quiet one for all else."""
    part, colors = find_part(robot, key), Color.of_winches(robot.winches)
    if part is not None and part.kind is Kind.WINCH:
        return _page_color(colors[robot.winches[part.index].name])
    if part is not None and part.kind is Kind.CABLE:
        return _page_color(colors[robot.cables[part.index].winch])
    if part is not None and part.kind is Kind.REGION:
        return _page_color(region_color(robot.body, robot.body.parts[part.index]))
    return "var(--muted)"


def _page_color(color: str) -> str:
    """A color of the view on a page that is light or dark."""
    return f"color-mix(in srgb, {color} 78%, var(--ink))"
