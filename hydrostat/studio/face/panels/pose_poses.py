"""`poses_card`, `reach_card`: the poses of the robot, and all that a marker can reach."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage, icon_button
from hydrostat.studio.posing.held import Mode
from hydrostat.studio.records.work import fresh_name


def poses_card(page: WindowPage) -> None:
    """Build the list."""
    poser, document = page.session.poser, page.session.document
    ui.label("Poses").classes("studio-section")
    with ui.element("div").classes("studio-card").style("display: flex; flex-direction: column"):
        rows = ui.column().classes("w-full").style("gap: 2px")
        with ui.element("div").classes("studio-row"):
            name = ui.input(placeholder="name").props('dense outlined aria-label="Name of the pose"')
            name.classes("flex-1").mark("pose-name")
            button = ui.button("Store", icon="bookmark_add").props("unelevated no-caps")
            button.tooltip("Keep what is held as a pose").mark("pose-store")

    def store() -> None:
        given = name.value or fresh_name("pose", document.robot.poses)
        before, replaced = document.serial, given in document.robot.poses
        page.act(poser.store, given)
        if document.serial != before:
            if replaced:
                page.tell(f"{given} was there and is replaced; undo brings it back")
            name.set_value("")

    def draw() -> None:
        if not document.robot.poses:
            ui.label("None yet: hold some points, then store them.").classes("studio-hint")
        for own in document.robot.poses:
            _pose_row(page, own)

    def ready() -> None:
        button.set_enabled(bool(poser.held))

    button.on_click(store)
    name.on("keydown.enter", store)
    page.on_new(Topic.ROBOT, lambda: tuple(document.robot.poses), rows, draw)
    page.on(Topic.THINGS, ready)
    page.on(Topic.SHAPE, ready)


def _pose_row(page: WindowPage, name: str) -> None:
    """One pose: a click shows it."""
    poser = page.session.poser
    with ui.element("div").classes("studio-row").style("min-height: 32px; gap: 2px"):
        show = ui.button(name, icon="accessibility_new", on_click=page.doing(poser.show_pose, name), color=None)
        show.props("flat dense no-caps align=left").classes("flex-1").style("min-width: 0; color: var(--ink)")
        show.tooltip("Go there").mark(f"pose-show-{name}")
        for icon, words, action in (
            ("edit", "Rename", lambda: _ask_name(page, name)),
            ("delete_outline", "Delete", page.doing(poser.delete_pose, name)),
        ):
            icon_button(icon, f"{words} {name}", action).style("color: var(--muted)")


def _ask_name(page: WindowPage, old: str) -> None:
    """Ask for another name of a pose."""
    with page.panel, ui.dialog(value=True) as dialog, ui.card().classes("q-pa-md").style("min-width: 300px"):
        ui.label(f"Rename {old}").classes("studio-title")
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
        ui.label("Reach").classes("studio-section")
        with ui.element("div").classes("studio-row"):
            marker = ui.select([], label=None).props('dense outlined options-dense aria-label="Marker"')
            marker.classes("flex-1").style("min-width: 0").mark("pose-reach-marker")
            start = ui.button("Show", icon="scatter_plot").props("unelevated no-caps").mark("pose-reach")
            start.tooltip("All that this marker can reach with its winches")
            stop = ui.button("Stop", icon="stop", on_click=page.doing(poser.reach.stop)).props("unelevated no-caps")
            clear = icon_button("close", "Hide the cloud", page.doing(poser.reach.clear))
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
        words.set_text(f"{reach.count} places of {reach.marker}" + (" so far" if reach.running else ""))

    page.on(Topic.ROBOT, draw)
    page.on((Topic.THINGS, Topic.JOB), show)
