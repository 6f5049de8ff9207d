"""`STAGES`, `KEYS`, `Tour`, `help_dialog`: what each stage and key is for, in the help and in a tour of five steps."""

from collections.abc import Callable
from dataclasses import dataclass

from nicegui import events, ui

from hydrostat.studio.face.page import show_heading
from hydrostat.studio.stage import StageName


@dataclass(frozen=True)
class StageWords:
    """Texts that explain a stage."""

    title: str  # as on its button
    icon: str  # likewise
    line: str  # for the help
    tour: str = ""  # for who is here for the first time; "": the tour passes it by
    guest: str = ""  # the same for guests, who cannot open folders of the server; "": no other text


STAGES = {  # in the order of work
    StageName.START: StageWords(
        "Start", "home", "Choose a robot, or import a drawing, a picture or a scan.",
        "Choose a robot from the gallery, open a folder, or import a drawing, a picture or a scan. "
        "It becomes a soft body.",
        "Choose a robot from the gallery, open a .zip, or import a drawing, a picture or a scan. "
        "It becomes a soft body.",
    ),
    StageName.EDIT: StageWords(
        "Edit", "edit", "Place pins, markers, winches and cables. Checks run as you edit."
    ),
    StageName.POSE: StageWords(
        "Pose", "back_hand", "Drag the body, moved by muscles everywhere or by its own winches.",
        "Drag any point. The body bends as if it were full of muscle, "
        "or its own winches follow by inverse kinematics. Store a shape you like as a pose.",
    ),
    StageName.DESIGN: StageWords(
        "Design", "auto_awesome", "Find winches and cables for the poses, within build limits.",
        "Set the numbers of winches and cables, paint no-cable zones, and press Design. "
        "The best network so far appears on the body during the search.",
    ),
    StageName.DRIVE: StageWords(
        "Drive", "tune", "Turn the winches by hand, set keyframes, play and record.",
        "Turn a knob for each winch. Set keyframes, play them in a loop, record a video, "
        "or export the contractions as a table.",
    ),
    StageName.EXPORT: StageWords(
        "Export", "ios_share", "Download the kit, a report, pictures and the robot itself.",
        "Build the kit: patterns or molds, parts to print, a shopping list and an assembly sheet. "
        "Then make the robot.",
    ),
}  # fmt: skip


KEYS = (  # and what they do
    (("G",), "move the selection: click or drag to its target"),
    (("R",), "back to rest"),
    (("Z",), "undo"),
    (("Shift", "Z"), "redo"),
    (("Space",), "play or stop"),
    (("1", "3", "7"), "view from the front, the side, the top"),
    (("Shift", "click"), "select several parts; Ctrl A: all"),
    (("Ctrl", "C"), "copy the selection; Ctrl V: paste, Ctrl D: duplicate"),
    (("\u2190", "\u2192", "\u2191", "\u2193"), "move the selection by 1 mm; with Shift by 10 mm"),
    (
        ("PgUp", "PgDn"),
        "move the selection away, nearer (flat robots: up, down); on the timeline: previous, next keyframe",
    ),
    (("Enter",), "in Edit: show a cross-hair for the tool; arrows move it, Enter places"),
    (("Tab",), "next control; Enter or Space presses it"),
    (("+", "-"), "zoom the view; Ctrl with an arrow turns it"),
    (("Delete",), "delete the selection"),
    (("Esc",), "clear the selection; cancel"),
    (("Ctrl", "S"), "save; with Shift: save as"),
    (("?",), "this help"),
)
SEEN = "hydrostat-tour"  # where the browser keeps that it has shown the tour

PLACE = """
const [card, ring] = [getHtmlElement(%d), getHtmlElement(%d)];
removeEventListener("resize", card.place);
card.place = () => {
  const at = document.querySelector('[data-testid="stage-%s"]').getBoundingClientRect();
  const middle = at.left + at.width / 2, wide = card.offsetWidth;
  const left = Math.min(Math.max(middle - wide / 2, 12), innerWidth - wide - 12);
  card.style.left = left + "px";
  card.style.top = at.bottom + 18 + "px";
  card.style.setProperty("--at", middle - left + "px");
  ring.style.inset = `${at.top - 4}px auto auto ${at.left - 4}px`;
  ring.style.width = at.width + 8 + "px";
  ring.style.height = at.height + 8 + "px";
};
addEventListener("resize", card.place);
requestAnimationFrame(() => {
  card.place();
  card.classList.add("tour-there");
  card.querySelector(".tour-next").focus();
});
"""
"""Puts the card below the button of a stage, a ring round that, and the keyboard on the card."""


