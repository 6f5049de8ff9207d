"""The card of photographs: drop them on a pose, look at the overlay, fit the robot."""

import base64
from functools import partial

from nicegui import events, ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage, icon_button, name_upload, show_heading
from hydrostat.studio.posing import MAX_BYTES, Mode, PhotographFit
from hydrostat.studio.session import Tone
from hydrostat.studio.stage import format_error
from hydrostat.units import plural

HINT = (
    "Photographs of the built robot with its printed tags. Each shows the pose on the screen, or the one that its name "
    "holds, such as left=12mm.jpg. Begin the names with numbers for a motion: 03 left=12mm.jpg."
)


def photographs_card(page: WindowPage) -> None:
    """Build the card; with muscles there is none."""
    photographs, poser, document = page.session.photographs, page.session.poser, page.session.document

    async def load(event: events.UploadEventArguments) -> None:
        content = await event.file.read()
        pulls = {bar.winch: bar.contraction for bar in poser.bars()}
        page.act(photographs.add, event.file.name, content, pulls)

    def compare() -> None:
        upload.reset()
        page.act(photographs.compare)

    with ui.column().classes("w-full").style("gap: 6px") as room:
        show_heading("Photographs")
        with ui.element("div").classes("studio-card column").style("gap: 8px"):
            ui.label(HINT).classes("studio-hint")
            upload = ui.upload(
                label="Choose or drop", multiple=True, auto_upload=True, max_file_size=MAX_BYTES, on_upload=load,
                on_rejected=lambda: page.tell(f"a photograph may have {MAX_BYTES // 10**6} MB", Tone.BAD),
            ).props("accept=image/* flat bordered").classes("w-full").style("max-height: 130px")  # fmt: skip
            name_upload(upload, "Choose photographs").mark("pose-photographs")
            rows = ui.column().classes("w-full").style("gap: 2px")
            error = ui.label().classes("studio-hint").style("color: var(--q-negative)").mark("pose-photographs-error")
            error.props("role=alert")
            with ui.element("div").classes("studio-row"):
                look = ui.button("Compare", icon="compare", on_click=compare).props("unelevated no-caps size=sm")
                look.tooltip("Find the tags and draw the simulated robot into each photograph")
                fit = ui.button("Fit", icon="tune", on_click=page.doing(photographs.start_fit))
                fit.props("unelevated no-caps size=sm").tooltip(
                    "Find the moduli and spools that these photographs show"
                )
                take = ui.button("Apply", icon="check", on_click=page.doing(photographs.apply))
                take.props("unelevated no-caps size=sm").tooltip("Put the fitted values into the robot")
            values = ui.column().classes("w-full").style("gap: 2px")
    look.mark("pose-photographs-compare")
    fit.mark("pose-photographs-fit")
    take.mark("pose-photographs-apply")

    def show() -> None:
        room.set_visibility(poser.mode is Mode.CABLES and bool(document.robot.markers))
        is_free = not page.session.jobs.is_running
        look.set_enabled(is_free and bool(photographs.files) and photographs.comparison is None)
        fit.set_enabled(is_free and photographs.comparison is not None)
        take.set_visibility(photographs.fit is not None)
        take.set_enabled(is_free and photographs.fit is not None and not photographs.is_applied)
        take.set_text("Applied" if photographs.is_applied else "Apply")
        error.set_text(photographs.error)
        error.set_visibility(bool(photographs.error))

    topics = (Topic.SCENE, Topic.JOB, Topic.ROBOT)
    page.on_new(topics, lambda: (photographs.files, photographs.comparison), rows, lambda: _draw_rows(page))
    page.on_new(topics, lambda: photographs.fit, values, lambda: _draw_values(photographs.fit))
    page.on(topics, show)


def _draw_rows(page: WindowPage) -> None:
    """A row for each photograph: its name opens the overlay; then warnings."""
    photographs = page.session.photographs
    for file in photographs.files:
        found = photographs.find(file.name)
        with ui.element("div").classes("studio-row").style("min-height: 28px; gap: 4px"):
            name = ui.button(file.name, icon="photo", color=None).props("flat dense no-caps align=left size=sm")
            name.classes("flex-1").style("min-width: 0; overflow: hidden; color: var(--ink)")
            name.set_enabled(found is not None)
            name.on_click(partial(_show_overlay, page, file.name)).mark(f"pose-photograph-{file.name}")
            if found is not None and found.errors:
                most, error = max(found.errors.items(), key=lambda pair: pair[1])
                figure = ui.label(format_error(error)).classes("studio-figure").style("white-space: nowrap")
                figure.tooltip(f"Farthest from its simulated position: {most}")
            icon_button("close", f"Remove {file.name}", page.doing(photographs.remove, file.name))
    comparison = photographs.comparison
    for text in comparison.warnings if comparison else ():
        ui.label(f"Warning: {text}").classes("studio-hint")


def _show_overlay(page: WindowPage, name: str) -> None:
    """Show a photograph with the simulated robot, and the distance of each marker."""
    found = page.session.photographs.find(name)
    if found is None:
        return
    with page.panel, ui.dialog(value=True) as dialog, ui.card().style("max-width: 92vw; gap: 8px"):
        with ui.element("div").classes("studio-row"):
            show_heading(name, 1)
            ui.space()
            icon_button("close", "Close", dialog.close)
        picture = base64.b64encode(found.overlay).decode()
        ui.image(f"data:image/png;base64,{picture}").style("width: min(86vw, 1000px)").props(
            f'alt="{plural(len(found.errors), "marker")} measured and simulated"'
        )
        words = ", ".join(f"{marker} {format_error(error)}" for marker, error in found.errors.items())
        ui.label(words or "The simulated robot reaches no equilibrium here.").classes("studio-figure")
    dialog.on("hide", dialog.delete)


def _draw_values(fit: PhotographFit | None) -> None:
    """The fitted values with their intervals, and those that the photographs do not show."""
    if fit is None:
        return
    ui.label(f"RMS error {format_error(fit.before)} before, {format_error(fit.after)} fitted").classes("studio-figure")
    for one in fit.values:
        if one.is_shown:
            times, unit = _unit(one.unit, one.value)
            value, low, high, assumed = (f"{times * each:.3g}" for each in (one.value, one.low, one.high, one.assumed))
            with ui.element("div").classes("studio-row").style("font-size: 13px; min-height: 22px"):
                ui.label(one.name).classes("flex-1").style("min-width: 0")
                figure = ui.label(f"{value}{unit} ({low} to {high})").classes("studio-figure")
                figure.tooltip(f"Interval of 95 %. Assumed {assumed}{unit}")
    if hidden := [one.name for one in fit.values if not one.is_shown]:
        ui.label(f"Not shown by these photographs: {', '.join(hidden)}").classes("studio-hint")


def _unit(unit: str, value: float) -> tuple[float, str]:
    """Factor and unit in which a value has few digits."""
    million = 1e6
    if unit == "Pa":
        return (1e-6, " MPa") if value >= million else (1e-3, " kPa")
    return (1e-3, " N/mm") if unit == "N/m" else (1.0, f" {unit}" if unit else "")
