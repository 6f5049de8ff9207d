"""`prune`: a network without the cables that do not earn their place (R44)."""

from collections.abc import Sequence

from hydrostat.design.trees.judge import cost
from hydrostat.ik import InverseOptions, ReachedPose, solve_ik
from hydrostat.robot import Pose, Robot
from hydrostat.simulation import Simulation


def prune(
    robot: Robot, poses: Sequence[Pose], reached: tuple[ReachedPose, ...], *, tension: float, loss: float
) -> tuple[Robot, tuple[ReachedPose, ...]]:
    """Leave out cables, the shortest first, while the cost stays within 1 + `loss` of what it was.

    Every winch keeps a cable.

    Args:
        robot: with its network.
        poses: what it should reach.
        reached: what it reaches of them.
        tension: what a cable should bear at most [N].
        loss: how much of the cost all omissions together may add, as a fraction.
    """
    allowed = (1.0 + loss) * cost(reached, tension)
    for cable in sorted(robot.cables, key=lambda cable: float(cable.segments[cable.bare].sum())):
        others = [other for other in robot.cables if other is not cable]
        if not any(other.winch == cable.winch for other in others):
            continue
        trial = robot.with_network(robot.winches, others)
        simulation = Simulation(trial)
        found = tuple(solve_ik(simulation, pose, options=_OPTIONS) for pose in poses)
        if cost(found, tension) <= allowed:
            robot, reached = trial, found
    return robot, reached


_OPTIONS = InverseOptions(restarts=0, unique=False)
"""One descent tells enough."""
