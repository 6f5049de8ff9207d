"""`bars_card`: contraction and tension of every winch, as bars."""

from nicegui import ui

from hydrostat.plot.palette import ERROR
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import Page
from hydrostat.studio.posing.bars import Bar
from hydrostat.studio.posing.held import Mode

FULL = 0.999
"""A bar this full is at its limit."""


def bars_card(page: Page) -> None:
    """Build the bars; with muscles there are none."""
    poser, document = page.session.poser, page.session.document
    with ui.column().classes("w-full").style("gap: 6px") as room:
        with ui.element("div").classes("studio-row"):
            ui.label("Winches").classes("studio-section")
            ui.space()
            limit = ui.label().classes("studio-hint studio-figure").style("margin-top: 8px")
        box = ui.element("div").classes("studio-card").style("display: flex; flex-direction: column; gap: 10px")
    rows: list[_Row] = []
    drawn: list[Robot] = []

    def draw() -> None:
        robot = document.robot
        if not drawn or drawn[0].winches != robot.winches:
            drawn[:] = [robot]
            box.clear()
            with box:
                rows[:] = [_Row(bar) for bar in poser.bars()]
        show()

    def show() -> None:
        room.set_visibility(poser.mode is Mode.CABLES)
        if poser.mode is not Mode.CABLES:
            return
        found = poser.bars()
        for row, bar in zip(rows, found, strict=False):
            row.show(bar)
        if found:
            limit.set_text(f"limit {found[0].limit:g} N")

    page.on(Topic.ROBOT, draw)
    page.on(Topic.THINGS, show)
    page.on(Topic.SHAPE, show)


class _Row:
    """A winch: its name, how much it has taken in, and the largest tension of its cables."""

    def __init__(self, bar: Bar) -> None:
        with ui.element("div").style("width: 100%").mark(f"pose-bar-{bar.winch}"):
            with ui.element("div").classes("studio-row").style("gap: 8px; font-size: 13px"):
                ui.element("div").style(
                    f"width: 10px; height: 10px; border-radius: 5px; flex: none; background: {bar.colour}"
                )
                name = ui.label(bar.winch).style(
                    "flex: 1; min-width: 0; white-space: nowrap; overflow: hidden; text-overflow: ellipsis"
                )
                name.tooltip(f"takes in up to {1e3 * bar.travel:g} mm, lets out up to {1e3 * bar.release:g} mm")
                figure = "width: 66px; text-align: right"
                self._length = ui.label().classes("studio-figure").style(figure)
                self._pull = ui.label().classes("studio-figure").style(figure)
            with ui.element("div").classes("studio-row").style("gap: 8px; margin-top: 4px"):
                self._taken, self._tension = _track(), _track()
        self._shown: tuple[int, int] | None = None

    def show(self, bar: Bar) -> None:
        """Only what has changed is sent."""
        state = (round(1e4 * bar.contraction), round(10 * bar.tension))
        if state == self._shown:
            return
        self._shown = state
        self._length.set_text(f"{1e3 * bar.contraction + 0.0:.1f} mm")
        self._pull.set_text(f"{bar.tension:.1f} N")
        taken = max(bar.contraction, 0.0) / bar.travel
        _fill(self._taken, taken, bar.colour)
        _fill(self._tension, bar.tension / bar.limit, bar.colour)


def _track() -> ui.element:
    with ui.element("div").style("flex: 1; height: 6px; border-radius: 3px; background: var(--line); overflow: hidden"):
        return ui.element("div").style("height: 6px; border-radius: 3px; width: 0%")


def _fill(bar: ui.element, share: float, colour: str) -> None:
    full = ERROR if share >= FULL else f"color-mix(in oklab, {colour}, white var(--lift, 0%))"
    bar.style(f"width: {100 * min(share, 1.0):.1f}%; background: {full}")
