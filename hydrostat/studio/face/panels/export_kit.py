"""`kit_choices`, `kit_result`: how a kit is made, and what came of it; buttons and pictures of what was made."""

import base64
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from nicegui import ui

from hydrostat.fabrication import MOTORS, KitOptions, Method, MouldKind, Paper
from hydrostat.studio.bell import Topic
from hydrostat.studio.exporting.download import Download
from hydrostat.studio.exporting.kit_work import KitMade
from hydrostat.studio.face.page import WindowPage
from hydrostat.units import counted

METHODS = {"": "Auto", Method.PLUSH.value: "Plush", Method.FOAM.value: "Foam"}

PAPERS = {Paper.A4.value: "A4", Paper.LETTER.value: "Letter"}

MOULDS = {MouldKind.PRINTED.value: "Printed", MouldKind.SILICONE.value: "Silicone"}


def kit_choices(page: WindowPage) -> None:
    """Method, motor and paper; the rest behind a door."""
    exporter = page.session.exporter
    given: dict[str, Any] = {}
    motors = {"auto": "Auto, by strength", **{motor.key: motor.title for motor in MOTORS}}
    with ui.element("div").classes("export-form"):
        ui.label("Body")
        given["method"] = ui.toggle(METHODS).props("dense no-caps unelevated").props('data-testid="kit-method"')
        ui.label("Motor")
        given["motor"] = ui.select(motors).props("dense outlined options-dense").props('data-testid="kit-motor"')
        ui.label("Paper")
        given["paper"] = ui.toggle(PAPERS).props("dense no-caps unelevated")
    given |= _more_choices()

    def show() -> None:
        for name, value in _told(exporter.options).items():
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
    door = ui.expansion("More choices").props("dense").classes("export-more w-full")
    with door, ui.element("div").classes("export-form"):
        ui.label("Printer bed [mm]")
        with ui.element("div").classes("studio-row").style("gap: 4px"):
            for axis in "xyz":
                given[f"bed_{axis}"] = _length(f"bed along {axis}", 10.0)
        ui.label("Mould")
        given["mould"] = ui.toggle(MOULDS).props("dense no-caps unelevated")
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
        _refused(page, kit)
        return
    download_button(kit.zip)
    if replace(kit.options, force=False) != replace(exporter.options, force=False):
        ui.label("Made with other choices than those above.").classes("studio-hint")
    for line in kit.summary:
        head, _, words = line.partition(": ")
        with ui.element("div").classes("export-line"):
            ui.label(head).classes("export-head")
            ui.label(words or "")
    _pages(kit)
    _lines("that cannot be built well", kit.problems, "error_outline", "export-bad")
    _lines("to mind", kit.warnings, "info_outline", "export-mind")
    _checks(kit)


def _refused(page: WindowPage, kit: KitMade) -> None:
    refused = ui.label("It cannot be built well as it is").classes("studio-section").props('data-testid="kit-refused"')
    for reason in kit.refused:
        _line(reason, "error_outline", "export-bad")
    button = ui.button("Make it all the same", on_click=page.doing(lambda: page.session.exporter.make_kit(force=True)))
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


def _lines(words: str, lines: tuple[str, ...], icon: str, kind: str) -> None:
    if not lines:
        return
    door = ui.expansion(f"{counted(len(lines), 'thing')} {words}", value=len(lines) < 3).props("dense")
    with door.classes("export-more w-full"):
        for line in lines:
            _line(line, icon, kind)


def _line(words: str, icon: str, kind: str) -> None:
    with ui.element("div").classes("export-told"):
        ui.icon(icon, size="18px").classes(kind)
        ui.label(words)


def _checks(kit: KitMade) -> None:
    with ui.expansion(kit.told).props("dense").classes("export-more w-full").props('data-testid="kit-checks"'):
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


def _told(options: KitOptions) -> dict[str, Any]:
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
        mould=replace(before.mould, kind=MouldKind(given["mould"]), bed=bed),
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
