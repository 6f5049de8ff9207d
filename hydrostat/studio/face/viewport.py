"""`Viewport`: the view of the body in a window."""

from importlib import import_module
from pathlib import Path
from typing import Literal

from nicegui import ui
from nicegui.dependencies import register_esm

from hydrostat.drawing import Color

STATIC = Path(__file__).parent / "static"
MODULES = STATIC / "view"

COLORS = {  # what the view is painted with; ink and ghosts are lighter on a dark page
    "felt": Color.FELT,
    "felt_light": Color.FELT_LIGHT,
    "seam": Color.SEAM,
    "stitch": Color.STITCH,
    "mesh": Color.MESH,
    "dark": Color.DARK,
    "light": Color.LIGHT,
    "ink": Color.INK,
    "ghost": Color.GHOST,
    "tension": list(Color.TENSION),
}

Side = Literal["front", "side", "top"]
Axis = Literal["x", "y", "z"]

import_module("nicegui.elements.scene")  # brings three.js, which the view is drawn with
# named after the newest of its files, so that no browser keeps an old one
register_esm("hydrostat-view", MODULES, max_time=max(file.stat().st_mtime for file in MODULES.glob("*.js")))


class Viewport(ui.element, component="static/viewport.js"):
    """The view of the body: it fills its parent, draws what comes over a stream and tells where the pointer is.

    Pictures come and pointers go over a websocket of its own (`view.packet`, `face.messages`); only what is asked for
    here goes over the page's.
    """

    def __init__(self, *, stream: str, dark: bool | None = None, brush: bool = False) -> None:
        """A view of a websocket's path, dark or as the page is (None); with a brush a drag beside the body paints."""
        super().__init__()
        self._props["stream"] = stream
        self._props["palette"] = COLORS
        self._props["dark"] = dark
        self._props["brush"] = brush
        self._props["words"] = self._words = ""

    def describe(self, words: str) -> None:
        """Set the content in words, for screen readers: at first, and then once they are the same twice in a row."""
        if words != self._props["words"] and (words == self._words or not self._props["words"]):
            self._props["words"] = words
            self.update()
        self._words = words

    def set_dark(self, dark: bool | None) -> None:
        """Dark or light; None: as the page is."""
        self._props["dark"] = dark
        self.update()

    def set_brush(self, brush: bool) -> None:
        """Let a drag beside the body paint instead of moving the view, or not."""
        self._props["brush"] = brush
        self.update()

    def view(self, name: Side) -> None:
        """Turn a body in space: seen along +y ("front"), along -x ("side") or along -z ("top")."""
        self.run_method("view", name)

    def fit(self) -> None:
        """Show all there is."""
        self.run_method("fit")

    def section(self, axis: Axis | None, share: float) -> None:
        """Cut a body in space open across an axis, None: not at all, at a share of the body's extent along it."""
        self.run_method("section", axis, share)

    def orthographic(self, on: bool) -> None:
        """See a body in space without perspective."""
        self.run_method("orthographic", on)

    def opacity(self, value: float) -> None:
        """Set how solid a body in space looks, from 0 to 1."""
        self.run_method("opacity", value)

    def mesh(self, on: bool) -> None:
        """Show the edges of the mesh."""
        self.run_method("mesh", on)

    async def picture(self) -> str:
        """Return the view as a PNG in a data URL."""
        return await self.run_method("picture", timeout=10.0)
