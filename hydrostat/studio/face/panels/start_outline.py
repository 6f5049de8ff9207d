"""Start: an outline is drawn."""

from collections.abc import Callable
from functools import partial
from typing import Any

from nicegui import ui

from hydrostat.studio.face.dialogs import ask
from hydrostat.studio.face.elements import OutlineEditor
from hydrostat.studio.face.page import WindowPage, icon_button
from hydrostat.studio.stage import StageName
from hydrostat.studio.starting.outlining import Reshaped, beginnings


def outline_view(page: WindowPage) -> Callable[[], None]:
    """Build it; returns what shows it anew."""
    starter = page.session.starter
    outlining = starter.outlining
    if outlining is None:
        return lambda: None
    robot = outlining.robot
    with ui.row().classes("items-center no-wrap w-full gap-2"):
        back = ui.button(icon="arrow_back", on_click=page.doing(starter.outline_cancel)).mark("back")
        back.props('flat round aria-label="Back"')
        title = "New outline" if outlining.behind is None else "Edit outline"
        ui.label(title if robot is None else f"Outline of {robot.name}").classes("start-title")
        ui.space()
        tools = ui.row().classes("items-center no-wrap gap-1")
        done = ui.button("Next" if robot is None else "Apply", icon="check")
        done.props('unelevated no-caps data-testid="outline-done"')
    with ui.element("div").classes("start-outline"):
        editor = OutlineEditor(outlining.loops, lambda raw: take(raw), outlining.behind)
        editor.style("width: 100%; height: 100%")
    with ui.row().classes("items-center no-wrap w-full gap-2"):
        sign = ui.icon("check_circle").classes("text-lg")
        words = ui.label().classes("start-small studio-figure").props('data-testid="outline-words"')
        ui.space()
        hint = ui.label("Click: add corner. Drag: move. Double-click: round or sharp. Delete: remove. Wheel: zoom.")
        hint.classes("start-small")
    with tools:
        _tools(editor, new=robot is None and not outlining.loops)

    def take(raw: Any) -> None:
        page.act(outlining.take, raw)
        show()

    def show() -> None:
        good = not outlining.fault
        faulty = not good and bool(outlining.loops)
        words.set_text(outlining.words or outlining.fault)
        words.classes(**{"add" if faulty else "remove": "start-problem"})
        sign.set_name("check_circle" if good else "error_outline" if faulty else "touch_app")
        sign.props(f"color={'positive' if good else 'negative' if faulty else 'primary'}")
        editor.set_fault(faulty)
        done.set_enabled(good)

    async def finish() -> None:
        if robot is None:
            await page.act_slowly(starter.outline_done)
            return
        found = await page.act_slowly(outlining.apply_outline, page.session.document.work)
        if found is not None and await _confirm_outside(page, found):
            serial = page.session.document.serial
            await page.act_slowly(starter.outline_apply)
            if page.session.document.serial != serial:
                page.go(StageName.EDIT)

    done.on_click(finish)
    show()
    return lambda: None


def _tools(editor: OutlineEditor, *, new: bool) -> None:
    if new:
        for name, loops in beginnings().items():
            ui.button(name, on_click=partial(editor.show, loops)).props("flat no-caps dense padding='4px 10px'")
    for icon, words, action in (
        ("undo", "Undo (Ctrl Z)", editor.undo),
        ("redo", "Redo", editor.redo),
        ("add_circle_outline", "Add loop (a hole if inside)", editor.add_loop),
        ("delete_outline", "Delete corner (Delete)", editor.remove_corner),
        ("fit_screen", "Fit", editor.fit),
    ):
        icon_button(icon, words, action, small=False, colour="primary")
    mirror = ui.switch("Mirror", on_change=lambda event: editor.set_mirror(bool(event.value)))
    mirror.props('data-testid="outline-mirror"')
    ui.switch("Snap", value=True, on_change=lambda event: editor.set_snap(bool(event.value)))


async def _confirm_outside(page: WindowPage, found: Reshaped) -> bool:
    """Ask whether what lies outside may go; True if nothing does."""
    words = f"If you apply it, these are removed: {', '.join(found.dropped)}."
    title = "Parts outside the new outline"
    return not found.dropped or await ask(page, title, words, "Cancel", "Remove parts", name="outline")
