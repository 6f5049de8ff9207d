"""The card of proposed cables: a switch, the error once built, and the button that keeps them."""

from nicegui import ui

from hydrostat.design import DesignMethod
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage, show_heading
from hydrostat.studio.posing import Proposal
from hydrostat.studio.stage import format_error
from hydrostat.units import plural


def proposals_card(page: WindowPage) -> None:
    """Build the card."""
    proposals, poser, document = page.session.poser.proposals, page.session.poser, page.session.document
    show_heading("Proposed cables")
    on = ui.switch("Propose cables while dragging").props("dense").style("font-size: 13px").mark("pose-propose")
    with ui.element("div").classes("studio-card column").style("gap: 6px") as card:
        with ui.element("div").classes("studio-row").style("min-height: 32px"):
            with ui.column().classes("flex-1").style("gap: 0; min-width: 0"):
                error = ui.label().style("font-weight: 600").classes("studio-figure").mark("pose-proposed-error")
                words = ui.label().classes("studio-hint studio-figure").mark("pose-proposed")
            busy = ui.spinner(size="18px").props('role="status" aria-label="Searching"').mark("pose-proposing")
            keep = ui.button("Keep", icon="check").props("unelevated no-caps size=sm").mark("pose-keep")
            keep.tooltip("Put these cables into the robot")
        why = ui.label().classes("studio-hint").mark("pose-proposed-why")
        poses = ui.switch("Include stored poses").props("dense").style("font-size: 13px").mark("pose-propose-poses")
        poses.tooltip("Also reach the stored poses that are selected in Design")

    def switch(wanted: bool) -> None:
        page.act(proposals.switch, wanted)
        on.set_value(proposals.on)

    def take() -> None:
        told = page.act(proposals.keep)
        if told:
            page.tell(told)

    def show() -> None:
        on.set_value(proposals.on)
        poses.set_value(proposals.with_poses)
        card.set_visibility(proposals.on)
        found, is_kept = proposals.latest_proposal(document.robot), proposals.is_kept(document.robot)
        has_network = found is not None and bool(found.cables)
        busy.set_visibility(proposals.searching and bool(poser.held_points))
        keep.set_visibility(has_network)
        keep.set_enabled(has_network and not is_kept)
        keep.set_text("Kept" if is_kept else "Keep")
        error.set_text(_error(found) if found is not None and has_network else "")
        error.set_visibility(has_network)
        words.set_text(_words(found, is_asked=bool(poser.held_points)))
        words.set_visibility(found is None or has_network)
        reason = "" if found is None else _why(found)
        why.set_text(reason)
        why.set_visibility(bool(reason))

    on.on_value_change(lambda event: switch(bool(event.value)))
    poses.on_value_change(lambda event: proposals.include_poses(bool(event.value)))
    keep.on_click(take)
    page.on((Topic.SCENE, Topic.ROBOT), show)


def _error(found: Proposal) -> str:
    return "Error unknown" if found.expected_error is None else f"{format_error(found.expected_error)} as-built error"


def _words(found: Proposal | None, *, is_asked: bool) -> str:
    """Counts of a network, or what is done for one."""
    if found is None:
        return "Searching for cables" if is_asked else "Drag a point to get a proposal."
    counts = f"{plural(len(found.winches), 'winch')}, {plural(len(found.cables), 'cable')}"
    several = f", {found.poses} poses" if found.poses > 1 else ""
    return f"{counts}{several}{', winch trees' if found.method is not DesignMethod.ROUTES else ''}"


def _why(found: Proposal) -> str:
    """Why there is no network, or what to know about it; "" for nothing."""
    words = found.words
    if found.cables and not found.is_buildable:
        words = "its kit would be rejected. Keep it, then see the review in Edit"
    return f"{words[:1].upper()}{words[1:]}" + ("." if words and not words.endswith(".") else "")
