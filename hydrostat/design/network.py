"""`Network`: a designed robot with its scores and the trace of the search."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hydrostat.arrays import Int
from hydrostat.design.build_cost import BuildCost
from hydrostat.design.constraints import Constraints
from hydrostat.design.muscles.activation import Activation
from hydrostat.design.polyline import Route
from hydrostat.design.request import DesignRequest
from hydrostat.design.stuffed_results import StuffedResults
from hydrostat.errors import NotConvergedError
from hydrostat.ik import IKOptions, IKResult, solve_ik
from hydrostat.painters import draw_record, html_repr
from hydrostat.robot import ElementKind, Robot, Volume
from hydrostat.simulation import Simulation
from hydrostat.units import plural

_IDLE_RATIO, _SAME_ERROR = 1.1, 1e-3
"""A winch is idle if the error without it is at most this many times as large, or below this share of the body."""

_IDLE_NODES = 2000
"""Most nodes of a body whose idle winches are looked for: a flat one takes a second for each pose and winch."""


def rms_error(reached: Sequence[IKResult]) -> float:
    """Root of the mean squared marker error over poses [m]."""
    return float(np.sqrt(np.mean([pose.rms_error**2 for pose in reached])))


@dataclass(frozen=True, kw_only=True, eq=False)
class TreeTrace:
    """Trace of a search by winch trees."""

    activations: tuple[Activation, ...]  # one for each pose (Fig 3.9a)
    # for each pose, the fibres that passed the threshold, strongest first (Fig 3.9b)
    candidates: tuple[Int[np.ndarray, " candidates"], ...]
    trees: tuple[Route, ...]  # routes that were grown from them [m] (Fig 3.9c)
    score: float  # the thesis's score of the network, between 0 and 1 (R43)

    @property
    def certificate(self) -> None:
        """Trees have none; only routes do."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignStage:
    """A network on the way."""

    words: str  # what was done, such as "a cable added to winch_1"
    robot: Robot  # with the network as it was then
    error: float  # rms marker error over all poses: for routes that expected once built, for trees in the model [m]
    num_evaluated: int = 0  # number of networks with solved poses until then
    is_begun: bool = False  # True for a network that is no later stage of the one before


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """First-order optimality of a network: bounds on the gain of a small change, and of one more cable."""

    further: float  # rms error [m] that one more cable, with a winch of its own along the best path of all, promises
    paths: int  # states of the dynamic program that found it: each the best few paths of so many edges that end so
    # the steepest fall of the error along one number of the network, such as a coordinate of a via point, that the
    # limits allow to move [m/m]
    descent_rate: float


@dataclass(frozen=True, kw_only=True, eq=False)
class RouteTrace:
    """Trace of a search by priced routes."""

    stages: tuple[DesignStage, ...]  # networks on the way, in order
    # of the one that was returned; None where the work was interrupted, or another did better on the filled body
    certificate: Certificate | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Alternative:
    """Another network that was found, with other routes or other counts."""

    robot: Robot  # with that network
    ik_results: tuple[IKResult, ...]  # what it reaches of each pose
    expected_error: float  # rms error expected of a robot as it is built, its commands played open loop [m]

    @cached_property
    def cost(self) -> BuildCost:
        """Work and money that its robot takes."""
        return BuildCost.of_robot(self.robot, self.ik_results)

    @property
    def rms_error(self) -> float:
        """Root of the mean squared marker error over all poses [m]."""
        return rms_error(self.ik_results)


