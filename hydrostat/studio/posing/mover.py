"""`Mover`: the contract of what makes a body follow points that are held; `MuscleMover`: the body's own muscles."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.design import FreePosing
from hydrostat.geometry import locate
from hydrostat.robot import Marker, Robot
from hydrostat.studio.posing.held import Anchored, HeldPoint
from hydrostat.studio.view.things import RobotShape


class Mover(ABC):
    """Moves one robot, a step at a time. It works in one thread."""

    robot: Robot  # whose body it moves

    @abstractmethod
    def rest(self) -> RobotShape:
        """Back to rest at once: nothing pulls."""

    @abstractmethod
    def update(self, held: Mapping[str, HeldPoint]) -> tuple[RobotShape, bool]:
        """One step towards the targets; the shape, and whether there is more to gain."""


PATIENCE = 120  # so many updates are made towards targets that stay where they are
FAINT = 1e-3  # a share of their strength with which muscles count as at rest: they are not shown as the strongest
MISSED = 0.01  # from this distance on a target counts as out of reach, in sizes of the body


class MuscleMover(Mover):
    """Free posing on muscle fibres: no cable pulls (R36 to R38); markers that nobody holds rather stay."""

    def __init__(self, robot: Robot) -> None:
        """Begin at rest; the sparse pattern is made here."""
        self.robot = robot
        self._posing, self._anchored = FreePosing(robot), Anchored(robot.body.mesh)
        self.mark(robot.markers)
        self._held: Mapping[str, HeldPoint] = {}
        self._updates = 0

    def mark(self, markers: Sequence[Marker]) -> None:
        """Take these as the markers that should rather stay while they are not held."""
        mesh = self.robot.body.mesh
        self._markers = markers
        self._calm = locate(mesh, np.array([marker.at for marker in markers], dtype=float).reshape(-1, mesh.dim))

    @property
    def pulls(self) -> tuple[Nodes, Vector]:
        """Positions of the nodes [m], and the tension of the muscle on each edge of the mesh [N]."""
        return self._posing.nodes, self._posing.tensions

    def rest(self) -> RobotShape:
        """Back to rest at once."""
        self._posing.rest()
        return self._shape({}, False)

    def update(self, held: Mapping[str, HeldPoint]) -> tuple[RobotShape, bool]:
        """One step of the muscles; without targets they let go, a step at a time."""
        if held is not self._held:
            self._held, self._updates = held, 0
        self._updates += 1
        taken = {point.at for point in held.values()}
        calm = self._calm.select_points([index for index, marker in enumerate(self._markers) if marker.at not in taken])
        more = self._posing.update(self._anchored.anchors(held), self._anchored.goals(held), calm)
        more = more and self._updates < PATIENCE
        return self._shape(held, more), more

    def _shape(self, held: Mapping[str, HeldPoint], more: bool) -> RobotShape:
        nodes, robot, tensions = self._posing.nodes, self.robot, self._posing.tensions
        pulls = self._posing.fibres.around_nodes(tensions, len(nodes))
        most = max(float(pulls.max()), FAINT * self._posing.strength)
        errors = self._anchored.errors(held, nodes)
        far = not more and max(errors.values(), default=0.0) > MISSED * robot.body.mesh.size
        return RobotShape(
            nodes=nodes,
            tensions=np.zeros(len(robot.cables)),
            contractions=np.zeros(len(robot.winches)),
            errors=errors,
            muscles=pulls / most,
            notes=("muscle limit: target not reached",) if far else (),
        )
