"""`EditNumber`: a box for a number of a part, which is sent when it is done."""

from collections.abc import Callable
from inspect import isawaitable
from typing import Any

from nicegui import ui

from hydrostat.studio.face.sent_number import sent_number


class EditNumber:
    """Shows a number; calls back once a person has typed another and pressed Enter or gone elsewhere.

    Attributes:
        box: the element.
    """

    def __init__(
        self, label: str, unit: str, take: Callable[[float], Any], *, step: float = 1.0, mark: str = ""
    ) -> None:
        """An empty box.

        Args:
            label: name of the number.
            unit: shown behind it.
            take: called with the new number; what it returns is awaited if it can be.
            step: of the arrow keys.
            mark: for tests.
        """
        self._shown: float | None = None
        self._take = take
        self.box = ui.number(label, suffix=unit, step=step, format="%.6g").props("dense outlined hide-bottom-space")
        self.box.classes("flex-1 studio-figure").style("min-width: 0").mark(mark)
        self.box.on("keydown.enter", self._send)
        self.box.on("blur", self._send)

    def show(self, value: float) -> None:
        """Show a number; one that is being typed is left alone unless another came from elsewhere."""
        rounded = float(f"{value:.6g}")
        if rounded != self._shown:
            self._shown = rounded
            self.box.set_value(rounded)

    async def _send(self) -> None:
        number = sent_number(self.box.value)
        if number is None or self._shown is None:
            self.box.set_value(self._shown)
        elif number != self._shown:
            before, self._shown = self._shown, None
            result = self._take(number)
            if isawaitable(result):
                await result
            if self._shown is None:  # nobody has shown what came of it: it was refused or is as it was
                self.show(before)
