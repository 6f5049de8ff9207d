"""`Bar`: what a winch does, for a bar on the screen."""

from dataclasses import dataclass

import numpy as np

from hydrostat.plot.palette import winch_colours
from hydrostat.robot import Robot
from hydrostat.studio.view.shape import Shape


@dataclass(frozen=True, kw_only=True)
class Bar:
    """What one winch does.

    Attributes:
        winch: its name.
        colour: of it.
        contraction: cable taken in [m].
        travel: the most it can take in [m].
        release: the most it can let out [m].
        tension: the largest of its cables [N].
        limit: the most that a cable bears [N].
    """

    winch: str
    colour: str
    contraction: float
    travel: float
    release: float
    tension: float
    limit: float


def bars(robot: Robot, shape: Shape, limit: float) -> list[Bar]:
    """A bar for each winch.

    Args:
        robot: whose winches they are.
        shape: what they do.
        limit: the most that a cable bears [N].
    """
    colours = winch_colours(robot)
    largest = dict.fromkeys(colours, 0.0)
    for cable, tension in zip(robot.cables, np.asarray(shape.tensions).tolist(), strict=True):
        largest[cable.winch] = max(largest[cable.winch], tension)
    return [
        Bar(
            winch=winch.name,
            colour=colours[winch.name],
            contraction=contraction,
            travel=winch.travel,
            release=winch.release,
            tension=largest[winch.name],
            limit=limit,
        )
        for winch, contraction in zip(robot.winches, np.asarray(shape.contractions).tolist(), strict=True)
    ]
