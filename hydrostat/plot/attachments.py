"""`Attachments`: where cables, winches and markers are in any pose, found in the mesh once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool

from hydrostat.arrays import Nodes, Points
from hydrostat.geometry.anchors import Anchors, locate
from hydrostat.plot.sheet import Spread
from hydrostat.robot import Mount, Robot
from hydrostat.robot.point import Point


@dataclass(frozen=True, eq=False)
class Attachments:
    """What a robot's body carries.

    Attributes:
        robot: whose cables, winches and markers they are.
    """

    robot: Robot

    def cables(self, nodes: Nodes) -> list[Spread]:
        """Where the points of each cable are [m] when the nodes are at `nodes` [m]."""
        ends = np.cumsum([len(cable.points) for cable in self.robot.cables])
        return np.split(self._cables.at(nodes), ends[:-1]) if self.robot.cables else []

    def winches(self, nodes: Nodes) -> Points:
        """Where each winch is [m] when the nodes are at `nodes` [m]."""
        return self._winches.at(nodes)

    def markers(self, nodes: Nodes) -> Points:
        """Where each marker is [m] when the nodes are at `nodes` [m]."""
        return self._markers.at(nodes)

    @cached_property
    def _cables(self) -> "_Stuck":
        cables = self.robot.cables
        fixed = [
            place == 0 and self.robot.winch(cable.winch).mount is Mount.WORLD
            for cable in cables
            for place in range(len(cable.points))
        ]
        return _Stuck.of(self.robot, [point for cable in cables for point in cable.points], fixed)

    @cached_property
    def _winches(self) -> "_Stuck":
        winches = self.robot.winches
        return _Stuck.of(self.robot, [part.at for part in winches], [part.mount is Mount.WORLD for part in winches])

    @cached_property
    def _markers(self) -> "_Stuck":
        markers = self.robot.markers
        return _Stuck.of(self.robot, [marker.at for marker in markers], [False] * len(markers))


@dataclass(frozen=True, eq=False)
class _Stuck:
    """Points that the body takes with it, but for those that are fixed in space.

    Attributes:
        rest: where they are at rest [m].
        moving: which of them the body takes with it.
        anchors: of those.
    """

    rest: Points
    moving: Bool[np.ndarray, " points"]
    anchors: Anchors

    @classmethod
    def of(cls, robot: Robot, points: Sequence[Point], fixed: Sequence[bool]) -> "_Stuck":
        rest = np.array(points, dtype=float).reshape(len(points), robot.body.mesh.dim)
        moving = ~np.array(fixed, dtype=bool)
        return cls(rest, moving, locate(robot.body.mesh, rest[moving]))

    def at(self, nodes: Nodes) -> Points:
        places = self.rest.copy()
        places[self.moving] = self.anchors.positions(nodes)
        return places
