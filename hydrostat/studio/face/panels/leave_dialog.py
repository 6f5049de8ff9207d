"""`may_leave`: whether the open robot may be left for another one."""

from nicegui import ui

from hydrostat.studio.face.page import Page


async def may_leave(page: Page) -> bool:
    """Ask if there is work that is not saved; what the person says."""
    document = page.session.document
    if document.saved:
        return True
    with page.whole, ui.dialog() as dialog, ui.card().classes("q-pa-md"):
        ui.label(f"{document.robot.name} is not saved").classes("studio-title")
        ui.label("Another robot takes its place, and what was changed is lost.").classes("studio-hint")
        with ui.row().classes("w-full justify-end"):
            ui.button("Go back", on_click=lambda: dialog.submit(False)).props("flat no-caps").props(
                'data-testid="leave-no"'
            )
            leave = ui.button("Throw the changes away", on_click=lambda: dialog.submit(True)).props(
                "unelevated no-caps color=negative"
            )
            leave.props('data-testid="leave-yes"')
    answer = bool(await dialog)
    dialog.delete()
    return answer
