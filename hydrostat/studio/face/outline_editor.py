"""`OutlineEditor`: an outline that is drawn with the pointer."""

from collections.abc import Callable, Sequence
from typing import Any

from nicegui import events, ui

from hydrostat.studio.starting.loops import HANDLE, Loop, send_loops


class OutlineEditor(ui.element, component="static/outline_editor.js"):
    """Corners, curves and holes on a grid in millimetres.

    A click adds corners to the loop that is begun, and closes it at its first corner; corners are dragged, a click on
    an edge puts one in, Delete removes one, a double click makes one round or sharp. What a screen sends is checked
    by `starting.loops.read_loops`.
    """

    def __init__(self, loops: Sequence[Loop], on_change: Callable[[Any], None]) -> None:
        """An editor.

        Args:
            loops: to begin with.
            on_change: called with what the screen has sent, not yet checked.
        """
        super().__init__()
        self._props["handle"] = HANDLE
        self._props["start"] = send_loops(loops)
        self._props["fault"] = False
        self.on("change", lambda event: on_change(_argument(event)))

    def show(self, loops: Sequence[Loop]) -> None:
        """Put other loops in place of these; it can be undone."""
        self.run_method("put", send_loops(loops))

    def set_fault(self, faulty: bool) -> None:
        """Whether these are no body, and so are drawn as a warning."""
        if self._props["fault"] != faulty:
            self._props["fault"] = faulty
            self.update()

    def undo(self) -> None:
        """Take back the last change."""
        self.run_method("undo")

    def redo(self) -> None:
        """Do again what was taken back."""
        self.run_method("redo")

    def add_loop(self) -> None:
        """The next clicks draw a loop, a hole if it lies inside."""
        self.run_method("begin")

    def remove_corner(self) -> None:
        """Remove the corner that is chosen."""
        self.run_method("removeCorner")

    def fit(self) -> None:
        """Show all there is."""
        self.run_method("fit")

    def set_mirror(self, on: bool) -> None:
        """Whether both sides of x = 0 change together."""
        self.run_method("setMirror", on)

    def set_snap(self, on: bool) -> None:
        """Whether corners stay on the grid."""
        self.run_method("setSnap", on)


def _argument(event: events.GenericEventArguments) -> Any:
    return event.args
