"""`design_work`: a design in a process of its own."""

from collections.abc import Iterable
from dataclasses import dataclass

from hydrostat.design import Stage, design_cables
from hydrostat.ik import ReachedPose
from hydrostat.robot import Cable, Robot, Winch
from hydrostat.studio.designing.asked import Asked
from hydrostat.studio.designing.candidate import Solution, solution
from hydrostat.studio.jobs import Report


@dataclass(frozen=True, kw_only=True, eq=False)
class Glimpse:
    """The best network so far.

    Attributes:
        winches: of it.
        cables: of it.
        error: root of the mean squared marker error over all poses [m].
        words: what was done last.
    """

    winches: tuple[Winch, ...]
    cables: tuple[Cable, ...]
    error: float
    words: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """What a search has found.

    Attributes:
        solutions: the network that it returns, then its alternatives, each once.
        tried: networks whose poses were solved.
        complete: whether it came to its end.
    """

    solutions: tuple[Solution, ...]
    tried: int
    complete: bool


def design_work(report: Report, asked: Asked) -> Found:
    """Search, tell of each better network, and return what there is; interrupted, the best so far."""

    def watch(stage: Stage) -> None:
        robot = stage.robot
        report.part(Glimpse(winches=robot.winches, cables=robot.cables, error=stage.error, words=stage.words))

    network = design_cables(
        asked.robot,
        asked.poses,
        winches=asked.winches,
        cables=asked.cables,
        constraints=asked.constraints,
        options=asked.options,
        improve=asked.improve,
        progress=report.progress,
        watch=watch,
    )
    report.finish()
    others = [(other.robot, other.reached) for other in network.alternatives]
    solutions = _each_once([(network.robot, network.reached), *others])
    return Found(solutions=solutions, tried=network.tried, complete=network.complete)


def _each_once(networks: Iterable[tuple[Robot, tuple[ReachedPose, ...]]]) -> tuple[Solution, ...]:
    """Networks without those that have the same winches and cables as one before."""
    kept: list[Solution] = []
    for robot, reached in networks:
        if not any((robot.winches, robot.cables) == (other.winches, other.cables) for other in kept):
            kept.append(solution(robot, reached))
    return tuple(kept)
