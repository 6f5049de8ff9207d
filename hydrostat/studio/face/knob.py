"""`Knob`: a knob that is turned round."""

from collections.abc import Callable
from typing import Any

from nicegui import events, ui

from hydrostat.studio.face.sent_number import sent_number

SEEN = 0.05
"""Changes smaller than this are not sent to the screen."""


class Knob(ui.element, component="static/knob.js"):
    """A knob for a number; while a person holds it, it heeds nobody else, so that no answer fights the hand.

    Its hand shows what is wanted, the arc around it what is reached.
    """

    def __init__(self, *, least: float, most: float, step: float, colour: str, label: str) -> None:
        """A knob.

        Args:
            least: at its left end.
            most: at its right end.
            step: of the wheel and the arrow keys.
            colour: of its hand.
            label: read out to those who do not see it.
        """
        super().__init__()
        self._props.update(value=0.0, reach=0.0, least=least, most=most, step=step, colour=colour, label=label)

    def show(self, wanted: float, reached: float) -> None:
        """Show what is wanted and what is reached."""
        if abs(wanted - self._props["value"]) > SEEN or abs(reached - self._props["reach"]) > SEEN:
            self._props["value"], self._props["reach"] = wanted, reached
            self.update()

    def on_turn(self, turn: Callable[[float], Any], let_go: Callable[[], Any]) -> None:
        """Call `turn` with the number that a person turns it to, and `let_go` after that."""

        def heed(event: events.GenericEventArguments) -> None:
            number = sent_number(event.args)
            if number is not None:
                turn(number)

        self.on("turn", heed)
        self.on("letgo", lambda: let_go())
