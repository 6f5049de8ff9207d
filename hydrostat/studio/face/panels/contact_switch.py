"""`contact_switch`: whether the body feels itself."""

from nicegui import ui

from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage


def contact_switch(page: WindowPage, mark: str) -> None:
    """Build the switch, found under a mark; obstacles are written into robot.toml."""
    editor, document = page.session.editor, page.session.document
    switch = ui.switch("Parts touch, and do not pass through").mark(mark)
    switch.tooltip("Contact of the body with itself. Poses take longer; obstacles are added in robot.toml.")

    def send() -> None:
        if switch.value != (document.robot.contact is not None):
            page.act(editor.set_contact, switch.value)

    def show() -> None:
        switch.set_value(document.robot.contact is not None)

    switch.on_value_change(send)
    page.on(Topic.ROBOT, show)
