"""The panel of the stage "edit": tools, the mirror, all parts, the chosen one, the body, and what the check says."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.tool import KEYS, Tool
from hydrostat.studio.face.page import Page
from hydrostat.studio.face.panels.edit_body import body_card
from hydrostat.studio.face.panels.edit_check import check_card
from hydrostat.studio.face.panels.edit_chip import chip, light
from hydrostat.studio.face.panels.edit_number import EditNumber
from hydrostat.studio.face.panels.edit_part import part_card
from hydrostat.studio.face.panels.edit_parts import parts_list

TOOLS = {
    Tool.MOVE: ("near_me", "Select and move", "Drag a part, or a point out of a cable. Click to select."),
    Tool.PIN: ("push_pin", "Place pins", "Click on the body where it is held."),
    Tool.MARKER: ("my_location", "Place markers", "Click on a point to track."),
    Tool.WINCH: ("album", "Place winches", "Click on the body where a winch sits."),
    Tool.CABLE: ("polyline", "Lay cables", "Click at a winch, then point after point. Enter or a double click ends."),
}
"""Icon, name and what to do with each tool."""


def edit_panel(page: Page) -> None:
    """Build the panel."""
    ui.label("Edit").classes("studio-title")
    _tools(page)
    _mirror(page)
    part_card(page)
    parts_list(page)
    body_card(page)
    check_card(page)


def _tools(page: Page) -> None:
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
    hint = ui.label().classes("studio-hint").style("min-height: 38px")
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
        hint.set_text(TOOLS[editor.tool][2])
        laying.set_visibility(editor.draft is not None)
        done.set_enabled(editor.draft is not None and len(editor.draft.points) > 1)

    page.on(Topic.THINGS, show)


def _mirror(page: Page) -> None:
    """Which side is edited alike, and how deep things are put into a body in space."""
    editor, document = page.session.editor, page.session.document
    axes = "xyz"[: document.robot.body.mesh.dim]
    with ui.element("div").classes("studio-row"):
        ui.icon("flip", size="20px").style("color: var(--muted)")
        ui.label("Mirror").style("font-size: 13px")
        ui.space()
        chips = {axis: chip(axis or "off", page.doing(editor.mirror_about, axis)) for axis in ("", *axes)}
        for axis, button in chips.items():
            button.tooltip(f"Both sides of {axis} = 0 alike" if axis else "No mirror").mark(
                f"edit-mirror-{axis or 'off'}"
            )

    def show() -> None:
        now = "" if editor.mirror is None else "xyz"[editor.mirror.axis]
        for axis, button in chips.items():
            light(button, axis == now)

    page.on(Topic.THINGS, show)
    if len(axes) == 3:
        _depth(page)


def _depth(page: Page) -> None:
    editor = page.session.editor

    def take(value: float) -> None:
        page.act(editor.set_depth, 1e-3 * value)
        depth.show(1e3 * editor.depth)

    with ui.element("div").classes("studio-row"):
        depth = EditNumber("Winches and cables below the skin", "mm", take, mark="edit-depth")
    depth.show(1e3 * editor.depth)
