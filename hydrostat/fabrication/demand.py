"""`Demand`: what the poses of a robot ask of its motors and cables."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.ik import InverseOptions, solve_ik
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation, SolvedPose

_ONCE = InverseOptions(restarts=0)
"""Whether another beginning would reach a pose better by some micrometres does not matter to a motor."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Demand:
    """The largest loads in all poses that were solved.

    Attributes:
        poses: what was solved, in words.
        tensions: largest of each cable [N], in cable order.
        torques: largest on the shaft of each winch [N m], in winch order: sum of tension times radius of the spool.
        taken: least and most cable that each winch takes in [m], (winches, 2).
        missed: poses without an equilibrium, in words.
    """

    poses: tuple[str, ...]
    tensions: Vector
    torques: Vector
    taken: Float[np.ndarray, "winches 2"]
    missed: tuple[str, ...] = ()


def find_demand(robot: Robot, *, progress: Callable[[int, int], None] | None = None) -> Demand:
    """What the poses of a robot ask for, by inverse kinematics; without poses, each winch alone at its full travel.

    With friction of cables, for which there is no inverse kinematics, winches are pulled too.

    Args:
        robot: with its poses.
        progress: told how many poses are solved, of how many.
    """
    count = len(robot.winches)
    if not robot.cables:
        return Demand(poses=(), tensions=np.zeros(0), torques=np.zeros(count), taken=np.zeros((count, 2)))
    simulation = Simulation(robot)
    solved: dict[str, SolvedPose] = {}
    missed = []
    tasks = tuple(_tasks(simulation))
    for done, (name, solve) in enumerate(tasks):
        if progress is not None:
            progress(done, len(tasks))
        try:
            solved[name] = solve()
        except (InputError, NotConvergedError) as error:
            missed.append(f"{name}: {error}")
    poses = [simulation.rest, *solved.values()]
    tensions = np.array([pose.tensions for pose in poses])
    taken = np.array([pose.contractions for pose in poses])
    return Demand(
        poses=tuple(solved),
        tensions=tensions.max(axis=0),
        torques=np.max([_torques(robot, pose.tensions) for pose in poses], axis=0),
        taken=np.stack([taken.min(axis=0), taken.max(axis=0)], axis=1),
        missed=tuple(missed),
    )


def _tasks(simulation: Simulation) -> Iterable[tuple[str, Callable[[], SolvedPose]]]:
    robot = simulation.robot
    if robot.poses and not any(cable.friction for cable in robot.cables):
        for name, pose in robot.poses.items():
            yield f'pose "{name}"', lambda pose=pose: solve_ik(simulation, pose, options=_ONCE).pose
        return
    for winch in robot.winches:
        yield (
            f'winch "{winch.name}" at its full travel',
            lambda winch=winch: simulation.solve({winch.name: winch.travel}),
        )


def _torques(robot: Robot, tensions: Vector) -> Vector:
    """On the shaft of each winch [N m]."""
    radii = {winch.name: winch.spool_radius for winch in robot.winches}
    own = np.array([cable.spool_radius or radii[cable.winch] for cable in robot.cables])
    mine = np.array([[cable.winch == winch.name for cable in robot.cables] for winch in robot.winches], dtype=float)
    return mine @ (own * tensions)
