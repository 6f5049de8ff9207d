"""`ThingPictures`: what a robot that moves a thing looks like, frame by frame, always in one frame."""

from dataclasses import replace

import numpy as np

from hydrostat.plot import Frame, FramePictures, Picture
from hydrostat.robot import Obstacle, Robot
from hydrostat.simulation import Simulation
from hydrostat.training.thing_world import ThingWorld


class ThingPictures:
    """Pictures of a robot with its thing; in each it is as large, and colours mean the same tension."""

    def __init__(self, robot: Robot, thing: Obstacle) -> None:
        """Room for the body at rest and a share more around it, and for the thing; colours up to a share of travel."""
        self._given = robot, thing
        alone = replace(robot, obstacles=())
        rest = robot.body.mesh.nodes
        middle = 0.5 * (rest.min(axis=0) + rest.max(axis=0))
        taken = np.array([_TAKEN * winch.travel for winch in robot.winches])
        most = Simulation(alone).solve(taken, strict=False)
        room = Frame(nodes=middle + _ROOM * (rest - middle), tensions=most.tensions, things=(thing,))
        self._pictures = FramePictures(alone, [room], width=_WIDTH)

    def __reduce__(self) -> tuple[type["ThingPictures"], tuple[Robot, Obstacle]]:
        """Make anew what is copied or sent: a figure of matplotlib that was copied draws nothing more."""
        return ThingPictures, self._given

    def draw(self, world: ThingWorld, words: str) -> Picture:
        """The picture of where robot and thing are, with words below the name of the robot."""
        return self._pictures.draw(Frame.of(world.motion, words=words, things=world.drawn()))


_ROOM, _TAKEN, _WIDTH = 1.25, 0.3, 640
"""Width of the frame in widths of the body at rest, contractions of the colours, width of a picture [pixels]."""
