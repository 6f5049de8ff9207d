"""`solve_poses`: all poses of a robot by its own winches."""

from dataclasses import dataclass

from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import ReachedPose, solve_ik
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.jobs import Report


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedPoses:
    """What the winches make of the poses.

    Attributes:
        robot: whose they are.
        reached: those that were solved, in their order.
        missed: a line for each that was not.
    """

    robot: Robot
    reached: tuple[ReachedPose, ...]
    missed: tuple[str, ...]


def solve_poses(report: Report, robot: Robot) -> SolvedPoses:
    """Solve all poses by inverse kinematics; none of a robot without cables."""
    simulation = Simulation(robot)
    reached, missed = [], []
    poses = list(robot.poses.values()) if robot.cables else []
    for done, pose in enumerate(poses):
        report.progress(f"Pose {pose.name}", done, len(poses))
        try:
            reached.append(solve_ik(simulation, pose))
        except (InputError, NotConvergedError) as error:
            missed.append(f"{pose.name}: {error}")
    return SolvedPoses(robot=robot, reached=tuple(reached), missed=tuple(missed))
