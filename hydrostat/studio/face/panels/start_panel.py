"""The panel of the stage "start": what a crash left, three ways to begin, robots to choose."""

from base64 import b64encode
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import events, run, ui

from hydrostat.errors import HydrostatError
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.dialogs import ask, may_leave
from hydrostat.studio.face.elements import OutlineEditor
from hydrostat.studio.face.page import WindowPage, icon_button, name_upload, show_heading
from hydrostat.studio.face.panels.start_draft import draft_view
from hydrostat.studio.stage import StageName
from hydrostat.studio.starting.autosave import RecoveredWork
from hydrostat.studio.starting.draft import MAX_BYTES
from hydrostat.studio.starting.outlining import Reshaped, beginnings
from hydrostat.studio.starting.shelf import Card, gallery_cards, suggestions


def outline_view(page: WindowPage) -> Callable[[], None]:
    """Build it; returns what shows it again."""
    starter = page.session.starter
    outlining = starter.outlining
    if outlining is None:
        return lambda: None
    robot = outlining.robot
    with ui.row().classes("items-center no-wrap w-full gap-2"):
        back = ui.button(icon="arrow_back", on_click=page.doing(starter.outline_cancel)).mark("back")
        back.props('flat round aria-label="Back"')
        title = "New outline" if outlining.behind is None else "Edit outline"
        title = title if robot is None else f"Outline of {robot.name}"
        show_heading(title, 1).classes("start-title", remove="studio-title")
        ui.space()
        tools = ui.row().classes("items-center no-wrap gap-1")
        done = ui.button("Next" if robot is None else "Apply", icon="check")
        done.props('unelevated no-caps data-testid="outline-done"')
    with ui.element("div").classes("start-outline"):
        editor = OutlineEditor(outlining.loops, lambda raw: take(raw), outlining.behind)
        editor.style("width: 100%; height: 100%")
    with ui.row().classes("items-center no-wrap w-full gap-2"):
        sign = ui.icon("check_circle").classes("text-lg")
        words = ui.label().classes("start-small studio-figure").props('data-testid="outline-words" role="status"')
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
        icon_button(icon, words, action, small=False, color="primary")
    mirror = ui.switch("Mirror", on_change=lambda event: editor.set_mirror(bool(event.value)))
    mirror.props('data-testid="outline-mirror"')
    ui.switch("Snap", value=True, on_change=lambda event: editor.set_snap(bool(event.value)))


async def _confirm_outside(page: WindowPage, found: Reshaped) -> bool:
    """Ask whether what lies outside may go; True if nothing does."""
    words = f"If you apply it, these are removed: {', '.join(found.dropped)}."
    title = "Parts outside the new outline"
    return not found.dropped or await ask(page, title, words, "Cancel", "Remove parts", name="outline")


STYLE = Path(__file__).parents[1] / "static" / "start.css"

KINDS = ("SVG", "DXF", "PNG", "JPG", "STL", "OBJ", "PLY", "OFF", "3MF", "STEP", "ZIP")


def shelf_view(page: WindowPage) -> Callable[[], None]:
    """Build it."""
    starter = page.session.starter
    most_left = 4  # so many works that a crash left are offered at once, the newest
    for left in starter.autosave.find_recovered()[:most_left]:
        _show_recovered(page, left)
    show_heading("New robot", 1).classes("start-title", remove="studio-title")
    with ui.element("div").classes("start-ways"):
        _drop(page)
        _draw(page)
        if not page.session.guest:
            _folder(page)
    recent = [] if page.session.guest else starter.recent()
    if recent:
        show_heading("Your robots").classes("start-section", remove="studio-section")
        with ui.element("div").classes("start-chips"):
            for card in recent:
                _chip(page, card)
    show_heading("Gallery").classes("start-section", remove="studio-section")
    with ui.element("div").classes("start-gallery"):
        for card in gallery_cards():
            _robot(page, card)
    return lambda: None


async def open_with(page: WindowPage, button: ui.element, action: Callable[[], None]) -> None:
    """Open a robot, show that it takes a moment, and go on to posing."""
    if not await may_leave(page):
        return
    serial = page.session.document.serial
    button.classes(add="start-busy")
    await page.act_slowly(action)
    _rest(button)
    if page.session.document.serial != serial and page.session.stage is StageName.START:
        page.go(StageName.POSE)


def _rest(card: ui.element) -> bool:
    """Show that it works no more; whether it is still there."""
    if card.is_deleted:
        return False
    card.classes(remove="start-busy")
    return True


def _show_recovered(page: WindowPage, left: RecoveredWork) -> None:
    autosave = page.session.starter.autosave
    with ui.element("div").classes("start-left") as row:
        ui.icon("history").classes("text-xl")
        ui.label(f"Unsaved work: {left.words}")
        ui.space()
        restore = ui.button("Restore").props("unelevated no-caps dense padding='4px 14px' data-testid=restore")
        restore.on_click(lambda: open_with(page, row, partial(autosave.restore, left)))

        async def forget() -> None:
            title = f"Delete the unsaved work {left.words}?"
            if await ask(page, title, "You cannot undo this.", "Cancel", "Delete", name="forget", negative=True):
                await page.act_slowly(autosave.forget, left)
                row.delete()

        ui.button("Delete", on_click=forget).props("flat no-caps dense padding='4px 10px'")


