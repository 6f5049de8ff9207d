"""`propose_routes`, `QuickSearch`: networks for the pose of a moment, by the quick part of the search for routes."""

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hydrostat.design.buildable import violations
from hydrostat.design.cable_sides import assign_cable_sides
from hydrostat.design.region import Region
from hydrostat.design.request import DesignRequest
from hydrostat.design.routes.evaluator import Evaluator, Trial
from hydrostat.design.routes.finalists import Finalists, kit_fits
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.line_choice import Line
from hydrostat.design.routes.propose import Proposals
from hydrostat.design.routes.route_graph import RouteGraph
from hydrostat.design.routes.search_rules import RULES
from hydrostat.design.routes.sketch import draw_lines, sketches
from hydrostat.design.skin_region import cable_region
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.design.winch_room import built_in, limit_torque
from hydrostat.ik import IKResult
from hydrostat.robot import Marker, PoseTarget, Robot
from hydrostat.simulation import BodyPhysics


@dataclass(frozen=True, kw_only=True, eq=False)
class RouteProposal:
    """Network for the pose of a moment."""

    robot: Robot  # with the network
    error: float  # rms marker error over all poses in the model [m]
    expected_error: float  # rms error expected of a robot as it is built [m]
    is_refined: bool  # False for a first sketch, True for the last proposal of a search
    is_buildable: bool  # True if a kit would be made of it; not checked for a first sketch
    ik_results: tuple[IKResult, ...] = ()  # its results for the poses, of the last proposal


def propose_routes(robot: Robot, request: DesignRequest, *, body: BodyPhysics | None = None) -> Iterator[RouteProposal]:
    """Propose a sketched network, then a refined one; nothing where no sketch can be built.

    It does a fixed amount of work, so the same request gives the same networks on any machine: sketches, a choice of
    lines by the linear model, and a few of them refined. Nothing is grown or exchanged. `body` is the physics of the
    body, if it is made already. Parts that stay and a mirror yield nothing: use `find_network`.

    Raises InputError: a request that does not fit the robot, or a body too thin for the constraints.
    """
    return QuickSearch(robot, request, body).propose(request.poses)


