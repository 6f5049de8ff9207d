"""The panel of the stage "drive": a knob and a number box for each winch (R58)."""

from nicegui import events, ui

from hydrostat.drawing import Color
from hydrostat.fabrication import winch_marks_of
from hydrostat.robot import Winch
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.elements import Knob, winch_badge
from hydrostat.studio.face.messages import sent_number
from hydrostat.studio.face.page import WindowPage, show_heading
from hydrostat.studio.face.panels.drive_strip import drive_strip, release_focus
from hydrostat.studio.face.panels.edit_body import contact_switch, touch_label
from hydrostat.studio.face.panels.motors_card import motors_card
from hydrostat.studio.stage import StageName

ui.add_css("body.body--dark { --lift: 38% }", shared=True)  # colors of winches are made for paper: lighter on dark


def drive_panel(page: WindowPage) -> None:
    """Build the panel, and the timeline below the view."""
    session = page.session
    if not session.document.robot.cables:
        _no_cables(page)
        return
    driver = session.driver
    with ui.element("div").classes("studio-row"):
        show_heading("Drive", 1)
        ui.space()
        rest = ui.button("Rest", icon="restart_alt", on_click=page.doing(driver.rest), color=None)
        rest.props("flat dense no-caps").style("color: var(--accent)")
        release_focus(rest).tooltip("Release all cables (R)").mark("drive-rest")
    ui.label("Turn a knob, type a length, or drag a winch in the view down.").classes("studio-hint")
    if drives := session.document.robot.drives:
        names = ", ".join(drive.name for drive in drives)
        ui.label(f"Drives stay at 0 here: {names}. Use hydrostat simulate --move.").classes("studio-hint").mark("still")
    notes = ui.label().classes("studio-hint").style(f"color: {Color.ERROR}; white-space: pre-line").mark("drive-notes")
    notes.props("role=alert")
    box = ui.column().classes("w-full").style("gap: 8px")
    cards: list[_Card] = []

    many = 6  # more winches than this have smaller knobs

    def build() -> None:
        winches, marks = session.document.robot.winches, winch_marks_of(session.document.robot)
        colors, size = Color.of_winches(winches), 68 if len(winches) <= many else 50
        cards[:] = [_Card(page, winch, marks[winch.name], colors[winch.name], size) for winch in winches]

    def show() -> None:
        commands, places, tensions = driver.commands(), driver.places(), driver.tensions()
        for card in cards:
            if card.name in commands:
                card.show(commands[card.name], places[card.name], tensions[card.name], driver.strongest)
        words = "\n".join(driver.shape().notes)
        notes.set_text(words)
        notes.set_visibility(bool(words))

    page.on_new(Topic.ROBOT, lambda: session.document.robot.winches, box, build)
    page.on((Topic.ROBOT, Topic.DRIVE), show)
    _speed(page)
    motors_card(page)
    contact_switch(page, "drive-contact")
    touch_label(page, driver.shape, "drive-touches")
    with page.bottom:
        drive_strip(page)


