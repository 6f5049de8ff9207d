"""`WalkPictures`: what a robot that walks looks like, frame by frame; the eye goes with it, and the ground goes by."""

import numpy as np

from hydrostat.plot import Frame, FramePictures, Picture
from hydrostat.robot import Obstacle, ObstacleShape, Robot
from hydrostat.simulation import Motion, Simulation


class WalkPictures:
    """Pictures of a robot as large in each, the middle of its mass in one place; colours mean the same tension."""

    def __init__(self, robot: Robot, most: float) -> None:
        """Room for the body at rest and a share more; colours up to tensions at a share of `most` [m]."""
        self._robot, self._most = robot, most
        rest = robot.body.mesh.nodes
        middle = 0.5 * (rest.min(axis=0) + rest.max(axis=0))
        full = Simulation(robot).tensions(rest, np.full(len(robot.winches), _SHARE * most))
        room = Frame(nodes=middle + _ROOM * (rest - middle), tensions=full)
        self._pictures = FramePictures(robot, [room], width=_WIDTH)

    def __reduce__(self) -> tuple[type["WalkPictures"], tuple[Robot, float]]:
        """Make anew what is copied or sent: a figure of matplotlib that was copied draws nothing more."""
        return WalkPictures, (self._robot, self._most)

    def draw(self, motion: Motion, way: float, words: str) -> Picture:
        """The picture of an instant, after a way in x [m], with words below the name of the robot."""
        shift = np.zeros(motion.nodes.shape[1])
        shift[0] = way
        frame = Frame(
            nodes=motion.nodes - shift,
            tensions=motion.tensions,
            contractions=motion.contractions,
            words=words,
            things=self._marks(way),
        )
        return self._pictures.draw(frame)

    def _marks(self, way: float) -> tuple[Obstacle, ...]:
        """Posts in the ground, one every tenth of the body's size, that go by."""
        mesh = self._robot.body.mesh
        ground = next(thing for thing in self._robot.obstacles if thing.shape is ObstacleShape.PLANE)
        gap, middle = 0.1 * mesh.size, 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
        first = np.ceil((middle[0] - 0.7 * mesh.size + way) / gap)
        marks = []
        for number in range(int(first), int(first) + 14):
            low, high = middle.copy(), middle.copy()
            low[0], high[0] = number * gap - way, number * gap - way + 0.15 * gap
            low[-1], high[-1] = ground.at[-1] - 0.2 * gap, ground.at[-1] - 0.02 * gap
            if len(low) == 3:
                low[1], high[1] = mesh.nodes[:, 1].min(), mesh.nodes[:, 1].max()
            marks.append(Obstacle(name=f"mark {number}", shape="box", at=tuple(low), to=tuple(high)))
        return tuple(marks)


_ROOM, _WIDTH, _SHARE = 1.25, 640, 0.2
"""Width of the frame in bodies at rest, width of a picture [pixels], and share of `most` for colours."""
