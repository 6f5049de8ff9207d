"""The choice of the search, and the knobs of the thesis's, which act immediately."""

from typing import Any

from nicegui import ui

from hydrostat.design import DesignMethod
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage
from hydrostat.studio.face.panels.design_limits import Show, number_box

METHODS = {DesignMethod.ROUTES: "routes", DesignMethod.CHANG2018: "Chang (2018)"}

HINT = "The search as published: cables grow along the strongest muscles. Each change shows its network immediately."

NO_SPREAD = "Each winch pulls one cable, so there is no spread: phi only weighs contraction against the leads."


def design_method(page: WindowPage) -> None:
    """Build the rows; the knobs are there for the thesis's search alone."""
    designer, document = page.session.designer, page.session.document
    with ui.element("div").classes("studio-row"):
        ui.label("Search").classes("flex-1")
        choice = ui.toggle(METHODS).props('dense no-caps unelevated padding="2px 10px"')
        choice.props("toggle-color=primary color=transparent text-color=primary toggle-text-color=white")
        choice.classes("design-toggle").props('data-testid="wish-method" role="group" aria-label="Search"')
    edge = 1e3 * float(document.robot.body.mesh.edge_lengths.mean())
    with ui.column().classes("w-full").style("gap: 8px") as room:
        ui.label(HINT).classes("studio-hint")
        shows = [
            _knob(page, "Activation threshold", "threshold", "fibers", "Number of fibers that cables may follow."),
            _knob(
                page, "Nearest-fiber distance", "distance", "edges",
                f"Largest gap between two fibers of a cable, in mesh edges of {edge:.0f} mm.",
            ),
            _knob(page, "Cable length", "steps", "fibers", "Maximum number of fibers that are joined to one cable."),
            _knob(
                page, "Score weight phi", "phi", "0 to 1",
                "Weight of the mean contraction in the score of a winch. The spread among its cables has the "
                "remaining weight.",
            ),
        ]  # fmt: skip
        spread = ui.label(NO_SPREAD).classes("studio-hint").props('data-testid="design-no-spread"')

    def send(value: Any) -> None:
        if value is not None and value is not _find_method(designer.wishes.method):
            page.act(lambda: designer.wish(method=value))

    def show() -> None:
        wishes = designer.wishes
        choice.set_value(_find_method(wishes.method))
        room.set_visibility(wishes.method.grows_trees)
        spread.set_visibility(0 < wishes.winches == wishes.cables)
        for refresh in shows:
            refresh(wishes)

    choice.on_value_change(lambda event: send(event.value))
    page.on(Topic.ROBOT, show)


def _find_method(method: DesignMethod) -> DesignMethod:
    """Find the choice that stands for a method: winch trees of one setting are the thesis's search."""
    return DesignMethod.CHANG2018 if method.grows_trees else method


def _knob(page: WindowPage, words: str, name: str, unit: str, sentence: str) -> Show:
    """A box for one knob, with a sentence on it."""
    with ui.column().classes("w-full").style("gap: 2px"):
        with ui.element("div").classes("studio-row"):
            show = number_box(page, words, name, unit)
        ui.label(sentence).classes("studio-hint")
    return show