def _drop(page: WindowPage) -> None:
    card = ui.element("div").classes("start-card start-drop")
    with card.props('tabindex=0 role=button aria-label="Import a file"'):
        _head("upload_file", "Import a drawing or scan")
        words = "Drop a file or click to choose one. You see its mesh and repairs first. A .zip opens a saved robot."
        ui.label(words).classes("start-small")
        wrong = ui.label().classes("start-problem").props('data-testid="upload-wrong" role="alert"')
        wrong.bind_visibility_from(wrong, "text", bool)
        ui.space()
        with ui.element("div").classes("start-kinds"):
            for kind in KINDS:
                ui.label(kind).classes("start-kind")
        upload = ui.upload(max_file_size=MAX_BYTES, max_files=1, auto_upload=True).props('data-testid="upload"')
        name_upload(upload, "File")

    def complain(words: str) -> None:
        if _rest(card):
            upload.reset()
            wrong.set_text(words)

    async def brought(event: events.UploadEventArguments) -> None:
        card.classes(add="start-busy")
        wrong.set_text("")
        content = await event.file.read()
        try:
            if event.file.name.lower().endswith(".zip"):
                complain("")
                await open_with(page, card, partial(page.session.starter.open_zip, event.file.name, content))
                return
            await run.io_bound(page.session.starter.bring, event.file.name, content)
        except HydrostatError as error:
            complain(str(error))
        else:
            complain("")

    upload.on_upload(brought)
    upload.on_rejected(lambda: complain(f"file refused. Import one file at a time, at most {MAX_BYTES // 10**6} MB"))
    pick = f"() => getElement({upload.id}).$refs.qRef.pickFiles()"
    card.on("click", js_handler=pick)
    for key in ("enter", "space.prevent.stop"):
        card.on(f"keydown.{key}", js_handler=pick)


def _draw(page: WindowPage) -> None:
    starter, document = page.session.starter, page.session.document
    with ui.element("div").classes("start-card"):
        _head("draw", "Draw an outline")
        ui.label("Draw the outline of a flat, stuffed body: corners, curves and holes.").classes("start-small")
        ui.space()
        new = ui.button("New outline", icon="add", on_click=page.doing(starter.outline_new))
        new.props("unelevated no-caps").props('data-testid="outline-new"')
        if document.is_open and document.robot.body.outline is not None:
            edit = ui.button(f"Edit outline of {document.robot.name}", on_click=page.doing_slowly(starter.outline_open))
            edit.props("outline no-caps").props('data-testid="outline-edit"')


def _folder(page: WindowPage) -> None:
    with ui.element("div").classes("start-card") as card:
        _head("folder_open", "Open a folder")
        ui.label("A folder with robot.toml, e.g. from hydrostat new.").classes("start-small")
        ui.space()
        path = ui.input("Folder", autocomplete=suggestions("")).classes("w-full")
        path.props('outlined dense data-testid="folder"')
        path.on_value_change(lambda event: path.set_autocomplete(suggestions(str(event.value or ""))))

        async def go() -> None:
            await open_with(page, card, lambda: page.session.open_folder(str(path.value or "")))

        path.on("keydown.enter", go)
        ui.button("Open", on_click=go).props("unelevated no-caps").props('data-testid="folder-open"')


def _chip(page: WindowPage, card: Card) -> None:
    with ui.element("button").classes("start-chip") as chip:
        ui.label(card.name).classes("start-robot-name")
        ui.label(card.words or str(card.folder)).classes("start-small")
    chip.tooltip(str(card.folder))
    chip.on("click", lambda: open_with(page, chip, lambda: page.session.open_folder(str(card.folder))))


def _robot(page: WindowPage, card: Card) -> None:
    shown = card.name.replace("_", " ")
    tile = ui.element("button").classes("start-robot")
    with tile.props(f'aria-label="{shown}" data-testid="gallery-{card.name}"'):
        if card.picture is not None:
            content = b64encode(card.picture.read_bytes()).decode()
            ui.element("img").props(f'src="data:image/webp;base64,{content}" alt=""')
        ui.label(shown).classes("start-robot-name")
        ui.label(card.words).classes("start-small")
    tile.on("click", lambda: open_with(page, tile, lambda: page.session.starter.open_gallery(card.folder)))


def _head(icon: str, words: str) -> None:
    with ui.element("div").classes("start-head"):
        ui.icon(icon)
        show_heading(words).classes(remove="studio-section")


VIEWS = {"shelf": shelf_view, "draft": draft_view, "outline": outline_view}  # each gives what shows it again


def start_panel(page: WindowPage) -> None:
    """Build the whole page: robots to choose, or what is being made of a file, or an outline that is drawn."""
    starter = page.session.starter
    with page.whole:
        ui.html(f"<style>{STYLE.read_text(encoding='utf-8')}</style>", sanitize=False)
        room = ui.column().classes("start-room")
    shown, refresh = "", lambda: None

    def show() -> None:
        nonlocal shown, refresh
        wanted = "outline" if starter.outlining else "draft" if starter.draft or starter.problem else "shelf"
        if wanted != shown:
            shown = wanted
            room.clear()
            with room:
                refresh = VIEWS[wanted](page)
        refresh()

    starter.get_ready()
    page.on(Topic.JOB, show)
