"""`finding_list`: what is said of a robot that is to be built, a line each; pressed, it is marked on the body."""

from collections.abc import Callable

from nicegui import ui

from hydrostat.design import Diagnostic, Severity
from hydrostat.errors import in_words
from hydrostat.robot import Robot
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage, pressable
from hydrostat.studio.skins import SewnSkin
from hydrostat.studio.view.robot_items import TONES

GOOD = "#00795f"
ICONS = {Severity.REFUSED: "block", Severity.LIMIT: "straighten", Severity.WARNING: "error_outline"}
HEADS = {
    Severity.REFUSED: "Errors",
    Severity.LIMIT: "Design limits exceeded",
    Severity.WARNING: "Warnings",
}


def finding_list(page: WindowPage, shown: Callable[[], Robot | None]) -> None:
    """Build the list of the robot that is shown; the same robot has the same lines wherever it is."""
    document = page.session.document
    judge = document.judge
    room = ui.column().classes("w-full").style("gap: 6px").mark("finding-list")

    def find_diagnostics() -> tuple[Diagnostic, ...] | None:
        robot = shown() if document.is_open else None
        return None if robot is None else judge.of(robot, document.work.wishes)

    def find_skin() -> SewnSkin | None:
        robot = shown() if document.is_open else None
        return None if robot is None else judge.skin(robot)

    def build() -> None:
        found = find_diagnostics()
        if found is None:
            ui.label("Checking").classes("studio-hint")
            return
        skin = find_skin()
        if skin is not None and (words := skin.words):
            ui.label(words[0].upper() + words[1:]).classes("studio-hint").props('data-testid="skin-words"')
        if not found and not (skin is not None and skin.is_awaited):
            with ui.element("div").classes("studio-row"):
                ui.icon("check_circle", size="18px").style(f"color: {GOOD}")
                ui.label(_good(shown())).style("font-size: 13px")
        for severity in Severity:
            alike = [finding for finding in found if finding.severity is severity]
            if alike:
                ui.label(HEADS[severity]).classes("studio-hint")
            for finding in alike:
                _line(page, finding, chosen=finding == judge.chosen)

    page.on_new(
        (Topic.JOB, Topic.ROBOT, Topic.SCENE), lambda: (find_diagnostics(), find_skin(), judge.chosen), room, build
    )


def _good(robot: Robot | None) -> str:
    """Return the text for a robot without findings; without cables, few checks apply."""
    if robot is None or robot.cables:
        return "OK: 0 errors, 0 warnings."
    return "0 errors, 0 warnings, but no cables yet. Lay cables in Edit, or press Design."


def _line(page: WindowPage, finding: Diagnostic, *, chosen: bool) -> None:
    judge = page.session.document.judge
    kind = "finding" + (" finding-on" if chosen else "")
    line = pressable(kind, page.doing(judge.choose, finding)) if finding.places else ui.element("div").classes(kind)
    with line.props(f'data-testid="finding-{finding.severity}"'):
        ui.icon(ICONS[finding.severity], size="18px").style(f"color: {TONES[finding.severity]}; margin-top: 1px")
        ui.label(in_words(finding.text)).style("font-size: 13px; line-height: 1.4; overflow-wrap: anywhere")
