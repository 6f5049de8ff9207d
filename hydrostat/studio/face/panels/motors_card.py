"""`motors_card`: motors that do what is shown: find them, arm them, hold them, see where they are."""

from math import isnan

from nicegui import ui

from hydrostat.control import EMULATED, LinkState
from hydrostat.drawing import Color
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage, show_heading

WORDS = {
    LinkState.CLOSED: "not connected",
    LinkState.IDENTIFIED: "not calibrated",
    LinkState.CALIBRATED: "ready to arm",
    LinkState.ARMED: "armed, following the screen",
    LinkState.HOLD: "holding",
    LinkState.STOPPED: "stopped, holding",
    LinkState.FAULT: "fault, holding",
}
"""States of the link, in words."""

KINDS = (EMULATED, "dynamixel:/dev/ttyUSB0", "feetech:/dev/ttyUSB0", "firmware:/dev/ttyACM0")


def motors_card(page: WindowPage) -> None:
    """Build the card; guests, and robots without cables, have none."""
    hardware = page.session.hardware
    if not hardware.allowed or not page.session.document.robot.cables:
        return
    with ui.element("div").classes("studio-card").style("display: flex; flex-direction: column; gap: 8px"):
        with ui.element("div").classes("studio-row"):
            show_heading("Motors").style("margin-top: 0; font-size: 14px")
            ui.space()
            state = ui.label().classes("studio-hint").props("role=status").mark("motors-state")
        with ui.element("div").classes("studio-row").style("gap: 8px") as before:
            port = ui.input(value=hardware.port or EMULATED, autocomplete=list(KINDS))
            port.props('dense outlined aria-label="Port of the motors"').style("flex: 1; min-width: 0").mark(
                "motors-port"
            )
            port.tooltip(
                "emulated, dynamixel:PORT, feetech:PORT or firmware:PORT. Append @BAUD for another rate. "
                "Separate the ports of several boards by commas."
            )
            connect = ui.button("Connect", on_click=lambda: page.act_slowly(hardware.connect, str(port.value).strip()))
            connect.props("flat dense no-caps").mark("motors-connect")
        with ui.element("div").classes("studio-row").style("gap: 8px") as after:
            arm = ui.button("Arm", icon="power", on_click=page.doing_slowly(hardware.arm))
            arm.props("unelevated dense no-caps").style("padding: 4px 14px").mark("motors-arm")
            arm.tooltip("Motors are live and follow the pose on screen")
            ui.button("Disconnect", on_click=page.doing_slowly(hardware.disconnect)).props("flat dense no-caps")
        found = ui.label().classes("studio-hint studio-figure").style("white-space: pre-line").mark("motors-places")
        words = ui.label().classes("studio-hint").style("white-space: pre-line").mark("motors-words")

    def show() -> None:
        now = hardware.state
        kind = hardware.port.partition(":")[0]
        state.set_text(WORDS[LinkState.CLOSED] if now is None else f"{kind}: {WORDS[now]}")
        before.set_visibility(now is None)
        after.set_visibility(now is not None)
        arm.set_enabled(now not in (None, LinkState.IDENTIFIED, LinkState.ARMED))
        currents = hardware.currents
        lines = [
            f"{name}: {1e3 * at:.1f} mm{_current_text(currents.get(name))}" for name, at in hardware.places.items()
        ]
        found.set_text("\n".join(lines))
        found.set_visibility(hardware.is_armed)
        words.set_text(hardware.words)
        words.set_visibility(bool(hardware.words))
        words.style(f"color: {Color.ERROR}" if now is LinkState.FAULT else "color: inherit")

    page.on((Topic.ROBOT, Topic.DRIVE), show)


def stop_button(page: WindowPage) -> None:
    """Build the button that holds all motors, in sight of every stage while they are armed."""
    hardware = page.session.hardware
    button = ui.button("Stop motors", icon="front_hand", on_click=page.doing(hardware.hold), color="negative")
    button.props("unelevated no-caps dense").style("padding: 4px 12px; font-weight: 700").mark("motors-stop")
    page.on(Topic.DRIVE, lambda: button.set_visibility(hardware.is_armed), lasting=True)


def _current_text(current: float | None) -> str:
    return "" if current is None or isnan(current) else f", {current:.2f} A"
