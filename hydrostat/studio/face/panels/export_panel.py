"""The panel of the stage "export": how a kit is made and what came of it, report, pictures, and the robot itself."""

import base64
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from nicegui import ui

from hydrostat.fabrication import ALL_MOTORS, KitOptions, Method, MoldKind, Paper
from hydrostat.studio.bell import Topic
from hydrostat.studio.exporting.download import Download, file_name
from hydrostat.studio.exporting.exporter import Export
from hydrostat.studio.exporting.kit_work import KitMade
from hydrostat.studio.face.page import WindowPage, show_heading
from hydrostat.studio.face.panels.cable_faces import face_choice
from hydrostat.studio.face.panels.finding_list import finding_list
from hydrostat.studio.stage import StageName
from hydrostat.units import plural

OUTDATED = "Outdated: the robot has changed. Make it again."


def export_panel(page: WindowPage) -> None:
    """Build the panel."""
    show_heading("Export", 1)
    ui.label("Nothing is written to your disk until you download it.").classes("studio-hint")
    _kit_card(page)
    _report_card(page)
    _pictures_card(page)
    _robot_card(page)


def _kit_card(page: WindowPage) -> None:
    exporter = page.session.exporter
    with _card("Kit", "All files to build the robot: patterns or molds, parts to print, lists and an assembly sheet."):
        bare = ui.column().classes("w-full gap-2")
        with bare:
            ui.label("No cables yet. A kit needs winches and cables.").classes("studio-hint")
            design = ui.button("Go to Design", icon="auto_awesome", on_click=lambda: page.go(StageName.DESIGN))
            design.props("outline no-caps").classes("w-full").props('data-testid="export-design"')
        with ui.column().classes("w-full gap-2") as work:
            face_choice(page)
            kit_choices(page)
            finding_list(page, lambda: page.session.document.robot)
            _maker(page, Export.KIT, "Build kit", "inventory_2", exporter.make_kit, lambda: exporter.kit)
            _result(page, Export.KIT, lambda: exporter.kit, lambda: kit_result(page))

    def show() -> None:
        has = page.session.document.is_open and bool(page.session.document.robot.cables)
        bare.set_visibility(not has)
        work.set_visibility(has)

    page.on(Topic.ROBOT, show)


def _report_card(page: WindowPage) -> None:
    exporter = page.session.exporter
    words = "One page with the robot, its network and its poses, with errors and tensions."
    with _card("Report", words):
        _maker(page, Export.REPORT, "Write report", "article", exporter.make_report, lambda: exporter.report)

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
        _maker(page, Export.PICTURES, "Draw pictures", "image", exporter.make_pictures, lambda: exporter.pictures)
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

        button = ui.button("Download robot", icon="download", on_click=save).props("outline no-caps")
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
            stage = ui.label().classes("studio-hint flex-1").props("role=status")
            stop = ui.button("Stop", on_click=jobs.stop).props("flat dense no-caps size=sm")
        bar = ui.linear_progress(value=0.0, show_value=False).props(f'rounded size=6px aria-label="{words}"')
    failed = ui.label().classes("export-failed").props(f'data-testid="failed-{export}" role="alert"')

    def show() -> None:
        busy, state = exporter.busy is export, jobs.state
        button.set_visibility(not busy)
        button.set_enabled(not jobs.is_running)
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
    """Build the card of an export result, redrawn when the result changes."""
    exporter = page.session.exporter
    room = ui.column().classes("export-room w-full gap-2").props(f'data-testid="result-{export}"')
    drawn: list[object] = [object()]

    def show() -> None:
        found = None if exporter.busy is export else find()
        state = (found, exporter.is_outdated(export))
        if all(now is before for now, before in zip(state, drawn, strict=False)) and len(drawn) == len(state):
            return
        drawn[:] = state
        room.clear()
        with room:
            if found is not None:
                build()
            elif exporter.is_outdated(export) and exporter.busy is not export:
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
        show_heading(title).style("margin-top: 0")
        ui.label(words).classes("studio-hint")
    return card


METHODS = {"": "Auto", Method.PLUSH.value: "Plush", Method.FOAM.value: "Foam", Method.PRINT.value: "Print"}

PAPERS = {Paper.A4.value: "A4", Paper.LETTER.value: "Letter"}

MOULDS = {MoldKind.PRINTED.value: "Printed", MoldKind.SILICONE.value: "Silicone"}