class _Card:
    """A winch: its knob, its box, the tension of its cables."""

    def __init__(self, page: WindowPage, winch: Winch, mark: str, color: str, size: int) -> None:
        self.name = winch.name
        self._page, self._typing = page, False
        driver, least, most = page.session.driver, -1e3 * winch.release, 1e3 * winch.travel
        card = ui.element("div").classes("studio-card")
        step = 0.5  # of a knob's wheel and arrow keys [mm]
        with card.style(f"display: flex; align-items: center; gap: 8px; padding: {size // 8}px 10px"):
            self._knob = Knob(least=least, most=most, step=step, color=color, label=winch.name)
            self._knob.style(f"width: {size}px; height: {size}px; flex: none; margin: -3px 0 -5px -4px")
            self._knob.mark(f"knob-{winch.name}")
            with ui.element("div").style("flex: 1; min-width: 0; display: flex; flex-direction: column; gap: 5px"):
                with ui.element("div").style("display: flex; align-items: center; gap: 6px; min-width: 0"):
                    winch_badge(mark, color)
                    name = ui.label(winch.name).style(
                        "font-weight: 600; white-space: nowrap; overflow: hidden; text-overflow: ellipsis"
                    )
                name.tooltip(f"{winch.name}: {least:g} to {most:g} mm")
                with ui.element("div").style("height: 5px; border-radius: 3px; background: var(--line); width: 100%"):
                    self._bar = ui.element("div").style("height: 5px; border-radius: 3px; width: 0%")
                self._pull = ui.label("0.0 N").classes("studio-hint studio-figure").style("line-height: 1")
                self._pull.tooltip("Maximum tension of its cables")
            self._box = ui.number(min=least, max=most, step=step, format="%.1f", suffix="mm", value=0.0)
            self._box.props(f'dense outlined aria-label="{winch.name}, millimeters"').classes("drive-box")
            self._box.style("width: 88px; flex: none")
            self._box.mark(f"box-{winch.name}")
        self._color = f"color-mix(in oklab, {color}, white var(--lift, 0%))"
        self._knob.on_turn(
            lambda millimeters: page.act(driver.turn, winch.name, 1e-3 * millimeters), page.doing(driver.let_go)
        )
        self._box.on("update:model-value", self._on_typed)  # only what a person types comes this way
        self._box.on("focus", lambda: self._type(True))
        self._box.on("blur", lambda: self._type(False))

    def show(self, command: float, place: float, tension: float, most: float) -> None:
        """Show what the winch shall take in and has taken in [m], and what its cables bear [N], of so much."""
        self._knob.show(1e3 * command, 1e3 * place)
        if not self._typing:
            self._box.set_value(round(1e3 * command, 1) + 0.0)
        words = f"{tension:.1f} N"
        if words != self._pull.text:
            self._pull.set_text(words)
            color = Color.ERROR if tension > most else self._color
            self._bar.style(f"width: {100 * min(tension / most, 1.0):.0f}%; background: {color}")

    def _on_typed(self, event: events.GenericEventArguments) -> None:
        number = sent_number(event.args)
        if self._typing and number is not None:
            driver = self._page.session.driver
            self._page.act(driver.turn, self.name, 1e-3 * number)

    def _type(self, typing: bool) -> None:
        """Nothing is written into a box that a person writes in."""
        self._typing = typing
        if not typing:
            driver = self._page.session.driver
            driver.let_go()
            self._box.set_value(round(1e3 * driver.commands().get(self.name, 0.0), 1))


def _speed(page: WindowPage) -> None:
    """Build the speed limit of the shown motors: at first that of the kit's motors under full load."""
    driver = page.session.driver
    with ui.element("div").classes("studio-row").style("margin-top: 6px"):
        label = ui.label("Speed limit").classes("studio-hint")
        if driver.kit:
            label.tooltip(f"Initial value: the kit's slowest winch under full load, {driver.kit}")
        ui.space()
        speed = ui.number(min=1, max=1000, step=10, value=1e3 * driver.motors.fastest, format="%.0f", suffix="mm/s")
        speed.props('dense outlined debounce=400 aria-label="Speed limit of the motors"').style("width: 120px")
    speed.on_value_change(
        lambda event: page.act(driver.motors.set_fastest, 1e-3 * event.value) if event.value is not None else None
    )


def _no_cables(page: WindowPage) -> None:
    """Build the empty state of a robot without cables: the first steps."""
    show_heading("Drive", 1)
    with ui.element("div").classes("studio-card").style("display: flex; flex-direction: column; gap: 10px"):
        ui.label("No cables yet.")
        ui.label("Press Design to find winches and cables for the poses, or place them in Edit.").classes("studio-hint")
        with ui.element("div").classes("studio-row"):
            design = ui.button("Design", icon="auto_awesome", on_click=lambda: page.go(StageName.DESIGN))
            design.props("unelevated no-caps").mark("drive-design")
            ui.button("Edit", icon="edit", on_click=lambda: page.go(StageName.EDIT)).props("flat no-caps")