class QuickSearch:
    """The quick part of the search for routes on one body, with all that does not depend on the poses.

    Poses may change from call to call, winches, cables and constraints may not. Lines to a marker are drawn once.
    """

    def __init__(self, robot: Robot, request: DesignRequest, body: BodyPhysics | None = None) -> None:
        """Prepare a body (InputError: the request does not fit it, or it is too thin for the constraints)."""
        self.robot = replace(assign_cable_sides(robot), motor=request.motor_for(robot))
        self.request = request.fit_robot(self.robot)
        self.body = body or BodyPhysics(self.robot)
        self.winches, self.cables = int(request.winches), request.cables
        own = limit_torque(self.request.constraints)
        inside = own.built_in and not own.stand_outside(self.robot)
        self.constraints = built_in(self.robot, own, winches=self.winches, cables=self.cables) if inside else own
        self._lines: dict[tuple[float, ...], list[Line]] = {}

    def with_markers(self, markers: tuple[Marker, ...]) -> "QuickSearch":
        """Return the same search for a robot with other markers; what is made already is shared."""
        other = copy(self)
        other.robot = replace(self.robot, markers=markers)
        return other

    def prepare(self) -> None:
        """Draw the lines to all markers, which need no pose."""
        self._draw_lines(self._proposals(Evaluator(self.robot, (), self.constraints)))

    def propose(self, poses: Sequence[PoseTarget]) -> Iterator[RouteProposal]:
        """Propose a sketched network for some poses, then a refined one."""
        if self.constraints.mirror is not None or any(self.constraints.staying(self.robot)):
            return
        uncertainty = self.request.uncertainty or BuildTolerances.none()
        evaluator = Evaluator(self.robot, tuple(poses), self.constraints, uncertainty, self.body)
        proposals = self._proposals(evaluator)
        growth = Growth(proposals, lambda *_: None)
        finalists = Finalists(
            self.robot, replace(self.request, poses=tuple(poses)), self.constraints, evaluator, self.region
        )
        bare = growth.evaluate(Layout(self.robot, self.constraints, (), ()))
        if bare is None:
            return
        lines = self._draw_lines(proposals)
        count = self._count(len(poses))
        drawn = sketches(proposals, bare, winches=self.winches, cables=self.cables, count=count, lines=lines)
        first = _solve(evaluator, drawn[: RULES.quick_first])
        refined = [growth.refine_briefly(trial, directions=0) for trial in first[:1]]
        for trial in (*refined, *first):
            sketch = self._propose_trial(finalists, trial)
            if sketch is not None:
                yield sketch
                break
        others = sorted([*first[1:], *_solve(evaluator, drawn[RULES.quick_first :])], key=_cost)
        refined += [growth.refine_briefly(trial, directions=0) for trial in others[: count - 1]]
        last = self._judge_best(growth, finalists, sorted(refined, key=_cost)[: RULES.quick_last])
        if last is not None:
            yield last

    @cached_property
    def region(self) -> Region:
        """Region that cables may use."""
        return cable_region(self.robot.body, self.constraints)

    @cached_property
    def graph(self) -> RouteGraph:
        """Via points and the runs between them."""
        spacing = float(self.robot.body.mesh.edge_lengths.mean())
        return RouteGraph.build(self.robot, self.region, self.constraints, spacing=spacing)

    def _proposals(self, evaluator: Evaluator) -> Proposals:
        options, spacing = self.request.route_options, float(self.robot.body.mesh.edge_lengths.mean())
        return Proposals(evaluator, self.graph, options, options.spacing * spacing)

    def _draw_lines(self, proposals: Proposals) -> list[Line]:
        """Lines to all markers, also to those that should stay where they are; to each they are drawn once."""
        for marker in self.robot.markers:
            if marker.at not in self._lines:
                self._lines[marker.at] = list(draw_lines(proposals, [marker.at]))
        return [line for marker in self.robot.markers for line in self._lines[marker.at]]

    def _count(self, poses: int) -> int:
        """Number of sketches to refine: fewer on bodies that take longer."""
        return int(np.clip(RULES.quick_work // (self.robot.body.mesh.nodes.size * poses), *RULES.quick_sketches))

    def _propose_trial(self, finalists: Finalists, trial: Trial) -> RouteProposal | None:
        """A first network, with poses as they were solved; None if it breaks a constraint."""
        robot = finalists.safe_robot(trial.layout)
        travels = np.array([winch.travel for winch in robot.winches])
        beyond = any((pose.contractions > travels + RULES.travel_precision).any() for pose in trial.poses)
        if beyond or violations(robot, self.constraints, self.region):
            return None
        return RouteProposal(
            robot=robot, error=trial.error, expected_error=trial.built_error, is_refined=False, is_buildable=False
        )

    def _judge_best(self, growth: Growth, finalists: Finalists, trials: Sequence[Trial]) -> RouteProposal | None:
        """The best network after some steps with the build tolerances, judged as its user will find it."""
        best: RouteProposal | None = None
        for trial in sorted(map(growth.refine_briefly, trials), key=_cost):
            network = finalists.judge(trial.layout)
            if network is None:
                continue
            fits = kit_fits(network)
            if best is None or fits:
                best = RouteProposal(
                    robot=network.robot, error=network.rms_error, expected_error=network.expected_error,
                    is_refined=True, is_buildable=fits, ik_results=network.ik_results,
                )  # fmt: skip
            if fits:
                break
        return best


def _solve(evaluator: Evaluator, layouts: Sequence[Layout]) -> list[Trial]:
    """Networks with their poses roughly solved, the best first."""
    found = [evaluator.reach_poses(layout, None, iterations=RULES.quick_ik_steps) for layout in layouts]
    return sorted((trial for trial in found if trial is not None), key=_cost)


def _cost(trial: Trial) -> float:
    return trial.cost
