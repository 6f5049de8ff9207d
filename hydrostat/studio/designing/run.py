"""`Run`: a design that goes on, or has just ended."""

from dataclasses import dataclass, field

import numpy as np

from hydrostat.robot import Pose, Robot
from hydrostat.studio.designing.asked import Asked


@dataclass(frozen=True, kw_only=True)
class Mark:
    """The best network at one moment.

    Attributes:
        seconds: since the design was asked for.
        error: root of the mean squared marker error over all poses [m].
        winches: how many it has.
        cables: how many it has.
    """

    seconds: float
    error: float
    winches: int
    cables: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """How far a design is.

    Attributes:
        asked: what it began with.
        began: when, on a clock that only runs forward [s].
        rest: error if nothing moved [m].
        best: the robot with the best network so far; with what stays of its own before the first.
        words: what was done last.
        trail: of the best network, in time.
    """

    asked: Asked
    began: float
    rest: float
    best: Robot
    words: str = ""
    trail: tuple[Mark, ...] = field(default=())


def beginning(asked: Asked) -> Robot:
    """The robot with what a search begins with: its own network if that is improved, else what is kept of it."""
    robot, limits = asked.robot, asked.constraints
    if asked.improve:
        return robot
    cables = [robot.cables[number] for number in limits.locked_cables]
    kept = {*limits.locked_winches, *(cable.winch for cable in cables)}
    return robot.with_network([winch for winch in robot.winches if winch.name in kept], cables)


def error_at_rest(robot: Robot, poses: tuple[Pose, ...]) -> float:
    """Root of the mean squared distance of markers from their targets over all poses, if nothing moved [m]."""
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    squares = [
        np.mean([np.sum((places[name] - np.array(goal)) ** 2) for name, goal in pose.targets.items()])
        for pose in poses
        if pose.targets
    ]
    return float(np.sqrt(np.mean(squares))) if squares else 0.0
