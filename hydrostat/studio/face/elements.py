"""`Knob`, `TimelineView`, `OutlineEditor`: elements of the page that are drawn by JavaScript of ours."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from nicegui import events, ui

from hydrostat.control import Player, Timeline
from hydrostat.drawing import Color
from hydrostat.robot import Robot
from hydrostat.studio.face.messages import sent_number
from hydrostat.studio.starting.loops import HANDLE, Loop, send_loops
from hydrostat.studio.starting.photo import Backdrop


class Knob(ui.element, component="static/knob.js"):
    """A knob for a number; while a person holds it, it heeds nobody else, so that no answer fights the hand.

    Its hand shows what is wanted, the arc around it what is reached.
    """

    def __init__(self, *, least: float, most: float, step: float, color: str, label: str) -> None:
        """A knob from least to most, in steps of wheel and arrow keys; who cannot see it hears its label."""
        super().__init__()
        self._props.update(value=0.0, reach=0.0, least=least, most=most, step=step, color=color, label=label)

    def show(self, wanted: float, reached: float) -> None:
        """Show what is wanted and what is reached."""
        seen = 0.05  # changes smaller than this are not sent to the screen
        if abs(wanted - self._props["value"]) > seen or abs(reached - self._props["reach"]) > seen:
            self._props["value"], self._props["reach"] = wanted, reached
            self.update()

    def on_turn(self, turn: Callable[[float], Any], let_go: Callable[[], Any]) -> None:
        """Call `turn` with the number that a person turns it to, and `let_go` after that."""

        def handle_event(event: events.GenericEventArguments) -> None:
            number = sent_number(event.args)
            if number is not None:
                turn(number)

        self.on("turn", handle_event)
        self.on("letgo", lambda: let_go())


HINT = "Turn the knobs and press Add. Move the playhead, turn the knobs and add again. Then play."


class TimelineView(ui.element, component="static/timeline.js"):
    """A ruler, the contraction of each winch as a curve, keys as diamonds and the playhead.

    What a person does with it comes as "seek" and "add" (time), "choose" (index), "move" (index, time) and "drop".
    """

    def __init__(self) -> None:
        super().__init__()
        self._props.update(
            seconds=4.0, keys=[], colors=[], smooth=False, time=0.0, playing=False, speed=1.0, loop=True, chosen=None,
            hint=HINT,
        )  # fmt: skip

    def show_keys(self, robot: Robot, timeline: Timeline, chosen: int | None) -> None:
        """Show the keys of a timeline, one of them selected."""
        colors = Color.of_winches(robot.winches)
        keys = [{"time": key.time, "values": _shares(robot, key.contractions)} for key in timeline.keys]
        self._set(seconds=timeline.seconds, smooth=timeline.smooth, keys=keys, chosen=chosen, colors=[*colors.values()])

    def show_player(self, player: Player) -> None:
        """Show the playhead."""
        self._set(time=round(player.time, 4), playing=player.playing, speed=player.speed, loop=player.loop)

    def on_word(self, name: str, action: Callable[..., Any], *wanted: str) -> None:
        """Call something with these numbers of what a person does; a word without them is not heeded."""

        def handle(event: events.GenericEventArguments) -> None:
            words = event.args if isinstance(event.args, dict) else {}
            numbers = [sent_number(words.get(key)) for key in wanted]
            if None not in numbers:
                action(*numbers)

        self.on(name, handle)

    def _set(self, **props: Any) -> None:
        changed = {key: value for key, value in props.items() if self._props[key] != value}
        if changed:
            self._props.update(changed)
            self.update()


def winch_badge(mark: str, color: str) -> None:
    """The mark of a winch in the kit, as W1, in its color."""
    style = "border-radius: 4px; padding: 1px 4px; font-size: 11px; font-weight: 600; color: white; flex: none"
    ui.label(mark).style(f"{style}; background: {color}").tooltip("Label of this winch in the kit")


def _shares(robot: Robot, contractions: Mapping[str, float]) -> list[float]:
    """Contractions as shares of the winch travel, from 0 (all cable let out) to 1 (all reeled in)."""
    shares = []
    for winch in robot.winches:
        share = (contractions.get(winch.name, 0.0) + winch.release) / (winch.travel + winch.release)
        shares.append(round(min(max(share, 0.0), 1.0), 4))
    return shares


class OutlineEditor(ui.element, component="static/outline_editor.js"):
    """Corners, curves and holes on a grid in millimeters.

    A click adds corners to the loop that is begun, and closes it at its first corner; corners are dragged, a click on
    an edge puts one in, Delete removes one, a double click makes one round or sharp. What a screen sends is checked
    by `starting.loops.read_loops`.
    """

    def __init__(self, loops: Sequence[Loop], on_change: Callable[[Any], None], behind: Backdrop | None = None) -> None:
        """An editor of loops, over a picture if there is one; `on_change` gets what was sent, not yet checked."""
        super().__init__()
        self._props["handle"] = HANDLE
        self._props["start"] = send_loops(loops)
        self._props["fault"] = False
        self._props["behind"] = None if behind is None else asdict(behind)
        self.on("change", lambda event: on_change(event.args))  # pyright: ignore[reportAttributeAccessIssue]

    def show(self, loops: Sequence[Loop]) -> None:
        """Put other loops in place of these; it can be undone."""
        self.run_method("put", send_loops(loops))

    def set_fault(self, faulty: bool) -> None:
        """Draw them as a warning, as they are no body, or as usual."""
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
        """Draw a loop with the next clicks, a hole if it lies inside."""
        self.run_method("begin")

    def remove_corner(self) -> None:
        """Remove the corner that is chosen."""
        self.run_method("removeCorner")

    def fit(self) -> None:
        """Show all there is."""
        self.run_method("fit")

    def set_mirror(self, on: bool) -> None:
        """Let both sides of x = 0 change together, or each alone."""
        self.run_method("setMirror", on)

    def set_snap(self, on: bool) -> None:
        """Keep corners on the grid, or set them free."""
        self.run_method("setSnap", on)
