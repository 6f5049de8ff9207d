"""`Toasts`: notes to the person of a window, few at a time, over the view and over nothing else."""

from nicegui import ui

from hydrostat.studio.session import Tone

LASTING = {Tone.BAD: 9.0, Tone.PLAIN: 3.0, Tone.GOOD: 3.0}  # seconds that a note is seen
ICONS = {Tone.BAD: "error_outline", Tone.GOOD: "check_circle"}


class Toasts:
    """The newest notes; one that is no complaint takes the place of the one before, so that none pile up."""

    def __init__(self) -> None:
        """Fills the element that it is made in; it may be moved."""
        self.room = ui.element("div").classes("studio-toasts")
        self._shown: list[tuple[ui.element, Tone, str]] = []

    def show(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Show a note for a while; a click takes it away, the same note again shows it longer."""
        for toast, other, words in list(self._shown):
            if words == text or (tone is not Tone.BAD and other is not Tone.BAD):
                self._drop(toast)
        most = 2  # so many notes are seen at once
        while len(self._shown) >= most:
            self._drop(self._shown[0][0])
        with self.room:
            toast = ui.element("div").classes(f"studio-toast studio-toast-{tone}")
        toast.props(f'role="{"alert" if tone is Tone.BAD else "status"}"')
        with toast:
            if tone in ICONS:
                ui.icon(ICONS[tone], size="18px")
            ui.label(text)
            ui.timer(LASTING[tone], lambda: self._drop(toast), once=True)
        toast.on("click", lambda: self._drop(toast))
        self._shown.append((toast, tone, text))

    @property
    def words(self) -> list[str]:
        """Texts on the screen, the oldest first."""
        return [words for _, _, words in self._shown]

    def _drop(self, toast: ui.element) -> None:
        self._shown = [one for one in self._shown if one[0] is not toast]
        if not toast.is_deleted:
            toast.delete()
