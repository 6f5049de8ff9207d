"""`design_compare`: the networks that were found, side by side."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.designing.candidate import Candidate, told_error
from hydrostat.studio.designing.front_chart import front_chart
from hydrostat.studio.face.page import Page
from hydrostat.units import counted


def design_compare(page: Page) -> None:
    """Build the strip below the view; it is not there while there is nothing to compare."""
    designer, document = page.session.designer, page.session.document
    room = ui.element("div").classes("w-full")
    drawn: list[object] = []

    def show() -> None:
        candidates = designer.candidates
        robot = document.robot
        own = tuple(one.number for one in candidates if one.robot.cables == robot.cables)
        state = (tuple(one.number for one in candidates), designer.chosen, designer.pose, own)
        if drawn == [state]:
            return
        drawn[:] = [state]
        room.clear()
        room.set_visibility(bool(candidates))
        if candidates:
            with room, ui.element("div").classes("design-strip"):
                _front(page, candidates)
                with ui.element("div").classes("design-shelf"):
                    _head(page, own)
                    _cards(page, candidates, own)

    page.on(Topic.JOB, show)
    page.on(Topic.ROBOT, show)


def _front(page: Page, candidates: tuple[Candidate, ...]) -> None:
    designer = page.session.designer
    with ui.element("div").classes("design-front"):
        ui.label("What more cables gain").classes("studio-section").style("margin: 0 0 8px")
        ui.html(front_chart(candidates, designer.trail, designer.chosen), sanitize=False).classes("w-full")


def _head(page: Page, own: tuple[int, ...]) -> None:
    """The poses of the chosen network, and what can be done with it."""
    designer = page.session.designer
    chosen = designer.candidate
    with ui.element("div").classes("studio-row").style("min-height: 36px"):
        if chosen is None:
            ui.label("Choose a network to see it").classes("studio-hint flex-1")
        else:
            with ui.element("div").classes("row flex-1").style("gap: 6px; min-width: 0"):
                _pose_chip(page, chosen, None, "rest")
                for reach in chosen.reaches:
                    _pose_chip(page, chosen, reach.pose.name, f"{reach.pose.name}, {told_error(reach.error)}")
        clear = ui.button("Clear", on_click=page.doing(designer.clear)).props("flat no-caps dense")
        clear.props('data-testid="design-clear"').tooltip("Forget all that was found")
        accept = ui.button("Accept", icon="check", on_click=page.doing(designer.accept)).props("unelevated no-caps")
        accept.props('data-testid="design-accept"').tooltip("Put this network into the robot")
        accept.set_enabled(chosen is not None and chosen.number not in own)


def _pose_chip(page: Page, chosen: Candidate, pose: str | None, words: str) -> None:
    designer = page.session.designer
    now = designer.pose == pose
    chip = (
        ui.element("div")
        .classes("design-pose" + (" design-pose-on" if now else ""))
        .props('role="button" tabindex="0"')
    )
    chip.props(f'data-testid="design-show-{"rest" if pose is None else "pose"}"')
    for event in ("click", "keydown.enter"):
        chip.on(event, page.doing(designer.show, chosen.number, pose))
    with chip:
        ui.label(words)


def _cards(page: Page, candidates: tuple[Candidate, ...], own: tuple[int, ...]) -> None:
    designer = page.session.designer
    with ui.element("div").classes("design-cards"):
        for one in candidates:
            now = one.number == designer.chosen
            card = ui.element("div").classes("design-card" + (" design-card-on" if now else ""))
            card.props('role="button" tabindex="0" data-testid="design-card"')
            pose = designer.pose if now or designer.pose in {reach.pose.name for reach in one.reaches} else None
            for event in ("click", "keydown.enter"):
                card.on(event, page.doing(designer.show, one.number, pose))
            with card:
                ui.html(designer.sketch(one), sanitize=False).classes("w-full")
                ui.html(_words(one, own), sanitize=False)


def _words(one: Candidate, own: tuple[int, ...]) -> str:
    """Error, counts, cable and tension, as HTML; only numbers."""
    robot = one.robot
    note = " · in the robot" if one.number in own else "" if one.complete else " · stopped early"
    return (
        f"<b>{told_error(one.error)}</b><span>{note}</span><br>"
        f"<span>{counted(len(robot.winches), 'winch')}, {counted(len(robot.cables), 'cable')}<br>"
        f"{1e3 * one.length:.0f} mm, {one.tension:.1f} N</span>"
    )
