"""`muscles_card`: which muscles pull, and the cables that would do the same (R38, X1)."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage
from hydrostat.studio.posing import Mode
from hydrostat.studio.told_error import told_error
from hydrostat.studio.view.colouring import Colouring
from hydrostat.units import plural


def muscles_card(page: WindowPage) -> None:
    """Build the switches; with cables there are none."""
    session, poser, document = page.session, page.session.poser, page.session.document
    with ui.column().classes("w-full").style("gap: 6px") as room:
        ui.label("Muscles").classes("studio-section")
        colours = ui.switch("Show muscle activation").props("dense").style("font-size: 13px").mark("pose-colours")
        propose = ui.switch("Propose cables while dragging").props("dense").mark("pose-propose")
        propose.style("font-size: 13px")
        with ui.element("div").classes("studio-row") as row:
            words = ui.label().classes("studio-hint studio-figure flex-1").style("min-width: 0").mark("pose-proposed")
            keep = ui.button("Keep", icon="check", on_click=page.doing(poser.proposals.keep))
            keep.props("unelevated no-caps size=sm").mark("pose-keep").tooltip("Add these cables to the robot")

    def colour(on: bool) -> None:
        if on != (session.colouring is Colouring.MUSCLES):
            page.act(session.colour_by, Colouring.MUSCLES if on else Colouring.FELT)

    def show() -> None:
        room.set_visibility(poser.mode is Mode.MUSCLES)
        colours.set_value(session.colouring is Colouring.MUSCLES)
        propose.set_value(poser.proposals.on)
        row.set_visibility(poser.proposals.on)
        words.set_text(_words())
        found = poser.proposals.network(document.robot)
        keep.set_visibility(found is not None)
        keep.set_enabled(found is not None and found.cables != document.robot.cables)

    def _words() -> str:
        found = poser.proposals.latest_proposal(document.robot)
        if found is None:
            return "Searching for cables" if poser.held else "Drag a point to get a proposal."
        if not found.cables:
            return f"{found.words[:1].upper()}{found.words[1:]}"
        off = "" if found.error is None else f", error {told_error(found.error)}"
        return f"{plural(len(found.winches), 'winch')}, {plural(len(found.cables), 'cable')}{off}"

    colours.on_value_change(lambda event: colour(bool(event.value)))

    def switch(on: bool) -> None:
        page.act(poser.proposals.switch, on)
        propose.set_value(poser.proposals.on)

    propose.on_value_change(lambda event: switch(bool(event.value)))
    page.on((Topic.THINGS, Topic.ROBOT), show)
