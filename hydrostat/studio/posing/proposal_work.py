"""`Proposer`, `propose_work`: networks for the pose that is held just now, in a process of its own (X1)."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from hydrostat.arrays import Nodes, Vector
from hydrostat.design import (
    Activation,
    BuildTolerances,
    DesignMethod,
    DesignRequest,
    QuickSearch,
    TreeOptions,
    assign_cable_sides,
    edge_fibres,
    expected_error,
    propose_trees,
)
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKOptions, solve_ik
from hydrostat.project import Wishes
from hydrostat.robot import Cable, Marker, PoseTarget, Robot, Winch, limit_travels
from hydrostat.simulation import BodyPhysics, Simulation
from hydrostat.studio.posing.pose_state import Anchored, HeldPoint, with_pose

POSE = "held"  # name of the pose that is held, in that process alone
STEPS = 12  # of inverse kinematics: enough to evaluate winch trees
OPTIONS = IKOptions(iterations=STEPS, restarts=0, min_tension=False)


@dataclass(frozen=True, kw_only=True, eq=False)
class MusclePulls:
    """Muscles that hold a body."""

    nodes: Nodes  # where the body is [m]
    tensions: Vector  # of the muscle on each edge of its mesh [N]


@dataclass(frozen=True, kw_only=True, eq=False)
class ProposalInput:
    """Pose that is held, and the network that is wanted for it."""

    held: Mapping[str, HeldPoint]  # points by name, with where they should be
    wishes: Wishes  # for a design: counts, limits, knobs
    markers: tuple[Marker, ...] = ()  # of the robot as it is now
    poses: tuple[PoseTarget, ...] = ()  # stored poses that the network should reach, too
    muscles: MusclePulls | None = None  # None where cables move the body; winch trees need them

    def asks_same(self, other: "ProposalInput") -> bool:
        """True if both want the same network by routes."""
        mine, theirs = ((one.held, one.wishes, one.markers, one.poses) for one in (self, other))
        return mine == theirs


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Result of one proposal input: a network, or why there is none."""

    winches: tuple[Winch, ...] = ()  # of the network
    cables: tuple[Cable, ...] = ()  # of the network
    expected_error: float | None = None  # rms error of all poses expected once built [m]; None: not known
    method: DesignMethod = DesignMethod.ROUTES  # search that found it
    poses: int = 1  # number of poses that it was found for
    is_last: bool = True  # False where a better one follows
    is_buildable: bool = True  # False if a kit would be refused
    words: str = ""  # why there is no network, or why it is by another search; "" for nothing to tell


class Proposer:
    """Proposes networks for one body; what does not depend on the pose is made once."""

    def __init__(self, robot: Robot, body: BodyPhysics | None = None) -> None:
        """Prepare for a robot; `body` is the physics of its body, if it is made already."""
        self.robot = assign_cable_sides(robot)
        self.body = body or BodyPhysics(self.robot)
        self._search: tuple[object, QuickSearch] | None = None

    def propose(self, moment: ProposalInput) -> Iterator[Proposal]:
        """Propose a network by routes, then a better one; winch trees where no route helps, or where they are asked.

        Where nothing is held it prepares for the body and its markers, and proposes nothing.

        Raises HydrostatError: wishes that do not fit the robot.
        """
        given = replace(self.robot, markers=moment.markers or self.robot.markers, poses={})
        if not moment.held:
            self._prepare(given, moment.wishes)
            return
        held = with_pose(given, POSE, moment.held)
        targets = held.pose(POSE).targets
        others = {pose.name: pose for pose in moment.poses if pose.targets != targets and pose.name != POSE}
        posed = replace(held, poses={**others, **held.poses})
        if moment.wishes.method.grows_trees:
            yield self._propose_trees(posed, moment, "")
            return
        found = False
        for proposal in self._propose_routes(posed, moment.wishes):
            yield proposal
            found = found or proposal.is_last
        if not found:
            yield self._propose_trees(posed, moment, "by winch trees: no sketched route can be built here")

    def _propose_routes(self, posed: Robot, wishes: Wishes) -> Iterator[Proposal]:
        request = request_routes(posed, wishes)
        for found in self._search_of(posed, request).propose(request.poses):
            yield Proposal(
                winches=found.robot.winches,
                cables=found.robot.cables,
                expected_error=found.expected_error,
                poses=len(request.poses),
                is_last=found.is_refined,
                is_buildable=found.is_buildable or not found.is_refined,
            )

    def _prepare(self, robot: Robot, wishes: Wishes) -> None:
        """Draw lines to the markers, so that the first drag is answered sooner."""
        if robot.markers and not wishes.method.grows_trees:
            stay = PoseTarget(name=POSE, targets={marker.name: marker.at for marker in robot.markers})
            self._search_of(robot, request_routes(replace(robot, poses={POSE: stay}), wishes)).prepare()

    def _search_of(self, robot: Robot, request: DesignRequest) -> QuickSearch:
        """The search for a request, made once for all poses and markers."""
        key = request.winches, request.cables, request.constraints, request.options
        if self._search is None or self._search[0] != key:
            self._search = key, QuickSearch(robot, request, self.body)
        return self._search[1].with_markers(robot.markers)

    def _propose_trees(self, posed: Robot, moment: ProposalInput, words: str) -> Proposal:
        """The thesis's network for the muscles of the held pose, or why there is none."""
        if moment.muscles is None:
            return Proposal(words="no cables found for this pose. Bend the body more, or ask for fewer in Design")
        nodes, mesh = moment.muscles.nodes, posed.body.mesh
        activation = Activation(
            target=posed.pose(POSE),
            fibres=edge_fibres(mesh),
            tensions=moment.muscles.tensions,
            nodes=nodes,
            errors=Anchored(mesh).errors(moment.held, nodes),
        )
        request = request_trees(posed, moment.wishes)
        try:
            found = propose_trees(posed, request, [activation], body=self.body)
        except HydrostatError as refused:  # the knobs as wished give none that can be built
            words = words or f"found with other settings than yours. With yours: {refused}"
            usual = replace(TreeOptions(), phis=request.tree_options.phis)
            try:
                found = propose_trees(posed, replace(request, options=usual), [activation], body=self.body)
            except HydrostatError as none:
                return Proposal(words=str(none), method=DesignMethod.TREES)
        found = limit_travels(found)
        simulation = Simulation(found, body=self.body)
        reached = solve_ik(simulation, posed.pose(POSE), options=OPTIONS)
        return Proposal(
            winches=found.winches,
            cables=found.cables,
            expected_error=expected_error(simulation, [reached], BuildTolerances.of(found.body)),
            method=DesignMethod.TREES,
            words=words,
        )


