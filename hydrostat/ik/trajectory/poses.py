"""`follow`: the poses that a robot takes one after another, on one branch as long as there is one."""

from dataclasses import dataclass

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import NotConvergedError
from hydrostat.ik.trajectory.timed_path import Samples
from hydrostat.progress import Progress
from hydrostat.simulation import Equilibrium, Simulation, largest_distance


@dataclass(frozen=True, kw_only=True)
class BranchJump:
    """Jump of a robot from one branch of equilibria to another (snap-through)."""

    time: float  # time of the jump [s]
    distance: float  # distance of a node from its position on the continued branch [m]


def follow(
    simulation: Simulation,
    start: Equilibrium,
    times: Vector,
    contractions: Samples,
    *,
    jump: float,
    progress: Progress | None = None,
) -> tuple[tuple[Equilibrium, ...], tuple[BranchJump, ...]]:
    """Equilibria at contractions [m] in time [s], each continued from the one before, and where they snap (E20).

    A step is taken when the nodes come to rest where the predictor x + dx/da da has put them, within `jump` [m]; else
    it is halved. On a branch the distance falls with the square of the step, where a cable becomes taut with the step
    itself; at a snap it stays, however small the step is. Only the last pose keeps its factorized Hessian.

    Raises:
        NotConvergedError: no equilibrium is found at some time.
    """
    poses: list[Equilibrium] = []
    snaps: list[BranchJump] = []
    pose = start
    halvings = 10  # a snap is one that is still there when a step is 2 to the power of so many times smaller
    for index, (time, goal) in enumerate(zip(times, contractions, strict=True)):
        pose, distance = _go(simulation, pose, goal, jump, halvings)
        if not pose.result.converged:
            raise NotConvergedError(
                f"no equilibrium found at {time:.3g} s of the trajectory: {pose.result.status}", pose.result
            )
        if distance > jump:
            snaps.append(BranchJump(time=float(time), distance=distance))
        poses.append(pose.without_factors())
        if progress is not None:
            progress("following the path", index + 1, len(times))
    return (*poses[:-1], pose), tuple(snaps)


def _go(
    simulation: Simulation, pose: Equilibrium, goal: Vector, jump: float, halvings: int
) -> tuple[Equilibrium, float]:
    """Pose at other contractions, and the largest distance from a prediction on the path [m].

    It is 0 where every step was taken; else it is a snap if it is more than `jump`.
    """
    if (pose.controls == goal).all():
        return pose, 0.0
    predicted = _predict_nodes(simulation, pose, goal)
    iterations = 20  # steps of Newton; near a branch a few are enough
    if simulation.assembly.has_history:
        found = simulation.solve(goal, start=pose, strict=False)
    else:
        result = simulation.solver.relax(pose.nodes, goal, simulation.stiffness(pose), iterations=iterations)
        found = simulation.make_pose(goal, result)
    distance = largest_distance(found.nodes, predicted)
    if found.result.converged and found.result.stable and distance <= jump:
        return found, 0.0
    if halvings:
        middle, first = _go(simulation, pose, 0.5 * (pose.controls + goal), jump, halvings - 1)
        if not middle.result.converged:
            return middle, first
        end, second = _go(simulation, middle, goal, jump, halvings - 1)
        return end, max(first, second)
    found = simulation.solve(goal, start=pose, strict=False)
    return found, largest_distance(found.nodes, predicted)


def _predict_nodes(simulation: Simulation, pose: Equilibrium, goal: Vector) -> Nodes:
    """Node positions predicted to first order."""
    try:
        return pose.nodes + simulation.jacobian(pose) @ (goal - pose.controls)
    except NotConvergedError:
        return pose.nodes
