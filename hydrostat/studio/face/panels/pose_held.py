"""`held_card`: points that are held, how far each is from its target, and what keeps it from there."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import Page

GOOD = 5e-4
"""A marker so near to its target is there [m]."""


def held_card(page: Page) -> None:
    """Build the list."""
    poser = page.session.poser
    with ui.element("div").classes("studio-card"):
        empty = ui.label("Nothing is held.").classes("studio-hint")
        rows = ui.column().classes("w-full").style("gap: 2px")
        notes = ui.label().classes("studio-hint").style("white-space: pre-line; margin-top: 6px").mark("pose-notes")
    figures: dict[str, ui.label] = {}
    drawn: list[object] = []

    def draw() -> None:
        state = (tuple(poser.held), poser.chosen)
        if drawn == [state]:
            return
        drawn[:] = [state]
        rows.clear()
        figures.clear()
        empty.set_visibility(not poser.held)
        with rows:
            for name in poser.held:
                figures[name] = _row(page, name, poser.chosen == name)
        show()

    def show() -> None:
        shape = poser.shape()
        for name, label in figures.items():
            error = shape.errors.get(name)
            words = "" if error is None else f"{1e3 * error:.1f} mm"
            if label.text != words:
                label.set_text(words)
                near = error is not None and error < GOOD
                label.style(f"color: {'var(--q-positive)' if near else 'inherit'}")
        words = "\n".join(f"{note[:1].upper()}{note[1:]}" for note in shape.notes)
        if notes.text != words:
            notes.set_text(words)
        notes.set_visibility(bool(words))

    page.on(Topic.THINGS, draw)
    page.on(Topic.SHAPE, draw)
    page.on(Topic.SHAPE, show)


def _row(page: Page, name: str, chosen: bool) -> ui.label:
    """One point: a click chooses it, the cross lets it go."""
    poser = page.session.poser
    with ui.element("div").classes("studio-row").style("min-height: 30px"):
        ui.icon("radio_button_unchecked", size="16px").style(
            "color: var(--accent)" if chosen else "color: var(--muted)"
        )
        label = ui.label(name).style(
            f"font-weight: {600 if chosen else 400}; cursor: pointer; overflow: hidden; text-overflow: ellipsis;"
            "white-space: nowrap; min-width: 0"
        )
        label.on("click", page.doing(poser.choose, name))
        ui.space()
        figure = ui.label().classes("studio-figure").mark(f"pose-error-{name}")
        clear = ui.button(icon="close", on_click=page.doing(poser.clear, name), color=None)
        clear.props("flat round dense size=sm").style("color: var(--muted)")
        clear.props["aria-label"] = f"Let go of {name}"
        clear.tooltip("Let go")
    return figure
