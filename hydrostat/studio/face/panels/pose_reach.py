"""`reach_card`: all that a marker can reach, as a cloud on demand."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import Page
from hydrostat.studio.posing.held import Mode


def reach_card(page: Page) -> None:
    """Build the choice of a marker and what begins and ends the search."""
    poser, document = page.session.poser, page.session.document
    with ui.column().classes("w-full").style("gap: 6px") as room:
        ui.label("Reach").classes("studio-section")
        with ui.element("div").classes("studio-row"):
            marker = ui.select([], label=None).props('dense outlined options-dense aria-label="Marker"')
            marker.classes("flex-1").style("min-width: 0").mark("pose-reach-marker")
            start = ui.button("Show", icon="scatter_plot").props("unelevated no-caps").mark("pose-reach")
            start.tooltip("All that this marker can reach with its winches")
            stop = ui.button("Stop", icon="stop", on_click=page.doing(poser.reach.stop)).props("unelevated no-caps")
            clear = ui.button(icon="close", on_click=page.doing(poser.reach.clear), color=None)
            clear.props('flat round dense size=sm aria-label="Hide the cloud"').tooltip("Hide")
        words = ui.label().classes("studio-hint studio-figure")
    start.on_click(lambda: page.act(poser.reach.start, marker.value or ""))

    def draw() -> None:
        names = [own.name for own in document.robot.markers]
        if marker.options != names or marker.value not in names:
            kept = marker.value if marker.value in names else (poser.reach.marker or next(iter(names), None))
            marker.set_options(names, value=kept if kept in names else None)
        show()

    def show() -> None:
        reach = poser.reach
        room.set_visibility(poser.mode is Mode.CABLES and bool(document.robot.markers))
        start.set_visibility(not reach.running)
        stop.set_visibility(reach.running)
        clear.set_visibility(bool(reach.marker) and not reach.running)
        words.set_visibility(bool(reach.marker))
        words.set_text(f"{reach.count} places of {reach.marker}" + (" so far" if reach.running else ""))

    page.on(Topic.ROBOT, draw)
    page.on(Topic.THINGS, show)
    page.on(Topic.JOB, show)
