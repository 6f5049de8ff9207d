"""`check_card`: what the check says of the robot as it is."""

from nicegui import ui

from hydrostat.plot.palette import SEAM
from hydrostat.studio.bell import Topic
from hydrostat.studio.editing.findings import Findings, in_words
from hydrostat.studio.face.page import Page
from hydrostat.units import counted

GOOD = "#00795f"


def check_card(page: Page) -> None:
    """Build the card."""
    editor = page.session.editor
    ui.label("Check").classes("studio-section")
    box = ui.column().classes("studio-card").style("gap: 6px; flex-shrink: 0").mark("edit-check")
    shown: list[Findings | None] = []

    def show() -> None:
        findings = editor.findings
        if shown == [findings]:
            return
        if findings is None and shown:  # the last words stay, faintly, until there are new ones
            box.style("opacity: 0.55")
            shown[:] = [None]
            return
        shown[:] = [findings]
        box.clear()
        box.style("opacity: 1")
        with box:
            if findings is None:
                ui.label("Looking it over").classes("studio-hint")
            else:
                _tell(findings, [in_words(risk) for risk in findings.risks])

    page.on(Topic.JOB, show)
    page.on(Topic.ROBOT, show)


def _tell(findings: Findings, risks: list[str]) -> None:
    ui.label(f"{findings.nodes} nodes, {findings.elements} {findings.kind}, {1e3 * findings.mass:.3g} g").classes(
        "studio-hint studio-figure"
    )
    ui.label(
        f"{counted(findings.cables, 'cable')}, {1e3 * findings.cable_length:.0f} mm in all"
        if findings.cables
        else "no cables yet"
    ).classes("studio-hint studio-figure")
    if not risks:
        with ui.element("div").classes("studio-row"):
            ui.icon("check_circle", size="18px").style(f"color: {GOOD}")
            ui.label("Nothing is wrong.").style("font-size: 13px")
    for risk in risks:
        with ui.element("div").classes("studio-row").style("align-items: flex-start"):
            ui.icon("error_outline", size="18px").style(f"color: {SEAM}; margin-top: 1px")
            ui.label(risk).style("font-size: 13px; line-height: 1.4; overflow-wrap: anywhere")
