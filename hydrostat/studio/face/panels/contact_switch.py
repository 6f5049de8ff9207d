"""`contact_switch`, `touch_label`: whether the body feels itself, and what it feels."""

from collections.abc import Callable

from nicegui import ui

from hydrostat.simulation import describe_contacts
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.page import WindowPage
from hydrostat.studio.view.things import RobotShape


def contact_switch(page: WindowPage, mark: str) -> None:
    """Build the switch, found under a mark; obstacles are written into robot.toml."""
    editor, document = page.session.editor, page.session.document
    switch = ui.switch("Self-contact").mark(mark)
    switch.tooltip("The body cannot pass through itself. Solving takes longer. Add obstacles in robot.toml.")

    def send() -> None:
        if switch.value != (document.robot.contact is not None):
            page.act(editor.set_contact, switch.value)

    def show() -> None:
        switch.set_value(document.robot.contact is not None)

    switch.on_value_change(send)
    page.on(Topic.ROBOT, show)


def touch_label(page: WindowPage, shape: Callable[[], RobotShape], mark: str) -> None:
    """Build the line that says what the body touches, and how hard; found under a mark."""
    label = ui.label().classes("studio-hint").mark(mark)

    def show() -> None:
        words = describe_contacts(shape().touches)
        label.set_text(f"{words[:1].upper()}{words[1:]}")
        label.set_visibility(bool(words))

    page.on((Topic.ROBOT, Topic.SHAPE), show)