class Tour:
    """A small card that goes from stage to stage and says what each is for."""

    def __init__(self, *, guest: bool = False) -> None:
        """A tour for the owner of the studio, or for a guest."""
        self._stops = [(stage, words) for stage, words in STAGES.items() if words.tour]
        self._guest = guest
        self._step = 0
        self._ring = ui.element("div").classes("tour-ring")
        self._card = ui.element("div").classes("tour").props('role="dialog" aria-label="Tour" data-testid="tour"')
        with self._card, ui.element("div").classes("tour-head"):
            self._icon = ui.icon("home").classes("tour-icon")
            self._title = ui.label().classes("studio-title")
            self._count = ui.label().classes("tour-count")
        with self._card:
            self._words = ui.label().classes("tour-words")
            with ui.element("div").classes("tour-foot"):
                self._button("Skip", "tour-skip", self.end)
                ui.space()
                self._back = self._button("Back", "tour-back", lambda: self.show(self._step - 1))
                self._next = self._button("Next", "tour-next", lambda: self.show(self._step + 1))
                self._next.props(remove="flat", add="unelevated")
        self._card.on("keydown", self._key, args=["key"])
        self._set_visible(False)

    def show(self, step: int = 0) -> None:
        """Show one step; after the last the tour is over."""
        if step >= len(self._stops):
            self.end()
            return
        self._step = max(step, 0)
        stage, words = self._stops[self._step]
        self._icon.set_name(words.icon)
        self._title.set_text(words.title)
        self._words.set_text((self._guest and words.guest) or words.tour)
        self._count.set_text(f"{self._step + 1} of {len(self._stops)}")
        self._back.set_visibility(self._step > 0)
        self._next.set_text("Next" if self._step + 1 < len(self._stops) else "Start")
        self._set_visible(True)
        ui.run_javascript(PLACE % (self._card.id, self._ring.id, stage))

    def end(self) -> None:
        """Hide the card; this browser is not shown it again unless it is asked for."""
        self._set_visible(False)
        ui.run_javascript(f'localStorage.setItem("{SEEN}", "1")')

    async def offer(self) -> None:
        """Show the tour if this browser has not seen it."""
        try:
            seen = await ui.run_javascript(f'localStorage.getItem("{SEEN}")', timeout=10.0)
        except TimeoutError:  # the window is gone
            return
        if seen is None:
            self.show()

    def _set_visible(self, on: bool) -> None:
        self._card.set_visibility(on)
        self._ring.set_visibility(on)

    def _key(self, event: events.GenericEventArguments) -> None:
        key = event.args["key"]
        if key == "Escape":
            self.end()
        elif key == "ArrowRight":
            self.show(self._step + 1)
        elif key == "ArrowLeft":
            self.show(self._step - 1)

    @staticmethod
    def _button(words: str, name: str, action: Callable[[], None]) -> ui.button:
        return ui.button(words, on_click=action).props(f'flat dense no-caps data-testid="{name}"').classes(name)


def help_dialog(tour: Tour) -> Callable[[], object]:
    """Build the help: what the stages are for, and the keys; returns what opens it."""

    def begin() -> None:
        dialog.close()
        tour.show()

    with ui.dialog() as dialog, ui.card().classes("help"):
        with ui.element("div").classes("studio-row"):
            show_heading("Help", 1).classes("help-title flex-1", remove="studio-title")
            ui.button("Show the tour", icon="explore", on_click=begin).props('flat no-caps data-testid="help-tour"')
            ui.button(icon="close", on_click=dialog.close).props('flat round dense aria-label="Close"')
        with ui.element("div").classes("help-columns"):
            with ui.element("div").classes("help-stages"):
                for words in STAGES.values():
                    ui.icon(words.icon).classes("tour-icon")
                    with ui.column().classes("gap-0"):
                        show_heading(words.title).classes("help-head", remove="studio-section")
                        ui.label(words.line).classes("studio-hint")
            with ui.element("div").classes("help-keys"):
                for keys, what in KEYS:
                    with ui.element("div").classes("help-key"):
                        for key in keys:
                            ui.label(key).classes("help-cap")
                    ui.label(what)
    return dialog.open


def offer_tour(tour: Tour) -> None:
    """Show the tour as soon as the window is there, if this browser has not seen it."""
    delay = 0.5  # the window is drawn before something is laid over it [s]
    ui.timer(delay, tour.offer, once=True)