@dataclass(frozen=True, kw_only=True, eq=False)
class Network:
    """Designed winches and cables, with the record of the search.

    Attributes:
        robot: robot with the new network.
        source: robot that was given to the design.
        request: design request, with the constraints that the network keeps.
        ik_results: inverse-kinematics result of the new network for each pose, by its own winches; the true score.
        expected_error: rms error over markers and poses expected of a robot as it is built, its commands played open
            loop [m]: `hydrostat.design.expected_error` with the uncertainty of the request.
        alternatives: other networks, best first; by counts if the search chose the number of winches.
        trace: trace of the search.
        num_evaluated: number of networks with solved poses.
        seconds: CPU time of the design [s].
        complete: True if the search finished; False if it was interrupted or its time was up.
        timed_out: True if its time was up.
        stuffed: results on the stuffed body; None if not requested.
    """

    robot: Robot
    source: Robot
    request: DesignRequest
    ik_results: tuple[IKResult, ...]
    expected_error: float
    alternatives: tuple[Alternative, ...] = ()
    trace: TreeTrace | RouteTrace
    num_evaluated: int
    seconds: float
    complete: bool = True
    timed_out: bool = False
    stuffed: StuffedResults | None = None

    def __repr__(self) -> str:
        """Return a description of one line."""
        built = f"{1e3 * self.rms_error:.3g} mm in the model, {1e3 * self.expected_error:.3g} mm expected once built"
        return f"<Network for {plural(len(self.ik_results), 'pose')}, rms error {built}: {self.robot!r}>"

    def _repr_html_(self) -> str:
        """Summary and a picture, for a notebook."""
        return html_repr(repr(self), draw_record("network", self.robot))

    @cached_property
    def idle_winches(self) -> dict[str, float]:
        """Rms error without each winch that hardly lowers it [m]; poses are solved again without its cables.

        Without two of them the error may be larger. Empty for robots with drives, and for bodies in space (too slow).
        """
        robot, found, once = self.robot, dict[str, float](), IKOptions(restarts=0)
        mesh = robot.body.mesh
        if len(robot.winches) < 2 or robot.drives or mesh.dim == 3 or len(mesh.nodes) > _IDLE_NODES:
            return {}
        most = max(_IDLE_RATIO * self.rms_error, _SAME_ERROR * mesh.size)
        for winch in robot.winches:
            cables = [cable for cable in robot.cables if cable.winch != winch.name]
            simulation = Simulation(robot.with_network([one for one in robot.winches if one is not winch], cables))
            with suppress(NotConvergedError):
                without = rms_error([solve_ik(simulation, each.target, options=once) for each in self.ik_results])
                if without < most:
                    found[winch.name] = without
        return found

    @cached_property
    def cost(self) -> BuildCost:
        """Work and cost of building the robot."""
        return BuildCost.of_robot(self.robot, self.ik_results)

    @property
    def constraints(self) -> Constraints:
        """Constraints of the network."""
        return self.request.constraints

    @property
    def rms_error(self) -> float:
        """Root of the mean squared marker error over all poses [m]."""
        return rms_error(self.ik_results)

    def best_errors(self, alternatives: Iterable[Alternative]) -> "dict[Size, float]":
        """Return the least as-built error of each size [m], in order of size; at the chosen size, that network's."""
        found: dict[Size, float] = {}
        for network in alternatives:
            found[size_of(network)] = min(network.expected_error, found.get(size_of(network), float("inf")))
        found[size_of(self)] = self.expected_error
        return dict(sorted(found.items()))

    @property
    def element_error(self) -> float:
        """Rms difference of the markers on quadratic elements at the same contractions [m]; infinite if unknown.

        Unknown for bodies in space, bodies with quadratic elements, and bodies whose volume is kept by patches.
        """
        body = self.robot.body
        if body.mesh.dim == 3 or body.elements is not ElementKind.LINEAR or body.volume is not Volume.ELEMENT:
            return float("inf")
        finer = Simulation(replace(self.robot, body=body.with_elements(ElementKind.QUADRATIC)))
        squares = []
        for one in self.ik_results:
            pose = finer.solve(one.pose.contractions, strict=False)
            moved = [pose.markers[name] - one.pose.markers[name] for name in one.pose_target.targets]
            squares.append(np.mean(np.sum(np.square(moved), axis=1)) if pose.result.converged else np.inf)
        return float(np.sqrt(np.mean(squares)))

    @property
    def rest_error(self) -> float:
        """Root of the mean squared marker error over all poses if nothing moved [m]."""
        places = {marker.name: marker.at for marker in self.robot.markers}
        return float(np.sqrt(np.mean([pose.pose_target.mean_square_error(places) for pose in self.ik_results])))


Size = tuple[int, int]  # numbers of winches and of cables


def size_of(network: Alternative | Network) -> Size:
    """Numbers of winches and cables of a network."""
    return len(network.robot.winches), len(network.robot.cables)


def on_front(size: Size, errors: Mapping[Size, float]) -> bool:
    """True if no network of as few winches and as few cables has an error as small."""
    winches, cables = size
    others = [error for other, error in errors.items() if other != size and other[0] <= winches and other[1] <= cables]
    return all(error > errors[size] for error in others)


StageCallback = Callable[[DesignStage], None]  # called with each better network


def ignore_stage(stage: DesignStage) -> None:
    """Nobody watches."""


class Better:
    """Passes on what has a smaller error than all before."""

    def __init__(self, watch: StageCallback) -> None:
        self._watch, self._least = watch, float("inf")

    def __call__(self, stage: DesignStage) -> None:
        """Hear of a network."""
        if stage.error < self._least:
            self._least = stage.error
            self._watch(stage)
