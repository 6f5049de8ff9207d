"""`WindowPage`: one browser window on a session; `Toasts`: its notes, few at a time."""

from collections import defaultdict
from collections.abc import Awaitable, Callable, Sequence
from typing import Any

from nicegui import run, ui

from hydrostat.errors import HydrostatError
from hydrostat.studio.bell import Topic
from hydrostat.studio.face.viewport import Viewport
from hydrostat.studio.session import Session, Tone
from hydrostat.studio.stage import StageName

HEARTBEAT = 0.1  # panels follow the session within this time [s]

Refresh = Callable[[], Any]


class WindowPage:
    """One browser window: its view, its panel, and what is to be drawn again when something changes.

    A silent one tells no notes of the session.
    """

    def __init__(self, session: Session, *, silent: bool = False) -> None:
        self.session = session  # that all windows share
        self._silent = silent
        self._lasting: dict[Topic, list[Refresh]] = defaultdict(list)
        self._passing: dict[Topic, list[Refresh]] = defaultdict(list)
        self._rung: set[Topic] = set()
        self._told = session.notes[-1].number if session.notes else 0
        self._leave = session.bell.listen(self._rung.add)
        self.viewport: Viewport  # the view of the body
        self.toasts: Toasts  # notes to the person
        self.save: Callable[[], Awaitable[None]]  # saves, after asking what is to be asked
        self.panel: ui.column  # the column beside it, filled by the panel of the stage
        self.bottom: ui.column  # the strip below the view, likewise
        self.whole: ui.column  # in place of view and column, for the stage that needs all the room

    def on(self, topics: Topic | Sequence[Topic], refresh: Refresh, *, lasting: bool = False) -> None:
        """Call what redraws after a topic rang, and once now; if lasting also when another stage is shown."""
        for topic in (topics,) if isinstance(topics, Topic) else topics:
            (self._lasting if lasting else self._passing)[topic].append(refresh)
        refresh()

    def on_new(
        self, topics: Topic | Sequence[Topic], state: Callable[[], object], room: ui.element, build: Callable[[], Any]
    ) -> None:
        """Fill a room, and fill it again after a topic rang where the state that it shows is another by then."""
        drawn: list[object] = []

        def show() -> None:
            now = state()
            if drawn != [now]:
                drawn[:] = [now]
                room.clear()
                with room:
                    build()

        self.on(topics, show)

    def act(self, action: Callable[..., Any], *arguments: Any) -> Any:
        """Do something with the session; what was wrong is told to the person of this window. None if it was."""
        try:
            return action(*arguments)
        except HydrostatError as error:
            self.tell(str(error), Tone.BAD)
            return None

    async def act_slowly(self, action: Callable[..., Any], *arguments: Any) -> Any:
        """Do what `act` does in a thread, for what may take a second or more: the page goes on."""
        try:
            return await run.io_bound(action, *arguments)
        except HydrostatError as error:
            self.tell(str(error), Tone.BAD)
            return None

    def doing(self, action: Callable[..., Any], *arguments: Any) -> Callable[[], Any]:
        """A handler that does something with the session."""
        return lambda: self.act(action, *arguments)

    def doing_slowly(self, action: Callable[..., Any], *arguments: Any) -> Callable[[], Awaitable[Any]]:
        """A handler that does something that may take a second or more."""
        return lambda: self.act_slowly(action, *arguments)

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Show a note to the person of this window."""
        self.toasts.show(text, tone)

    def go(self, stage: StageName) -> None:
        """Show another stage, in all windows."""
        self.act(self.session.go, stage)

    def show_panel(self, build: Callable[["WindowPage"], None]) -> None:
        """Fill panel and bottom again."""
        self._passing.clear()
        for room in (self.panel, self.bottom, self.whole):
            room.clear()
        with self.panel:
            build(self)

    def beat(self) -> None:
        """Redraw what depends on what rang since the last beat."""
        rung = set(self._rung)
        self._rung -= rung
        for topic in Topic:
            if topic in rung:
                for refresh in [*self._lasting[topic], *self._passing[topic]]:
                    refresh()
        for note in list(self.session.notes):
            if note.number > self._told:
                self._told = note.number
                if not self._silent:
                    self.tell(note.text, note.tone)

    def close(self) -> None:
        """End: the window is gone."""
        self._leave()


def pressable(kind: str, action: Callable[[], Any], *, role: str = "button") -> ui.element:
    """A field of a kind (CSS classes) that a click, Enter or Space presses."""
    field = ui.element("div").classes(kind).props(f'role="{role}" tabindex="0"')
    for event in ("click", "keydown.enter", "keydown.space.prevent.stop"):
        field.on(event, action)
    return field


def name_upload(upload: ui.upload, words: str) -> ui.upload:
    """Name the hidden input of an upload and the button that opens it, for screen readers."""
    parts = "node.el.querySelectorAll('input[type=file], .q-uploader__header [role=button]')"
    upload.on("vnodeMounted", js_handler=f"(node) => {parts}.forEach((part) => (part.ariaLabel = '{words}'))")
    return upload


def show_heading(words: str, level: int = 2) -> ui.label:
    """Build the heading of a panel or dialog, level 1, or of a section."""
    label = ui.label(words).classes("studio-title" if level == 1 else "studio-section")
    return label.props(f'role="heading" aria-level="{level}"')


def icon_button(
    icon: str, words: str, action: Callable[[], Any] | None, *, small: bool = True, color: str | None = None
) -> ui.button:
    """A round button with a sign alone, small or not; its words are told to who points at it or cannot see it."""
    button = ui.button(icon=icon, color=color, on_click=action).props("flat round dense" + " size=sm" * small)
    button.props["aria-label"] = words
    return button.tooltip(words)


LASTING = {Tone.BAD: 9.0, Tone.PLAIN: 3.0, Tone.GOOD: 3.0}  # seconds that a note is seen
ICONS = {Tone.BAD: "error_outline", Tone.GOOD: "check_circle"}


class Toasts:
    """The newest notes; one that is no complaint takes the place of the one before, so that none pile up."""

    def __init__(self) -> None:
        """Fills the element that it is made in; it may be moved."""
        self.room = ui.element("div").classes("studio-toasts").props('aria-live="polite"')
        self._shown: list[tuple[ui.element, Tone, str]] = []

    def show(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Show a note for a while; a click takes it away, the same note again shows it longer."""
        for toast, other, words in list(self._shown):
            if words == text or (tone is not Tone.BAD and other is not Tone.BAD):
                self._drop(toast)
        most = 2  # Notes that are shown at once
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
