"""`build_window`: the page: stages at the top, the view, the panel beside it."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import events, ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.tools import Tool
from hydrostat.studio.face.dialogs import SaveDialog, may_leave
from hydrostat.studio.face.page import HEARTBEAT, Toasts, WindowPage, icon_button
from hydrostat.studio.face.panels.design_panel import design_panel
from hydrostat.studio.face.panels.drive_panel import drive_panel
from hydrostat.studio.face.panels.edit_panel import edit_panel
from hydrostat.studio.face.panels.export_panel import export_panel
from hydrostat.studio.face.panels.motors_card import stop_button
from hydrostat.studio.face.panels.pose_panel import pose_panel
from hydrostat.studio.face.panels.start_panel import start_panel
from hydrostat.studio.face.rooms import Room
from hydrostat.studio.face.share import Links, share_dialog
from hydrostat.studio.face.tour import STAGES, Tour, help_dialog, offer_tour
from hydrostat.studio.face.view_bar import view_bar
from hydrostat.studio.face.view_words import describe_view
from hydrostat.studio.face.viewport import Side, Viewport
from hydrostat.studio.robot_link import LINK_MARK
from hydrostat.studio.session import Session
from hydrostat.studio.stage import ARROWS, StageName

STATIC = Path(__file__).parent / "static"


def dress() -> ui.dark_mode:
    """Dress the page of this window; returns its switch between light and dark."""
    ui.colors(primary="#0b5fa5", secondary="#b9774b", accent="#a8256f", positive="#00795f", negative="#c8243f",
              dark="#2a2732")  # fmt: skip
    for style in sorted(STATIC.glob("*.css")):
        ui.add_css(style.read_text(encoding="utf-8"))
    ui.add_head_html(f'<script type="module">{(STATIC / "habits.js").read_text(encoding="utf-8")}</script>')
    return ui.dark_mode(None)


PANELS = {
    StageName.START: start_panel,
    StageName.EDIT: edit_panel,
    StageName.POSE: pose_panel,
    StageName.DESIGN: design_panel,
    StageName.DRIVE: drive_panel,
    StageName.EXPORT: export_panel,
}

Ask = Callable[[], Any]


def build_window(
    session: Session,
    stream: str = "/stream",
    links: Links | None = None,
    pupil: Room | None = None,
) -> WindowPage:
    """Build the page of one browser window; it follows the session from now on.

    Pictures come by the path of a stream; links to the room, if any, can be shared. In the room of a pupil the
    nickname is shown.
    """
    page = WindowPage(session)
    dark = dress()
    tour = Tour(guest=session.guest)
    ask_save, ask_help = SaveDialog(page), help_dialog(tour)
    page.save = ask_save.save
    _header(page, dark, ask_save, ask_help, links, pupil)
    with ui.element("div").classes("studio-body") as body:
        page.whole = ui.column().classes("studio-whole")
        with ui.element("div").classes("studio-work") as work:
            with ui.element("div").classes("studio-view") as view:
                page.viewport = Viewport(stream=stream).classes("studio-viewport")
                view_bar(page)
                page.toasts = Toasts()
            page.bottom = ui.column().classes("studio-bottom")
        page.panel = ui.column().classes("studio-panel").props('role="region" aria-label="Controls"')

    def show_stage() -> None:
        start = session.stage is StageName.START
        work.set_visibility(not start)
        page.panel.set_visibility(not start)
        page.whole.set_visibility(start)
        page.toasts.room.move(body if start else view)
        page.show_panel(PANELS[session.stage])
        ui.run_javascript(f"document.getElementById('{page.panel.html_id}')?.scrollTo(0, 0)")

    with body, ui.element("div").classes("class-lock").props('role="status" data-testid="locked"') as banner:
        ui.icon("lock", size="18px")
        ui.label("Locked by your teacher")

    def show_lock() -> None:
        banner.set_visibility(session.is_locked)
        for room in (work, page.panel, page.whole):
            room.props("inert") if session.is_locked else room.props(remove="inert")

    brush = [False]

    def follow_brush() -> None:
        designs, edits = session.stage is StageName.DESIGN, session.stage is StageName.EDIT
        paints = session.designer.painter.paint is not None
        wanted = (designs and paints) or (edits and session.editor.tool is Tool.PART)
        if brush != [wanted]:
            brush[:] = [wanted]
            page.viewport.set_brush(wanted)

    page.on(Topic.STAGE, show_stage, lasting=True)
    page.on((Topic.STAGE, Topic.SCENE), follow_brush, lasting=True)
    page.on(Topic.LOCK, show_lock, lasting=True)
    dark.on_value_change(lambda: page.viewport.set_dark(bool(dark.value)))
    ui.keyboard(on_key=lambda event: _key(page, event, ask_save, ask_help))
    ui.timer(HEARTBEAT, page.beat)
    ui.timer(1.0, lambda: page.viewport.describe(describe_view(session)))
    ui.on("hydrostat_alive", session.hardware.beat)
    ui.timer(0.0, partial(_recall, dark), once=True)
    ui.timer(0.0, partial(_open_link, page), once=True)
    offer_tour(tour)
    return page


def _header(
    page: WindowPage, dark: ui.dark_mode, ask_save: SaveDialog, ask_help: Ask, links: Links | None, pupil: Room | None
) -> None:
    """Name, stages, undo, save."""
    session = page.session
    with ui.header().classes("studio-header"):
        ui.label("hydrostat").classes("studio-brand")
        if pupil is not None:
            ui.label().classes("studio-pupil").bind_text_from(pupil, "name").props('data-testid="pupil"')
        name = ui.label().classes("studio-name")
        ui.space()
        with ui.element("nav").classes("studio-stages").props('aria-label="Stages"'):
            buttons = {
                stage: ui.button(words.title, icon=words.icon, color=None, on_click=partial(page.go, stage))
                .props(f'flat no-caps dense data-testid="stage-{stage}" aria-label="{words.title}"')
                .classes("studio-stage")
                for stage, words in STAGES.items()
            }
        ui.space()
        if session.hardware.allowed:
            stop_button(page)
        undo = _tool("undo", "Undo", session.undo)
        redo = _tool("redo", "Redo", session.redo)
        save = _tool("save", "Save", ask_save.save)
        more = ui.button(icon="arrow_drop_down", color=None).props('flat round dense aria-label="Save as, download"')
        with more.classes("studio-tool").style("margin-left: -10px; width: 22px"), ui.menu():
            _saving_menu(page, ask_save)
        if links is not None:
            _tool("group_add", "Share", share_dialog(links, session.exporter.robot_link))
        _tool("dark_mode", "Light or dark", partial(_switch, dark))
        _tool("help_outline", "Help", ask_help)

    def show_stage() -> None:
        for stage, button in buttons.items():
            button.classes(**{"add" if stage is session.stage else "remove": "studio-stage-now"})
            button.props(f'aria-pressed="{str(stage is session.stage).lower()}"')
            button.set_enabled(stage is StageName.START or session.document.is_open)

    def show_robot() -> None:
        document = session.document
        name.set_text(("" if document.is_saved else "● ") + document.robot.name if document.is_open else "")
        undo.props(f"data-serial={document.serial}")  # whose state the buttons show
        for button in (save, more):
            button.set_enabled(document.is_open)
        show_stage()

    def show_undo() -> None:
        undo.set_enabled(bool(session.undo_label))
        redo.set_enabled(bool(session.redo_label))

    page.on(Topic.STAGE, show_stage, lasting=True)
    page.on(Topic.ROBOT, show_robot, lasting=True)
    page.on((Topic.ROBOT, Topic.STAGE, Topic.SCENE), show_undo, lasting=True)


def _saving_menu(page: WindowPage, ask_save: SaveDialog) -> None:
    if not page.session.guest:
        ui.menu_item("Save as…", ask_save.save_as).props('data-testid="save-as"')
    ui.menu_item("Download as .zip", ask_save.take_home).props('data-testid="save-zip"').classes("no-wrap")


def _tool(icon: str, words: str, action: Ask) -> ui.button:
    return icon_button(icon, words, lambda: action(), small=False).classes("studio-tool")


async def _recall(dark: ui.dark_mode) -> None:
    """Light or dark as this browser had it last; as the system says if it was never chosen."""
    try:
        kept = await ui.run_javascript(f"localStorage.getItem('{DARK}')", timeout=10.0)
    except TimeoutError:  # the window is gone
        return
    if kept is not None:
        dark.set_value(kept == "true")


async def _open_link(page: WindowPage) -> None:
    """Open the robot that the address of this window holds, and take it out of the address."""
    take = "(() => { const held = location.hash; history.replaceState(null, '', location.pathname); return held; })()"
    try:
        held = await ui.run_javascript(f"location.hash.startsWith('{LINK_MARK}') ? {take} : ''", timeout=10.0)
    except TimeoutError:  # the window is gone
        return
    if held and await may_leave(page):
        serial = page.session.document.serial
        await page.act_slowly(page.session.starter.open_link, str(held))
        if page.session.document.serial != serial:
            page.go(StageName.POSE)


async def _switch(dark: ui.dark_mode) -> None:
    """Light if it is dark now, and dark if it is light."""
    now = not await ui.run_javascript("Quasar.Dark.isActive", timeout=10.0)
    dark.set_value(now)
    ui.run_javascript(f"localStorage.setItem('{DARK}', {str(now).lower()})")


DARK = "hydrostat-dark"  # what a browser remembers it under
WORDS = {"a": "all", "c": "copy", "v": "paste", "d": "duplicate"}  # with Ctrl
SIDES: dict[str, Side] = {"1": "front", "3": "side", "7": "top"}


def _key(page: WindowPage, event: events.KeyEventArguments, ask_save: SaveDialog, ask_help: Ask) -> Any:
    """Handle a key; see `tour.KEYS`. Return what is still to be awaited, if anything."""
    name = str(event.key.name)
    held, arrow = event.modifiers, name.lower() in ARROWS
    if not event.action.keydown or (event.action.repeat and not (arrow and _repeats_arrows(page.session))):
        return None
    if held.alt:
        return None
    if name in SIDES and not held.ctrl and not held.meta:
        page.viewport.view(SIDES[name])
    elif name.lower() == "z":
        page.session.redo() if held.shift else page.session.undo()
    elif name.lower() == "s" and (held.ctrl or held.meta):
        return ask_save.save_as() if held.shift and not page.session.guest else ask_save.save()
    elif name == "?":
        return ask_help()
    elif held.ctrl or held.meta:
        if name.lower() in WORDS:
            page.session.key(WORDS[name.lower()])
    else:
        shifted = "shift " if held.shift and arrow else ""
        page.session.key(shifted + {" ": "space", "Backspace": "delete"}.get(name, name.lower()))
    return None


def _repeats_arrows(session: Session) -> bool:
    """True if a held arrow key repeats: for targets and the cross-hair; a change of the robot takes longer."""
    if session.stage is StageName.EDIT:
        return session.editor.cross_hair.at is not None
    return session.stage is StageName.POSE
