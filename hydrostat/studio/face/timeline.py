"""`TimelineView`: keyframes in time, on the screen."""

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import events, ui

from hydrostat.control import Timeline
from hydrostat.control.player import Player
from hydrostat.plot.palette import winch_colours
from hydrostat.robot import Robot
from hydrostat.studio.face.sent_number import sent_number

HINT = "Turn the knobs and press Add; move the playhead, turn them again, add again. Then play."


class TimelineView(ui.element, component="static/timeline.js"):
    """A ruler, the contraction of each winch as a curve, keys as diamonds and the playhead.

    What a person does with it comes as "seek" and "add" (time), "choose" (index), "move" (index, time) and "drop".
    """

    def __init__(self) -> None:
        super().__init__()
        self._props.update(
            seconds=4.0, keys=[], colours=[], smooth=False, time=0.0, playing=False, speed=1.0, loop=True, chosen=None,
            hint=HINT,
        )  # fmt: skip

    def show_keys(self, robot: Robot, timeline: Timeline, chosen: int | None) -> None:
        """Show the keys of a timeline, one of them selected."""
        colours = winch_colours(robot)
        keys = [{"time": key.time, "values": _shares(robot, key.contractions)} for key in timeline.keys]
        self._set(
            seconds=timeline.seconds, smooth=timeline.smooth, keys=keys, chosen=chosen, colours=[*colours.values()]
        )

    def show_player(self, player: Player) -> None:
        """Show the playhead."""
        self._set(time=round(player.time, 4), playing=player.playing, speed=player.speed, loop=player.loop)

    def on_word(self, name: str, action: Callable[..., Any], *wanted: str) -> None:
        """Call something with these numbers of what a person does; a word without them is not heeded."""

        def heed(event: events.GenericEventArguments) -> None:
            words = event.args if isinstance(event.args, dict) else {}
            numbers = [sent_number(words.get(key)) for key in wanted]
            if None not in numbers:
                action(*numbers)

        self.on(name, heed)

    def _set(self, **props: Any) -> None:
        changed = {key: value for key, value in props.items() if self._props[key] != value}
        if changed:
            self._props.update(changed)
            self.update()


def _shares(robot: Robot, contractions: Mapping[str, float]) -> list[float]:
    """How far the winches go, from 0 for all that is let out to 1 for all that can be taken in."""
    shares = []
    for winch in robot.winches:
        share = (contractions.get(winch.name, 0.0) + winch.release) / (winch.travel + winch.release)
        shares.append(round(min(max(share, 0.0), 1.0), 4))
    return shares
