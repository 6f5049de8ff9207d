"""From contractions in time to motors: the contract of a link, motors within limits, playing (R58)."""

from hydrostat.control.link import SILENCE, Link, SimulatedLink
from hydrostat.control.motors import FASTEST, Motors
from hydrostat.control.player import Player, play
from hydrostat.control.timeline import Key, Timeline, read_timeline, timeline_table

__all__ = [
    "FASTEST",
    "SILENCE",
    "Key",
    "Link",
    "Motors",
    "Player",
    "SimulatedLink",
    "Timeline",
    "play",
    "read_timeline",
    "timeline_table",
]
