"""`design_paint`: paints for zones on the body, and the zones that are there."""

from functools import partial

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.designing.painter import WORDS
from hydrostat.studio.designing.zones import COLOURS
from hydrostat.studio.face.page import Page
from hydrostat.studio.records.wishes import Paint

SHORT = {Paint.KEEP_OUT: "No cable here", Paint.WINCH_ZONES: "Winches only here", Paint.STILL: "Keep this still"}

FLAT = "Drag on the body from the middle outward. With Shift, draw round a part; or click corner after corner."
SPACE = "Drag on the body from the middle of a ball outward."
CHOSEN = "Drag it to move it, drag its handle to shape it. Delete removes it."


def design_paint(page: Page) -> None:
    """Build the section."""
    designer, document = page.session.designer, page.session.document
    ui.label("Painted on the body").classes("studio-section")
    buttons: dict[Paint, ui.element] = {}
    with ui.element("div").classes("studio-row").style("gap: 6px; align-items: stretch"):
        for paint, words in SHORT.items():
            button = ui.element("div").classes("design-paint").style(f"--tint: {COLOURS[paint]}")
            button.props(f'role="button" tabindex="0" data-testid="paint-{paint}"')
            for event in ("click", "keydown.enter"):
                button.on(event, partial(_take, page, paint))
            with button:
                ui.element("span").classes("design-spot")
                ui.label(words)
            buttons[paint] = button
    hint = ui.label().classes("studio-hint")
    zones = ui.column().classes("w-full").style("gap: 2px")
    drawn: list[object] = []

    def show() -> None:
        painter = designer.painter
        for paint, button in buttons.items():
            button.classes(**{"add" if paint is painter.paint else "remove": "design-paint-on"})
        flat = document.robot.body.mesh.dim == 2
        hint.set_text((FLAT if flat else SPACE) if painter.paint else CHOSEN if painter.chosen is not None else "")
        hint.set_visibility(bool(hint.text))
        state = (tuple(designer.wishes.zones), painter.chosen)
        if drawn == [state]:
            return
        drawn[:] = [state]
        zones.clear()
        with zones:
            for index, (paint, zone) in enumerate(designer.wishes.zones):
                size = f", {2e3 * zone.radius:.0f} mm" if zone.radius is not None else ""
                _zone(page, index, paint, size, chosen=index == painter.chosen)

    page.on(Topic.THINGS, show)


def _take(page: Page, paint: Paint) -> None:
    designer = page.session.designer
    page.act(designer.take, None if designer.painter.paint is paint else paint)


def _zone(page: Page, index: int, paint: Paint, size: str, *, chosen: bool) -> None:
    designer = page.session.designer
    row = ui.element("div").classes("studio-row design-zone" + (" design-zone-on" if chosen else ""))
    row.on("click", page.doing(designer.choose_zone, index))
    with row.style(f"--tint: {COLOURS[paint]}"):
        ui.element("span").classes("design-spot")
        ui.label(WORDS[paint] + size).classes("flex-1").style("font-size: 13px")
        remove = ui.button(icon="close", color=None).props('flat round dense size=sm aria-label="Delete this zone"')
        remove.on("click.stop", page.doing(designer.painter.remove, index))