def request_routes(robot: Robot, wishes: Wishes) -> DesignRequest:
    """Build the request to the search for routes, for all poses of a robot.

    Raises InputError for counts or limits that do not fit each other or the robot.
    """
    return DesignRequest(
        poses=tuple(robot.poses.values()),
        winches=_winches(wishes),
        cables=wishes.cables,
        constraints=wishes.to_constraints(robot),
        options=wishes.options,
    ).fit_robot(robot)


def request_trees(robot: Robot, wishes: Wishes) -> DesignRequest:
    """Build the request to the thesis's search for the held pose; the search ignores painted zones and a mirror.

    Raises InputError for counts that do not fit each other.
    """
    shares = 12  # ways to share the cables among the winches that are tried until a network can be built
    return DesignRequest(
        poses=(robot.pose(POSE),),
        winches=_winches(wishes),
        cables=wishes.cables,
        method=DesignMethod.TREES,
        constraints=wishes.constraints.restrict_to_trees(),
        options=replace(wishes.tree_options, shares=shares),
    ).fit_robot(robot)


def _winches(wishes: Wishes) -> int:
    usual = 2  # where their number is left open
    return wishes.winches or min(usual, wishes.cables)


def propose_network(robot: Robot, moment: ProposalInput, body: BodyPhysics | None = None) -> Proposal:
    """Propose the last and best network for one proposal input (HydrostatError: wishes that do not fit the robot)."""
    *_, last = Proposer(robot, body).propose(moment)
    return last


def propose_work(pipe: Any) -> None:
    """Answer questions from a pipe, each better network as it comes.

    What comes through the pipe: a `Robot`, which replaces the robot, a `ProposalInput`, or None, which ends the answer
    to it early. What goes: a `Proposal` as often as there is a better one, then None. The first network is always
    found, so that a drag without an end gets networks, too.
    """
    polite = 10  # the process steps back by so much, so that what a person drags comes first
    if hasattr(os, "nice"):
        os.nice(polite)
    proposer: Proposer | None = None
    try:
        while True:
            given = pipe.recv()
            if isinstance(given, Robot):
                proposer = Proposer(given)
            elif given is not None and proposer is not None:
                _answer(pipe, proposer, given)
    except (EOFError, OSError, KeyboardInterrupt):
        return


def _answer(pipe: Any, proposer: Proposer, moment: ProposalInput) -> None:
    """Send proposals until something else is asked."""
    try:
        for proposal in proposer.propose(moment):
            pipe.send(proposal)
            if pipe.poll():
                break
    except HydrostatError as error:
        pipe.send(Proposal(words=str(error)))
    pipe.send(None)
