"""`Demand`: what the poses of a robot ask of its motors and cables."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import IKOptions, IKResult, Limits, solve_ik, spool_arms
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import PoseTarget, Robot, Winch
from hydrostat.simulation import Equilibrium, Simulation

DEMAND_STAGE = "Loads in its poses"  # as `Demand.find` reports its progress

_ONCE = IKOptions(restarts=0)
"""No restarts: a pose that is better by some micrometers makes no difference to a motor."""


MISSED_POSE_SHARE = 0.1
"""A pose that is missed by more than this share of the body's size is told: its loads are those of another pose."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Demand:
    """The largest loads in all poses that were solved."""

    poses: tuple[str, ...]  # solved poses, in words
    tensions: Vector  # largest of each cable [N], in cable order
    # largest on the shaft of each winch [N m], in winch order: sum of tension times radius of the spool, less what
    # reversed cables pull
    torques: Vector
    taken: Float[np.ndarray, "winches 2"]  # least and most cable that each winch takes in [m], (winches, 2)
    missed: tuple[str, ...] = ()  # poses that could not be solved, in words
    far: tuple[str, ...] = ()  # sentences on poses that are out of reach
    contractions: tuple[Vector, ...] = ()  # of all winches in each pose of the robot that was solved [m]

    @staticmethod
    def find(
        robot: Robot,
        *,
        tension: float | None = None,
        torque: float | None = None,
        progress: Progress = no_progress,
    ) -> "Demand":
        """Find the loads of a robot's poses by inverse kinematics; without poses, of each winch alone at full travel.

        Winches are pulled alone too if no pose could be solved. In poses no cable is pulled with more than the tension
        [N] and no winch with more than the torque [N m], as whoever plays them should keep to them; without these
        winches do all they can. Cables with friction come to each pose
        straight from rest. `progress` receives the number of poses that are solved.
        """
        if not robot.cables:
            count = len(robot.winches)
            return Demand(poses=(), tensions=np.zeros(0), torques=np.zeros(count), taken=np.zeros((count, 2)))
        work = _PoseLoads(robot, Limits(tension=tension, torque=torque))
        for done, pose in enumerate(robot.poses.values()):
            progress(DEMAND_STAGE, done, len(robot.poses))
            work.reach(pose)
        if not work.solved:
            for winch in robot.winches:
                work.pull(winch)
        return work.demand()

    @staticmethod
    def of_results(robot: Robot, reached: Sequence[IKResult]) -> "Demand":
        """The loads of poses that are solved already, as a design has them."""
        rest = (np.zeros(len(robot.winches)), np.zeros(len(robot.cables)))
        solved = [(each.pose.contractions, each.pose.tensions) for each in reached]
        names = [f'pose "{each.target.name}"' if each.target else "pose" for each in reached]
        return _sum_up(robot, names, [rest, *solved])


def _sum_up(robot: Robot, poses: Sequence[str], loads: Sequence[tuple[Vector, Vector]]) -> Demand:
    """Largest loads, from contractions [m] and tensions [N] at rest and in poses."""
    taken, tensions = np.array([one for one, _ in loads]), [one for _, one in loads]
    return Demand(
        poses=tuple(poses),
        tensions=np.max(tensions, axis=0),
        torques=np.max([shaft_torques(robot, each) for each in tensions], axis=0),
        taken=np.stack([taken.min(axis=0), taken.max(axis=0)], axis=1),
    )


class _PoseLoads:
    """Solves poses of a robot, and keeps what was found."""

    def __init__(self, robot: Robot, limits: Limits) -> None:
        self._robot, self._limits = robot, limits
        self._simulation = Simulation(robot)
        self.solved: dict[str, Equilibrium] = {}
        self._missed: list[str] = []
        self._far: list[str] = []

    def reach(self, pose: PoseTarget) -> None:
        """A pose, as near as winches come."""
        name = f'pose "{pose.name}"'
        try:
            reached = solve_ik(self._simulation, pose, limits=self._limits, options=_ONCE)
            self.solved[name] = reached.pose.without_factors()
        except (InputError, NotConvergedError) as error:
            self._missed.append(f"{name}: {error}")
            return
        if reached.rms_error > MISSED_POSE_SHARE * self._robot.body.mesh.size:
            self._far.append(
                f"{name} is missed by {1e3 * reached.rms_error:.0f} mm (rms). Its loads are those of the nearest pose "
                "that the winches reach"
            )

    def pull(self, winch: Winch) -> None:
        """One winch to its full travel."""
        name = f'winch "{winch.name}" at its full travel'
        try:
            self.solved[name] = self._simulation.solve({winch.name: winch.travel}).without_factors()
        except NotConvergedError as error:
            self._missed.append(f"{name}: {error}")

    def demand(self) -> Demand:
        """The largest of all, those at rest among them."""
        poses = [self._simulation.rest, *self.solved.values()]
        found = _sum_up(self._robot, tuple(self.solved), [(pose.contractions, pose.tensions) for pose in poses])
        own = tuple(pose.contractions for pose in self.solved.values()) if self._robot.poses else ()
        return replace(found, missed=tuple(self._missed), far=tuple(self._far), contractions=own)


def shaft_torques(robot: Robot, tensions: Vector) -> Vector:
    """Torque on the shaft of each winch [N m] of the tensions of all cables [N], whichever way it turns."""
    return np.abs(spool_arms(robot) @ tensions)
