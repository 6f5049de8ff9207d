"""`Attachments`: where cables, winches and markers are in any pose, found in the mesh once."""

from functools import cached_property

import numpy as np
from jaxtyping import Bool

from hydrostat.arrays import Nodes, Points
from hydrostat.geometry import Anchors, locate
from hydrostat.plot.sheet import Spread
from hydrostat.robot import Mount, Robot


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
