"""`Viewport`: the view of the body in a window."""

from nicegui import ui


class Viewport(ui.element):
    """To be written."""

    def __init__(self, *, stream: str) -> None:
        super().__init__("div")
        self._props["stream"] = stream

    def set_dark(self, dark: bool) -> None:
        """Dark or light."""

    def view(self, name: str) -> None:
        """Look from a side."""

    def fit(self) -> None:
        """Show all."""

    def orthographic(self, on: bool) -> None:
        """Kind of camera."""

    def opacity(self, value: float) -> None:
        """See through."""

    def section(self, axis: str | None, share: float) -> None:
        """Cut."""

    def mesh(self, on: bool) -> None:
        """Show edges."""
