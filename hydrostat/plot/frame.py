"""Picture of a robot at one instant: `Frame`, and the places where pins and winches attach."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from hydrostat.arrays import Bool, Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, locate
from hydrostat.plot.sheet import Spread
from hydrostat.robot import Mount, Obstacle, PoseTarget, Robot
from hydrostat.simulation import Equilibrium, Motion


class Attachments:
    """Painter of the parts on a robot's body: cables, winches and markers."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        outside = {winch.name for winch in robot.winches if winch.mount is Mount.WORLD}
        cables, winches, markers = robot.cables, robot.winches, robot.markers
        self._mesh = robot.body.mesh
        self._ends = np.cumsum([*(len(cable.points) for cable in cables), len(winches)])
        points = [*(at for cable in cables for at in cable.points), *(part.at for part in (*winches, *markers))]
        self._rest = np.array(points, dtype=float).reshape(-1, self._mesh.dim)
        first = [place == 0 and cable.winch in outside for cable in cables for place in range(len(cable.points))]
        fixed = [*first, *(winch.name in outside for winch in winches), *(False for _ in markers)]
        self._moving: Bool[np.ndarray, " points"] = ~np.array(fixed, dtype=bool)

    def cables(self, nodes: Nodes) -> list[Spread]:
        """Points of each cable [m] when the nodes are at `nodes` [m]."""
        return self._parts(nodes)[:-2]

    def winches(self, nodes: Nodes) -> Points:
        """Places of the winches [m] when the nodes are at `nodes` [m]."""
        return self._parts(nodes)[-2]

    def markers(self, nodes: Nodes) -> Points:
        """Places of the markers [m] when the nodes are at `nodes` [m]."""
        return self._parts(nodes)[-1]

    @cached_property
    def _anchors(self) -> Anchors:
        """Anchors of the points that move with the body."""
        return locate(self._mesh, self._rest[self._moving])

    def _parts(self, nodes: Nodes) -> list[Spread]:
        """Points of each cable, then of the winches, then of the markers [m]."""
        places = self._rest.copy()
        places[self._moving] = self._anchors.positions(nodes)
        return np.split(places, self._ends)


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """Content of a motion picture at one instant."""

    nodes: Nodes  # positions of the nodes [m]
    tensions: Vector  # of each cable [N]
    contractions: Vector | None = None  # cable taken in by each winch [m]; without, no winch is seen to turn
    target: PoseTarget | None = None  # the pose that is approached, whose targets are shown
    words: str = ""  # what happens, in a line
    obstacles: tuple[Obstacle, ...] = ()  # beside the robot, where they are

    @classmethod
    def of(
        cls,
        found: Equilibrium | Motion,
        *,
        target: PoseTarget | None = None,
        words: str = "",
        obstacles: Sequence[Obstacle] = (),
    ) -> Self:
        """The frame that shows an equilibrium, or an instant of a motion, and obstacles beside the robot."""
        told = {"nodes": found.nodes, "tensions": found.tensions, "contractions": found.contractions}
        return cls(**told, target=target, words=words, obstacles=tuple(obstacles))


def check_frames(robot: Robot, frames: Sequence[Frame]) -> None:
    """Refuse frames that do not fit the robot before work begins (InputError: none, or wrong or infinite numbers)."""
    if not frames:
        raise InputError("an animation needs at least one frame")
    for index, frame in enumerate(frames):
        wanted = {
            "nodes": (frame.nodes, robot.body.mesh.nodes.shape),
            "tensions": (frame.tensions, (len(robot.cables),)),
            "contractions": (frame.contractions, (len(robot.winches),)),
        }
        for name, (values, shape) in wanted.items():
            if values is not None and not (np.shape(values) == shape and np.isfinite(values).all()):
                raise InputError(f"frame {index}: its {name} must be finite, {shape}, not {np.shape(values)}")
