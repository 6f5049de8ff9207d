"""The panel of the stage "export": kit, report, pictures, and the robot itself."""

from collections.abc import Callable

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.exporting.download import file_name
from hydrostat.studio.exporting.exporter import Export
from hydrostat.studio.face.page import WindowPage
from hydrostat.studio.face.panels.export_kit import download_button, kit_choices, kit_result, picture, send, show_large
from hydrostat.studio.stage import StageName

OUTDATED = "The robot has changed since; make it again."


def export_panel(page: WindowPage) -> None:
    """Build the panel."""
    ui.label("Take it home").classes("studio-title")
    ui.label("Nothing is written to your disk until you download it.").classes("studio-hint")
    _kit_card(page)
    _report_card(page)
    _pictures_card(page)
    _robot_card(page)


def _kit_card(page: WindowPage) -> None:
    exporter = page.session.exporter
    with _card("Kit", "All files to build it: patterns or moulds, parts to print, lists, and a sheet to follow."):
        bare = ui.column().classes("w-full gap-2")
        with bare:
            ui.label("A kit needs winches and cables, and this robot has none yet.").classes("studio-hint")
            design = ui.button("Go to Design", icon="auto_awesome", on_click=lambda: page.go(StageName.DESIGN))
            design.props("outline no-caps").classes("w-full").props('data-testid="export-design"')
        with ui.column().classes("w-full gap-2") as work:
            kit_choices(page)
            _maker(page, Export.KIT, "Make the kit", "inventory_2", exporter.make_kit, lambda: exporter.kit)
            _result(page, Export.KIT, lambda: exporter.kit, lambda: kit_result(page))

    def show() -> None:
        has = page.session.document.is_open and bool(page.session.document.robot.cables)
        bare.set_visibility(not has)
        work.set_visibility(has)

    page.on(Topic.ROBOT, show)


def _report_card(page: WindowPage) -> None:
    exporter = page.session.exporter
    words = "One page of the robot, its network and what it reaches in each pose, with errors and tensions."
    with _card("Report", words):
        _maker(page, Export.REPORT, "Write the report", "article", exporter.make_report, lambda: exporter.report)

        def result() -> None:
            if exporter.report is not None:
                download_button(exporter.report)

        _result(page, Export.REPORT, lambda: exporter.report, result)


def _pictures_card(page: WindowPage) -> None:
    exporter, document = page.session.exporter, page.session.document
    with _card("Pictures", "Rest, network and poses as PNG, flat robots as SVG too."):
        with ui.element("div").classes("studio-row"):
            choice = ui.select({"": "At rest"}, label="In the view", value="").props("dense outlined options-dense")
            choice.classes("flex-1").props('data-testid="export-pose"')
            view = ui.button(icon="photo_camera", on_click=lambda: _save_view(page)).tooltip("This view as PNG")
            view.props('flat dense aria-label="This view as PNG" data-testid="export-view"')
        _maker(page, Export.PICTURES, "Draw all pictures", "image", exporter.make_pictures, lambda: exporter.pictures)
        _result(page, Export.PICTURES, lambda: exporter.pictures or None, lambda: _pictures(page))

    def show() -> None:
        robot = document.robot if document.is_open else None
        names = list(robot.poses) if robot is not None and robot.cables else []
        shown = exporter.pose if exporter.pose in names else ""
        choice.set_options({"": "At rest", **{name: name for name in names}}, value=shown)

    choice.on_value_change(lambda event: exporter.show(event.value or ""))
    page.on(Topic.ROBOT, show)


def _pictures(page: WindowPage) -> None:
    exporter = page.session.exporter
    with ui.element("div").classes("export-grid"):
        for drawn in exporter.pictures:
            if drawn.name.endswith(".png"):
                picture(drawn.content, drawn.title, lambda drawn=drawn: show_large([drawn.content], drawn.title, drawn))
    download_button(exporter.pictures_zip())


def _robot_card(page: WindowPage) -> None:
    exporter = page.session.exporter
    with _card("Robot", "The folder with robot.toml and the file of the body, as hydrostat opens it."):

        def save() -> None:
            found = page.act(exporter.robot_zip)
            if found is not None:
                send(found)

        button = ui.button("Download the robot", icon="download", on_click=save).props("outline no-caps")
        button.classes("w-full").props('data-testid="export-robot"')


def _maker(
    page: WindowPage, export: Export, words: str, icon: str, make: Callable[[], None], find: Callable[[], object]
) -> None:
    """The button that begins the work, quiet once there is a result, and while it runs how far it is."""
    exporter, jobs = page.session.exporter, page.session.jobs
    button = ui.button(words, icon=icon, on_click=page.doing(make)).props("unelevated no-caps").classes("w-full")
    button.props(f'data-testid="make-{export}"')
    with ui.column().classes("w-full gap-1") as progress:
        with ui.element("div").classes("studio-row"):
            stage = ui.label().classes("studio-hint flex-1")
            stop = ui.button("Stop", on_click=jobs.stop).props("flat dense no-caps size=sm")
        bar = ui.linear_progress(value=0.0, show_value=False).props("rounded size=6px")
    failed = ui.label().classes("export-failed").props(f'data-testid="failed-{export}"')

    def show() -> None:
        busy, state = exporter.busy is export, jobs.state
        button.set_visibility(not busy)
        button.set_enabled(not jobs.running)
        quiet = bool(find())
        button.props(remove="unelevated" if quiet else "flat", add="flat" if quiet else "unelevated")
        progress.set_visibility(busy)
        failed.set_text(exporter.errors.get(export, ""))
        failed.set_visibility(export in exporter.errors)
        if busy and state is not None:
            stage.set_text("stopping" if state.stopping else state.stage)
            stop.set_visibility(not state.stopping)
            known = state.total > 1
            bar.set_value(state.done / state.total if known else 0.0)
            bar.props(**{"remove" if known else "add": "indeterminate"})

    page.on((Topic.JOB, Topic.ROBOT), show)


def _result(page: WindowPage, export: Export, find: Callable[[], object], build: Callable[[], None]) -> None:
    """What was made, drawn anew when it is another."""
    exporter = page.session.exporter
    room = ui.column().classes("export-room w-full gap-2").props(f'data-testid="result-{export}"')
    drawn: list[object] = [object()]

    def show() -> None:
        found = None if exporter.busy is export else find()
        state = (found, exporter.outdated(export))
        if all(now is before for now, before in zip(state, drawn, strict=False)) and len(drawn) == len(state):
            return
        drawn[:] = state
        room.clear()
        with room:
            if found is not None:
                build()
            elif exporter.outdated(export) and exporter.busy is not export:
                ui.label(OUTDATED).classes("studio-hint").props(f'data-testid="outdated-{export}"')

    page.on((Topic.JOB, Topic.ROBOT), show)


def _save_view(page: WindowPage) -> None:
    """The view as it is on this screen, as a file; it goes straight from the screen to the disk."""
    document = page.session.document
    if document.is_open:
        name = f"{file_name(document.robot.name)}_view.png"
        ui.run_javascript(
            f"const url = await getElement({page.viewport.id}).picture();"
            f'const link = Object.assign(document.createElement("a"), {{href: url, download: "{name}"}});'
            "link.click();"
        )


def _card(title: str, words: str) -> ui.column:
    card = ui.column().classes("studio-card")
    with card:
        ui.label(title).classes("studio-section").style("margin-top: 0")
        ui.label(words).classes("studio-hint")
    return card
