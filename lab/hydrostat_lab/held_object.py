"""`HeldObject`, `contractions`: a free object between the fingers of a robot, from keyframe to keyframe."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from hydrostat.arrays import Points, Vector
from hydrostat.mechanics import GuideEnergy, NewtonOptions
from hydrostat.robot import Obstacle, Robot
from hydrostat.simulation import BodyPhysics, Motion, Simulation, StepOptions, with_replaced


def contractions(robot: Robot, parts: Mapping[str, float]) -> Vector:
    """Return the contraction of each winch [m] from parts of names of winches, in mm; later parts win."""
    taken = np.zeros(len(robot.winches))
    for part, value in parts.items():
        taken[[part in winch.name for winch in robot.winches]] = 1e-3 * value
    return taken


class HeldObject:
    """A robot and an object with a mass, the last of its obstacles, on a spring."""

    def __init__(
        self, robot: Robot, *, hold: float, turning: float = 0.0, tolerance: float = 1e-10, drag: float = 5.0
    ) -> None:
        """Start at rest.

        Args:
            robot: robot with the object as its last obstacle.
            hold: stiffness of the spring that holds the center of the object [N/m].
            turning: stiffness of the spring that holds its axes [N/m].
            tolerance: share of the largest force that a time step may leave.
            drag: drag on the foam and the object [1/s].
        """
        self.robot, self.object, self._drag = robot, robot.obstacles[-1], drag
        self.start_place, self.start_axes = self.object.frame()
        physics = BodyPhysics(robot)
        self.carriage = physics.rigid_dofs[len(robot.obstacles) - 1]
        self._guide = self._spring(hold, turning)
        self.simulation = Simulation(
            robot, body=physics, energies=[self._guide], options=NewtonOptions(tolerance=tolerance)
        )
        self.motion = self.simulation.motion_at_rest()

    def _spring(self, hold: float, turning: float) -> GuideEnergy:
        return GuideEnergy(
            self.carriage,
            place=self.start_place,
            axes=self.start_axes,
            along=hold * np.eye(len(self.start_place)),
            turning=turning,
        )

    def release(self) -> None:
        """Remove the spring."""
        self.simulation = with_replaced(self.simulation, self._guide, self._spring(0.0, 0.0))

    def advance(self, goal: Vector, step: float) -> Motion:
        """Return the motion one step [s] later."""
        self.motion = self.simulation.step(
            self.motion, goal, step, options=StepOptions(scheme="euler", drag=self._drag)
        )
        return self.motion

    def current_obstacle(self) -> Obstacle:
        """Return the object where it is."""
        return self.object.with_frame(self.place, self.axes)

    @property
    def rotation(self) -> Vector:
        """Rotation vector of the object since the start [degree]."""
        return np.rad2deg(Rotation.from_matrix(self.axes.T @ self.start_axes).as_rotvec())

    @property
    def place(self) -> Vector:
        """Center of the object [m]."""
        assert self.motion.carried is not None
        return self.motion.carried[0][0]

    @property
    def axes(self) -> Points:
        """Axes of the object, a row for each: the rotation nearest to its unknowns."""
        assert self.motion.carried is not None
        left, _, right = np.linalg.svd(self.motion.carried[0][1:] / self.carriage.length)
        return left @ right