def kit_choices(page: WindowPage) -> None:
    """Method, motor and paper; the rest behind a door."""
    exporter = page.session.exporter
    given: dict[str, Any] = {}
    motors = {"auto": "Auto: the robot's, or the cheapest", **{motor.key: motor.title for motor in ALL_MOTORS}}
    with ui.element("div").classes("export-form"):
        ui.label("Body")
        given["method"] = ui.toggle(METHODS).props('dense no-caps unelevated data-testid="kit-method"')
        given["method"].props('role="group" aria-label="Body"')
        ui.label("Motor")
        given["motor"] = ui.select(motors).props('dense outlined options-dense data-testid="kit-motor"')
        given["motor"].props('aria-label="Motor"')
        ui.label("Paper")
        given["paper"] = ui.toggle(PAPERS).props('dense no-caps unelevated role="group" aria-label="Paper"')
    given |= _more_choices()

    def show() -> None:
        for name, value in _control_values(exporter.options).items():
            given[name].set_value(value)

    def take() -> None:
        values = {name: control.value for name, control in given.items()}
        if all(value is not None for value in values.values()):
            page.act(lambda: exporter.choose(_options(exporter.options, values)))

    page.on(Topic.JOB, show)
    for control in given.values():
        control.on_value_change(take)


def _more_choices() -> dict[str, Any]:
    given: dict[str, Any] = {}
    door = ui.expansion("More options").props("dense").classes("export-more w-full")
    with door, ui.element("div").classes("export-form"):
        ui.label("Printer bed [mm]")
        with ui.element("div").classes("studio-row").style("gap: 4px"):
            for axis in "xyz":
                given[f"bed_{axis}"] = _length(f"bed along {axis}", 10.0)
        ui.label("Mold")
        given["mould"] = ui.toggle(MOULDS).props('dense no-caps unelevated role="group" aria-label="Mold"')
        ui.label("Seam [mm]")
        given["seam"] = _length("cloth between seam and cut", 1.0)
        ui.label("Cable [mm]")
        given["cable"] = _length("diameter of the cables", 0.1)
        ui.label("Clearance [mm]")
        given["clearance"] = _length("between printed parts that move in each other", 0.05)
    return given


def kit_result(page: WindowPage) -> None:
    """Show why there is no kit, or what is in it."""
    exporter = page.session.exporter
    kit = exporter.kit
    if kit is None:
        return
    if kit.zip is None:
        _show_refusal(page)
        return
    download_button(kit.zip)
    if _own_options(kit.options) != _own_options(exporter.options):
        ui.label("Built with other options than those above.").classes("studio-hint")
    for line in kit.summary:
        head, _, words = line.partition(": ")
        with ui.element("div").classes("export-line"):
            ui.label(head).classes("export-head")
            ui.label(words or "")
    _pages(kit)
    _lines("error", kit.problems, "error_outline", "export-bad")
    _lines("warning", kit.warnings, "info_outline", "export-mind")
    _lines("note", kit.notes, "info_outline", "export-note")
    _checks(kit)


def _own_options(options: KitOptions) -> KitOptions:
    """The options of a kit without those that follow from the robot."""
    return replace(options, force=False, tension=None, torque=None)


def _show_refusal(page: WindowPage) -> None:
    """Its reasons are among the findings above."""
    refused = show_heading("Errors prevent the kit").props('data-testid="kit-refused"')
    button = ui.button("Build anyway", on_click=page.doing(lambda: page.session.exporter.make_kit(force=True)))
    button.props("outline no-caps").classes("w-full").props('data-testid="make-forced"')
    ui.run_javascript(  # once it is drawn
        f"setTimeout(() => getHtmlElement({refused.id})?.scrollIntoView({{block: 'nearest', behavior: 'smooth'}}), 100)"
    )


def _pages(kit: KitMade) -> None:
    with ui.element("div").classes("export-grid"):
        if kit.pages:
            picture(kit.pages[0], "Assembly sheet", lambda: show_large(kit.pages, "Assembly sheet"))
        if kit.pattern is not None:
            pattern = kit.pattern
            picture(pattern, "Pattern", lambda: show_large([pattern], "Pattern", kind="svg"), kind="svg")


def _lines(level: str, lines: tuple[str, ...], icon: str, kind: str) -> None:
    if not lines:
        return
    door = ui.expansion(plural(len(lines), level), value=len(lines) < 3).props("dense")
    with door.classes("export-more w-full"):
        for line in lines:
            _line(line, icon, kind)


