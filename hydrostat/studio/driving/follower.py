"""`Follower`: the body, as its winches pull it."""

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation, SolvedPose
from hydrostat.studio.view.shape import Shape, rest_shape

ROUGH = 1e-3
"""Force that may be left over while it moves, as a share of the largest: 2 micrometres off, in half the time."""

FEW = 6
"""Steps of Newton in which a body that moves should get there; else it is solved with all care."""


class Follower:
    """Solves for the newest contractions, from the last good pose; where there is none, the last good one stays.

    Attributes:
        failure: why the last contractions have no shape; "" if they have.
    """

    def __init__(self) -> None:
        self.failure = ""
        self._simulation: Simulation | None = None
        self._last: SolvedPose | None = None

    def follow(self, simulation: Simulation, contractions: Vector, *, rough: bool = False) -> Shape:
        """The body at these contractions [m], or as it was last; `failure` tells which.

        Args:
            simulation: of the robot.
            contractions: of its winches [m].
            rough: whether it moves on at once, so that the last digits do not matter.
        """
        if simulation is not self._simulation:
            self._simulation, self._last = simulation, None
        pose = self._roughly(simulation, contractions) if rough else None
        if pose is None:
            pose = simulation.solve(contractions, start=self._last, strict=False)
        if pose.result.converged and upright(simulation.robot, pose):
            self._last, self.failure = pose, ""
        else:
            why = pose.result.reason if not pose.result.converged else "the body would turn inside out"
            self.failure = f"no shape was found there ({why}); the last one is shown: go back a little"
        if self._last is None:
            return rest_shape(simulation.robot)
        return Shape(nodes=self._last.nodes, tensions=self._last.tensions, contractions=self._last.contractions)

    def _roughly(self, simulation: Simulation, contractions: Vector) -> SolvedPose | None:
        """From the last pose in a few steps; None if that does not do, or friction makes the way matter."""
        last = self._last
        if last is None or simulation.friction is not None:
            return None
        near = simulation.stiffness(last)
        found = simulation.relax(last.nodes, contractions, near, iterations=FEW, tolerance=ROUGH)
        return simulation.posed(contractions, found) if found.converged else None


def upright(robot: Robot, pose: SolvedPose) -> bool:
    """Whether no element is inverted."""
    corners = pose.nodes[robot.body.mesh.elements]
    return bool((np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all())
