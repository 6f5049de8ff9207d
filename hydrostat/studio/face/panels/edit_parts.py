"""`parts_list`: all parts of the robot, to choose from."""

from nicegui import ui

from hydrostat.plot.palette import winch_colours
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.part import Kind, find_part, keys_of
from hydrostat.studio.face.page import Page

HEIGHT = "188px"
"""Of the list; longer ones are scrolled."""

ICONS = {Kind.PIN: "push_pin", Kind.WINCH: "album", Kind.CABLE: "timeline", Kind.MARKER: "my_location"}


def parts_list(page: Page) -> None:
    """Build the list."""
    editor, document = page.session.editor, page.session.document
    with ui.element("div").classes("studio-row"):
        ui.label("Parts").classes("studio-section")
        ui.space()
        count = ui.label().classes("studio-hint studio-figure").style("margin-top: 8px")
    box = (
        ui.column()
        .classes("w-full")
        .style(
            f"max-height: {HEIGHT}; overflow-y: auto; gap: 0; flex-wrap: nowrap; border: 1px solid var(--line);"
            "border-radius: 12px; padding: 4px; flex-shrink: 0"
        )
    )
    rows: dict[str, ui.element] = {}
    shown: list[list[tuple[str, str, str]]] = []

    def show() -> None:
        entries = [(key, *_words(document.robot, key)) for key in keys_of(document.robot)]
        if shown != [entries]:
            shown[:] = [entries]
            box.clear()
            rows.clear()
            with box:
                for key, words, number in entries:
                    rows[key] = _row(page, document.robot, key, words, number)
            count.set_text(f"{len(entries)}")
        chosen = editor.chosen
        if chosen.startswith("via:"):
            chosen = f"cable:{chosen.split(':')[1]}"
        for key, row in rows.items():
            row.style("background: color-mix(in srgb, var(--accent) 16%, transparent)" if key == chosen else
                      "background: transparent")  # fmt: skip

    page.on(Topic.THINGS, show)


def _row(page: Page, robot: Robot, key: str, words: str, number: str) -> ui.element:
    part = find_part(robot, key)
    kind = Kind.PIN if part is None else part.kind
    row = ui.element("div").classes("studio-row cursor-pointer").mark(f"part-{key}")
    row.style(
        f"padding: 3px 8px 3px {24 if kind is Kind.CABLE else 8}px; border-radius: 8px; font-size: 13px; flex-shrink: 0"
    )
    row.on("click", page.doing(page.session.editor.choose, key))
    with row:
        ui.icon(ICONS[kind], size="17px").style(f"color: {_colour(robot, key)}")
        ui.label(words).style("overflow: hidden; text-overflow: ellipsis; white-space: nowrap")
        ui.space()
        ui.label(number).classes("studio-hint studio-figure").style("white-space: nowrap")
    return row


def _words(robot: Robot, key: str) -> tuple[str, str]:
    """Name of a part, and a number that tells it from others."""
    part = find_part(robot, key)
    if part is None:
        return key, ""
    if part.kind is Kind.CABLE:
        return f"Cable {part.index + 1}", f"{1e3 * robot.cables[part.index].length:.0f} mm"
    if part.kind is Kind.PIN:
        radius = robot.pins[part.index].radius
        return f"Pin {part.index + 1}", f"{1e3 * radius:.3g} mm" if radius else "box"
    if part.kind is Kind.WINCH:
        return robot.winches[part.index].name, "winch"
    return robot.markers[part.index].name, "marker"


def _colour(robot: Robot, key: str) -> str:
    """That of its winch; the quiet one for all else."""
    part, colours = find_part(robot, key), winch_colours(robot)
    if part is not None and part.kind is Kind.WINCH:
        return _seen(colours[robot.winches[part.index].name])
    if part is not None and part.kind is Kind.CABLE:
        return _seen(colours[robot.cables[part.index].winch])
    return "var(--muted)"


def _seen(colour: str) -> str:
    """A colour of the view on a page that is light or dark."""
    return f"color-mix(in srgb, {colour} 78%, var(--ink))"
