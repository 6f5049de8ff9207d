"""`ReachPictures`: what a robot that reaches looks like, frame by frame, always in one frame."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.plot import Frame, FramePictures, Picture
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Simulation


class ReachPictures:
    """Pictures of a robot at contractions, with its goal; in each it is as large, and colours mean the same tension."""

    def __init__(self, robot: Robot) -> None:
        """Room for the body at rest and a share more around it; colours up to the tensions with all cable taken in."""
        self._robot, self._simulation = robot, Simulation(robot)
        rest = robot.body.mesh.nodes
        middle = 0.5 * (rest.min(axis=0) + rest.max(axis=0))
        most = self._simulation.solve(np.array([winch.travel for winch in robot.winches]), strict=False)
        room = Frame(nodes=middle + _ROOM * (rest - middle), tensions=most.tensions)
        self._pictures = FramePictures(robot, [room], width=_WIDTH)

    def __reduce__(self) -> tuple[type["ReachPictures"], tuple[Robot]]:
        """Make anew what is copied or sent: a figure of matplotlib that was copied draws nothing more."""
        return ReachPictures, (self._robot,)

    def draw(self, pose: Equilibrium | None, contractions: Vector, goal: PoseTarget, words: str) -> Picture:
        """The picture of a pose, with words below the name of the robot; without one, of contractions [m] from rest."""
        pose = pose or self._simulation.solve(contractions, strict=False)
        frame = Frame(
            nodes=pose.nodes, tensions=pose.tensions, contractions=pose.contractions, target=goal, words=words
        )
        return self._pictures.draw(frame)


_ROOM, _WIDTH = 1.25, 640
"""Width of the frame in widths of the body at rest, and width of a picture [pixels]."""
