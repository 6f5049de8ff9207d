"""`Mover`: the contract of what makes a body follow points that are held."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from hydrostat.arrays import Nodes, Points
from hydrostat.geometry.anchors import Anchors, locate
from hydrostat.geometry.mesh import Mesh
from hydrostat.robot import Point, Robot
from hydrostat.studio.posing.held import Held
from hydrostat.studio.view.shape import Shape


class Mover(ABC):
    """Moves one robot, a step at a time. It works in one thread.

    Attributes:
        robot: whose body it moves.
    """

    robot: Robot

    @abstractmethod
    def rest(self) -> Shape:
        """Back to rest at once: nothing pulls."""

    @abstractmethod
    def update(self, held: Mapping[str, Held]) -> tuple[Shape, bool]:
        """One step towards the targets; the shape, and whether there is more to gain."""


class Anchored:
    """Where held points are stuck to the mesh, found once for as long as they are the same; any thread may ask."""

    def __init__(self, mesh: Mesh) -> None:
        """Points of this body."""
        self._mesh = mesh
        self._found: tuple[tuple[Point, ...], Anchors] = ((), locate(mesh, np.zeros((0, mesh.dim))))

    def anchors(self, held: Mapping[str, Held]) -> Anchors:
        """The points as anchors, in their order."""
        places = tuple(point.at for point in held.values())
        known, anchors = self._found
        if places != known:
            anchors = locate(self._mesh, np.array(places, dtype=float).reshape(-1, self._mesh.dim))
            self._found = places, anchors
        return anchors

    def goals(self, held: Mapping[str, Held]) -> Points:
        """Where they should go [m], (points, dim)."""
        return np.array([point.target for point in held.values()], dtype=float).reshape(-1, self._mesh.dim)

    def places(self, held: Mapping[str, Held], nodes: Nodes) -> Points:
        """Where they are when the nodes are at `nodes` [m], (points, dim)."""
        return self.anchors(held).positions(nodes)

    def errors(self, held: Mapping[str, Held], nodes: Nodes) -> dict[str, float]:
        """How far each is from its target [m]."""
        misses = np.linalg.norm(self.places(held, nodes) - self.goals(held), axis=1)
        return dict(zip(held, misses.tolist(), strict=True))
