"""`Work`: all that can be undone."""

from dataclasses import dataclass, field

from hydrostat.control import Timeline
from hydrostat.robot import Robot
from hydrostat.studio.records.wishes import Wishes


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """What a person works on; each change makes a new one.

    Attributes:
        robot: body, pins, winches, cables, markers, poses.
        timeline: keyframes.
        wishes: for a design.
    """

    robot: Robot
    timeline: Timeline = field(default_factory=Timeline)
    wishes: Wishes = field(default_factory=Wishes)
