"""`design_work`: a design in a process of its own, and the networks that it finds."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.design import (
    Alternative,
    BuildCost,
    DesignRequest,
    DesignStage,
    Network,
    assign_cable_sides,
    find_network,
    rms_error,
)
from hydrostat.fabrication import Demand
from hydrostat.ik import IKResult
from hydrostat.robot import Cable, PoseTarget, Robot, Winch
from hydrostat.studio.jobs import Report
from hydrostat.units import plural


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseResult:
    """Result of a network in one pose."""

    pose: PoseTarget  # that was wanted
    nodes: Nodes  # where they come to [m]
    contractions: Vector  # of the winches [m]
    tensions: Vector  # of the cables [N]
    places: dict[str, tuple[float, ...]]  # where the markers of the pose come to, by name [m]
    errors: dict[str, float]  # distance of each from its target [m]
    error: float  # root of their mean square [m]


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """A network as the process that found it sends it: without the body, which is known."""

    winches: tuple[Winch, ...]  # of the network
    cables: tuple[Cable, ...]  # of the network
    reaches: tuple[PoseResult, ...]  # what it reaches of each pose
    error: float  # root of the mean squared marker error over all poses [m]
    expected_error: float  # the same, expected of a robot as it is built [m]
    craft: BuildCost  # what it takes to sew and to motorise it
    demand: Demand  # what its poses ask of motors and cables
    torque: float | None = None  # torque limit of the design, which its kit keeps to [N m]; None: none


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidate:
    """A network to choose."""

    number: int  # by which it is named; no two have the same
    source: Robot  # the robot that it was designed for
    robot: Robot  # that one with the network
    reaches: tuple[PoseResult, ...]  # what it reaches of each pose
    error: float  # root of the mean squared marker error over all poses [m]
    expected_error: float  # the same, expected of a robot as it is built [m]
    craft: BuildCost  # what it takes to sew and to motorise it
    demand: Demand  # what its poses ask of motors and cables
    complete: bool  # whether the search came to its end
    torque: float | None = None  # torque limit of the design, which its kit keeps to [N m]; None: none

    @property
    def counts(self) -> str:
        """Such as "2 winches, 6 cables"."""
        return network_words(self.robot)

    @property
    def length(self) -> float:
        """Length of all cables together [m]."""
        return sum(cable.length for cable in self.robot.cables)

    @property
    def tension(self) -> float:
        """The largest in any pose [N]."""
        return max((float(reach.tensions.max(initial=0.0)) for reach in self.reaches), default=0.0)

    def reach(self, pose: str) -> PoseResult | None:
        """Return the result in a pose; None if the network was not designed for it."""
        return next((reach for reach in self.reaches if reach.pose.name == pose), None)


def make_candidate(solution: Solution, source: Robot, *, number: int, complete: bool) -> Candidate:
    """Return a network that a design process has sent as a candidate for the robot that it was designed for."""
    return Candidate(
        number=number,
        source=source,
        robot=assign_cable_sides(source).with_network(solution.winches, solution.cables),
        reaches=solution.reaches,
        error=solution.error,
        expected_error=solution.expected_error,
        craft=solution.craft,
        demand=solution.demand,
        complete=complete,
        torque=solution.torque,
    )


def network_words(robot: Robot) -> str:
    """Numbers of winches and cables of a robot, in words."""
    return f"{plural(len(robot.winches), 'winch')}, {plural(len(robot.cables), 'cable')}"


def solution(found: Network | Alternative, torque: float | None) -> Solution:
    """Return the solution record that a design process sends to the studio, with the torque limit of the design."""
    return Solution(
        winches=found.robot.winches,
        cables=found.robot.cables,
        reaches=tuple(map(_reach, found.ik_results)),
        error=rms_error(found.ik_results),
        expected_error=found.expected_error,
        craft=found.cost,
        demand=Demand.of_results(found.robot, found.ik_results),
        torque=torque,
    )


def _reach(reached: IKResult) -> PoseResult:
    pose, solved = reached.pose_target, reached.pose
    places = {name: tuple(np.asarray(solved.markers[name]).tolist()) for name in pose.targets}
    return PoseResult(
        pose=pose,
        nodes=solved.nodes,
        contractions=solved.contractions,
        tensions=solved.tensions,
        places=places,
        errors=dict(reached.errors),
        error=reached.rms_error,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class BestSoFar:
    """The best network so far."""

    winches: tuple[Winch, ...]  # of it
    cables: tuple[Cable, ...]  # of it
    error: float  # rms marker error over all poses: for routes that expected once built, for trees in the model [m]
    words: str  # what was done last, such as "a cable exchanged"
    num_evaluated: int  # number of networks with solved poses until then


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignsFound:
    """Results of a search."""

    solutions: tuple[Solution, ...]  # the network that it returns, then its alternatives, each once
    num_evaluated: int  # networks whose poses were solved
    complete: bool  # whether it came to its end


def design_work(report: Report, robot: Robot, request: DesignRequest) -> DesignsFound:
    """Search, tell of each better network, and return what there is; interrupted, the best so far."""

    def watch(stage: DesignStage) -> None:
        found, error = stage.robot, stage.error
        best = BestSoFar(
            winches=found.winches,
            cables=found.cables,
            error=error,
            words=stage.words,
            num_evaluated=stage.num_evaluated,
        )
        report.part(best)

    network = find_network(robot, request, progress=report.progress, watch=watch)
    report.finish()
    solutions = _each_once([network, *network.alternatives], network.constraints.torque)
    return DesignsFound(solutions=solutions, num_evaluated=network.num_evaluated, complete=network.complete)


def _each_once(networks: Iterable[Network | Alternative], torque: float | None) -> tuple[Solution, ...]:
    """Networks, but those that are no simpler than a better one before: in winches, cables and holes."""
    kept: list[Network | Alternative] = []
    for found in networks:
        better = (other for other in kept if other.expected_error <= found.expected_error)
        if not any(all(np.less_equal(_parts(other), _parts(found))) for other in better):
            kept.append(found)
    return tuple(solution(found, torque) for found in kept)


def _parts(found: Network | Alternative) -> tuple[int, int, int]:
    """Numbers of winches, cables and points of cables."""
    robot = found.robot
    return len(robot.winches), len(robot.cables), sum(len(cable.points) for cable in robot.cables)