def _line(words: str, icon: str, kind: str) -> None:
    with ui.element("div").classes("export-told"):
        ui.icon(icon, size="18px").classes(kind)
        ui.label(words)


def _checks(kit: KitMade) -> None:
    with ui.expansion(kit.check_summary).props("dense").classes("export-more w-full").props('data-testid="kit-checks"'):
        for check in kit.checks:
            icon, kind = ("check_circle", "export-good") if check.passed else ("error_outline", "export-bad")
            with ui.element("div").classes("export-told"):
                ui.icon(icon, size="18px").classes(kind)
                with ui.column().classes("gap-0"):
                    ui.label(check.what)
                    ui.label(f"{check.measured}; allowed: {check.allowed}").classes("studio-hint")


def _length(words: str, step: float) -> ui.number:
    field = ui.number(min=0, step=step, format="%g").props(f'dense outlined aria-label="{words} [mm]"')
    return field.tooltip(f"{words} [mm]").classes("export-number")


def _control_values(options: KitOptions) -> dict[str, Any]:
    """The choices as the controls show them."""
    bed = dict(zip(("bed_x", "bed_y", "bed_z"), options.mould.bed, strict=True))
    return {
        "method": "" if options.method is None else options.method.value,
        "motor": options.motor,
        "paper": options.paper.value,
        "mould": options.mould.kind.value,
        "seam": options.pattern.seam_allowance,
        "cable": options.parts.cable,
        "clearance": options.parts.clearance,
        **bed,
    }


def _options(before: KitOptions, given: dict[str, Any]) -> KitOptions:
    """The choices of the controls (InputError: a length that cannot be)."""
    bed = (float(given["bed_x"]), float(given["bed_y"]), float(given["bed_z"]))
    return replace(
        before,
        method=Method(given["method"]) if given["method"] else None,
        motor=given["motor"],
        paper=Paper(given["paper"]),
        mould=replace(before.mould, kind=MoldKind(given["mould"]), bed=bed),
        pattern=replace(before.pattern, seam_allowance=float(given["seam"])),
        parts=replace(before.parts, cable=float(given["cable"]), clearance=float(given["clearance"])),
    )


def download_button(download: Download) -> None:
    """A button that hands over a file."""
    button = ui.button(on_click=lambda: send(download)).props("unelevated no-caps").classes("w-full")
    button.props(f'data-testid="download-{download.name}"')
    with button:
        ui.icon("download", size="20px").classes("q-mr-sm")
        ui.label(download.name).classes("ellipsis")
        ui.label(download.size).classes("export-size")


def send(download: Download) -> None:
    """Hand over a file to the person of this window."""
    ui.download.content(download.content, download.name, download.media_type)


def picture(content: bytes, title: str, enlarge: Callable[[], None], *, kind: str = "png") -> None:
    """A small picture that shows itself large when it is pressed."""
    label = title.replace('"', "'")
    button = ui.button(on_click=enlarge).props(f'flat no-caps padding=none aria-label="{label}, larger"')
    with button.classes("export-picture"), ui.column().classes("w-full gap-0"):
        ui.image(_address(content, kind)).props("fit=contain no-spinner no-transition").classes("export-thumb")
        ui.label(title).classes("export-caption")


def show_large(pictures: Sequence[bytes], title: str, download: Download | None = None, *, kind: str = "png") -> None:
    """Pictures below each other, as large as the window; they are gone when they are closed."""
    with ui.dialog() as dialog, ui.card().classes("export-large"):
        with ui.element("div").classes("studio-row"):
            ui.label(title).classes("studio-title flex-1")
            if download is not None:
                save = ui.button("Download", icon="download").props("flat no-caps")
                save.on_click(lambda: send(download))
            ui.button(icon="close", on_click=dialog.close).props('flat round dense aria-label="Close"')
        with ui.scroll_area().classes("export-pages"):
            for content in pictures:
                ui.image(_address(content, kind)).props("no-spinner no-transition").classes("export-page")
    dialog.on("hide", dialog.delete)
    dialog.open()


def _address(content: bytes, kind: str) -> str:
    """A picture as an address of its own, so that nothing in it can reach the page."""
    media = {"png": "image/png", "svg": "image/svg+xml"}[kind]
    return f"data:{media};base64,{base64.b64encode(content).decode()}"
