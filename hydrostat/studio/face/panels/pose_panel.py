"""The panel of the stage "pose": what moves the body, what is held, what the winches do, poses."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import Page
from hydrostat.studio.face.panels.pose_bars import bars_card
from hydrostat.studio.face.panels.pose_held import held_card
from hydrostat.studio.face.panels.pose_poses import poses_card
from hydrostat.studio.face.panels.pose_reach import reach_card
from hydrostat.studio.posing.held import Mode

MODES = {Mode.CABLES: "Cables", Mode.MUSCLES: "Muscles"}

HINTS = {
    Mode.CABLES: "Drag a marker or any point of the body: the winches find what to take in.",
    Mode.MUSCLES: "Drag a marker or any point of the body: it follows as if it were full of muscles.",
}


def pose_panel(page: Page) -> None:
    """Build the panel."""
    poser = page.session.poser
    with ui.element("div").classes("studio-row"):
        ui.label("Pose").classes("studio-title")
        ui.space()
        rest = ui.button("Rest", icon="restart_alt", on_click=page.doing(poser.rest), color=None)
        rest.props("flat dense no-caps").style("color: var(--accent)")
        rest.tooltip("No targets, all cable let out (R)").mark("pose-rest")
    choice = ui.toggle(MODES, value=poser.mode).props("spread no-caps unelevated toggle-color=primary")
    choice.classes("w-full").style("flex: none; border-radius: 10px; overflow: hidden; border: 1px solid var(--line)")
    choice.mark("pose-mode")
    hint = ui.label().classes("studio-hint").style("min-height: 38px")

    def choose() -> None:
        if choice.value is not poser.mode:
            page.act(poser.set_mode, choice.value)
            choice.set_value(poser.mode)

    def show() -> None:
        choice.set_value(poser.mode)
        words = "Click where it should go." if poser.armed else HINTS[poser.mode]
        if hint.text != words:
            hint.set_text(words)

    choice.on_value_change(choose)
    page.on(Topic.THINGS, show)
    held_card(page)
    bars_card(page)
    poses_card(page)
    reach_card(page)
