"""`view_bar`: how the body is looked at, in this window."""

from nicegui import ui

from hydrostat.drawing import Color
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage, icon_button
from hydrostat.studio.view.coloring import Coloring

RAMP = Color.TENSION

AXES = {"off": None, "x": "x", "y": "y", "z": "z"}

COLORINGS = {
    Coloring.FELT: "Felt",
    Coloring.STRAIN: "Strain",
    Coloring.STRESS: "Stress",
    Coloring.MUSCLES: "Muscles",
}


def view_bar(page: WindowPage, *, colors: bool = True) -> None:
    """Buttons in a corner of the view, that for colors, which all windows share, if wanted; a legend in another."""
    _legend(page)
    view = page.viewport
    with ui.element("div").classes("studio-view-bar").props('role="toolbar" aria-label="View"'):
        icon_button("fit_screen", "Fit", view.fit)
        space = ui.element("div").classes("column gap-1")
        with space:
            icon_button("crop_portrait", "Front (1)", lambda: view.view("front"))
            icon_button("flip", "Side (3)", lambda: view.view("side"))
            icon_button("layers", "Top (7)", lambda: view.view("top"))
            with icon_button("view_in_ar", "View options", None):
                _space_menu(page)
        if colors:
            with icon_button("palette", "Colors", None):
                _color_menu(page)
        mesh = icon_button("grid_4x4", "Mesh", None)
        mesh.on_click(lambda: _toggle_mesh(page, mesh))

    def show() -> None:
        document = page.session.document
        space.set_visibility(document.is_open and document.robot.body.mesh.dim == 3)

    page.on(Topic.ROBOT, show, lasting=True)


def _legend(page: WindowPage) -> None:
    """Build the legend of the body's colors, in another corner."""
    with ui.element("div").classes("studio-legend") as box:
        title = ui.label()
        ui.element("div").classes("studio-legend-bar").style(f"background: linear-gradient(90deg, {', '.join(RAMP)})")
        with ui.element("div").classes("studio-row"):
            low = ui.label()
            ui.space()
            high = ui.label()

    def show() -> None:
        scale = page.session.legend
        box.set_visibility(scale is not None)
        if scale is not None:
            for label, text in ((title, scale.title), (low, scale.low), (high, scale.high)):
                label.set_text(text)

    page.on(Topic.SCENE, show, lasting=True)


def _space_menu(page: WindowPage) -> None:
    view = page.viewport
    with ui.menu(), ui.column().classes("q-pa-md gap-2").style("min-width: 220px"):
        ui.switch("Perspective", value=True, on_change=lambda event: view.orthographic(not event.value))
        ui.label("Opacity").classes("studio-section")
        ui.slider(
            min=0.1, max=1.0, step=0.05, value=1.0, on_change=lambda event: view.opacity(event.value or 1.0)
        ).props('aria-label="Opacity"')
        ui.label("Section").classes("studio-section")
        share = ui.slider(min=0.0, max=1.0, step=0.01, value=0.5).props('aria-label="Place of the section"')
        axis = ui.toggle(list(AXES), value="off").props('dense no-caps role="group" aria-label="Section"')
        for control in (share, axis):
            control.on_value_change(lambda: view.section(AXES[axis.value], share.value or 0.0))


def _color_menu(page: WindowPage) -> None:
    session = page.session
    with ui.menu(), ui.column().classes("q-pa-md gap-2"):
        choice = ui.radio(COLORINGS, value=session.coloring)
        choice.on_value_change(lambda event: page.act(session.color_by, event.value))
    page.on(Topic.SCENE, lambda: choice.set_value(session.coloring), lasting=True)


def _toggle_mesh(page: WindowPage, button: ui.button) -> None:
    shown = "flat" in button.props
    button.props(remove="flat" if shown else "outline", add="outline" if shown else "flat")
    button.props(f'aria-pressed="{str(shown).lower()}"')
    page.viewport.mesh(shown)
