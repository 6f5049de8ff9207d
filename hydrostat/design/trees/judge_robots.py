"""`judge`, `prune`: the best of several robots by the pose error, and it without idle cables."""

from collections.abc import Sequence

from hydrostat.design.network import Better, DesignStage, StageCallback, ignore_stage, rms_error
from hydrostat.ik import IKOptions, IKResult, solve_ik
from hydrostat.progress import Progress
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import BodyPhysics, Simulation

_ROUNDS = tuple(IKOptions(iterations=steps, restarts=0, min_tension=False) for steps in (3, 4, 100))
"""Enough steps to see which robots are hopeless, more for those that are not, all for the best."""

_SELECTION_RATIO = 4  # one robot in four goes on to the next round
_MIN_ROBOTS = 4  # robots that go on, at least


def judge(
    robots: Sequence[Robot],
    poses: Sequence[PoseTarget],
    *,
    tension: float,
    progress: Progress,
    watch: StageCallback = ignore_stage,
    body: BodyPhysics | None = None,
) -> tuple[int, tuple[IKResult, ...]]:
    """The index of the robot of least cost, and what it reaches of each pose.

    In rounds of inverse kinematics, each of which takes up where the last one ended, for ever fewer robots. Cables
    should bear at most the tension [N], see `cost`; `watch` is told each robot that is better than all before and keeps
    to it.
    """
    simulations = [Simulation(robot, body=body) for robot in robots]
    reached: dict[int, tuple[IKResult, ...]] = {}
    chosen = list(range(len(robots)))
    better = Better(watch)
    for number, options in enumerate(_ROUNDS):
        for done, index in enumerate(chosen):
            if number == 0:
                progress("Judging networks", done, len(robots))
            starts = [pose.pose for pose in reached[index]] if index in reached else [None] * len(poses)
            pairs = zip(poses, starts, strict=True)
            reached[index] = tuple(
                solve_ik(simulations[index], pose, start=start, options=options) for pose, start in pairs
            )
            error = rms_error(reached[index])
            if cost(reached[index], tension) <= error:
                better(DesignStage(words="a network judged", robot=robots[index], error=error))
        chosen.sort(key=lambda index: cost(reached[index], tension))
        if number < len(_ROUNDS) - 1:
            chosen = chosen[: max(_MIN_ROBOTS, len(chosen) // _SELECTION_RATIO)]
    progress("Judging networks", len(robots), len(robots))
    return chosen[0], reached[chosen[0]]


def cost(reached: Sequence[IKResult], tension: float) -> float:
    """Pose error [m], times how often the largest tension exceeds `tension` [N] if it does."""
    largest = max(float(pose.pose.tensions.max(initial=0.0)) for pose in reached)
    return rms_error(reached) * max(largest / tension, 1.0)


def prune(
    robot: Robot,
    poses: Sequence[PoseTarget],
    reached: tuple[IKResult, ...],
    *,
    tension: float,
    loss: float,
    body: BodyPhysics | None = None,
) -> tuple[Robot, tuple[IKResult, ...]]:
    """Leave out cables, the shortest first, while the cost stays within 1 + `loss` of what it was.

    All omissions together may add that share. Every winch keeps a cable. Cables should bear at most the tension [N].
    """
    allowed = (1.0 + loss) * cost(reached, tension)
    for cable in sorted(robot.cables, key=lambda cable: float(cable.segments[cable.bare].sum())):
        others = [other for other in robot.cables if other is not cable]
        if not any(other.winch == cable.winch for other in others):
            continue
        trial = robot.with_network(robot.winches, others)
        simulation = Simulation(trial, body=body)
        found = tuple(solve_ik(simulation, pose, options=_OPTIONS) for pose in poses)
        if cost(found, tension) <= allowed:
            robot, reached = trial, found
    return robot, reached


_OPTIONS = IKOptions(restarts=0, min_tension=False)  # one descent tells enough
