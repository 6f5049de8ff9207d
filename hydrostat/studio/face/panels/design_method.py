"""`design_method`: which search, and the knobs of the thesis's (R39, R40, R43, R46)."""

from typing import Any

from nicegui import ui

from hydrostat.design import DesignMethod
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage
from hydrostat.studio.face.panels.design_limits import number_box

METHODS = {DesignMethod.ROUTES: "routes", DesignMethod.TREES: "winch trees"}

HINT = "Search of Chang (2018): trees of cables grow from the strongest muscles. It returns one network."


def design_method(page: WindowPage) -> None:
    """Build the rows; the knobs are there for winch trees alone."""
    designer = page.session.designer
    with ui.element("div").classes("studio-row"):
        ui.label("Search").classes("flex-1")
        choice = ui.toggle(METHODS, value=designer.wishes.method).props('dense no-caps unelevated padding="2px 10px"')
        choice.props("toggle-color=primary color=transparent text-color=primary toggle-text-color=white")
        choice.classes("design-toggle").props('data-testid="wish-method"')
    with ui.column().classes("w-full").style("gap: 8px") as room:
        ui.label(HINT).classes("studio-hint")
        with ui.element("div").classes("studio-row"):
            shows = [number_box(page, "Fibers kept", "threshold"), number_box(page, "phi, 0 to 1", "phi")]
        with ui.element("div").classes("studio-row"):
            shows += [
                number_box(page, "Maximum gap", "distance", "edges"),
                number_box(page, "Fibers joined", "steps"),
            ]

    def send(value: Any) -> None:
        if value is not None and value != designer.wishes.method:
            page.act(lambda: designer.wish(method=value))

    def show() -> None:
        wishes = designer.wishes
        choice.set_value(wishes.method)
        room.set_visibility(wishes.method is DesignMethod.TREES)
        for refresh in shows:
            refresh(wishes)

    choice.on_value_change(lambda event: send(event.value))
    page.on(Topic.ROBOT, show)
