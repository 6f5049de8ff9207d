"""`propose_work`: winch trees for the muscles that pull just now, again and again, in a process of its own (X1)."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import Any

from hydrostat.arrays import Nodes, Vector
from hydrostat.design import (
    Activation,
    DesignMethod,
    DesignRequest,
    TreeOptions,
    edge_fibres,
    propose_trees,
)
from hydrostat.errors import HydrostatError
from hydrostat.ik import IKOptions, solve_ik
from hydrostat.project import Wishes
from hydrostat.robot import Cable, Robot, Winch
from hydrostat.simulation import BodyPhysics, Simulation
from hydrostat.studio.posing.held import Anchored, HeldPoint
from hydrostat.studio.posing.poses import with_pose

POLITE = 10  # the process steps back by so much, so that what a person drags comes first
POSE = "held"  # name of the pose that is held, in that process alone
WINCHES = 2  # where their number is left open
SHARES = 12  # ways to share the cables among the winches that are tried until a network can be built
STEPS = 12  # of inverse kinematics: enough to say what a network is worth
OPTIONS = IKOptions(iterations=STEPS, restarts=0, min_tension=False)


@dataclass(frozen=True, kw_only=True, eq=False)
class ProposalInput:
    """A body as muscles hold it."""

    held: Mapping[str, HeldPoint]  # points by name, with where they should be
    nodes: Nodes  # where the body is [m]
    tensions: Vector  # of the muscle on each edge of its mesh [N]
    wishes: Wishes  # for a design: counts, limits, knobs


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Result of one proposal input: a network, or why there is none."""

    winches: tuple[Winch, ...] = ()  # of the network
    cables: tuple[Cable, ...] = ()  # of the network
    error: float | None = None  # rms error of the held points that it reaches [m]; None: not known
    words: str = ""  # why there is no network; "" if there is one


def asked_of_trees(robot: Robot, wishes: Wishes) -> DesignRequest:
    """Build the request to the thesis's search for the held pose; the search ignores painted zones and a mirror.

    Raises InputError for counts that do not fit each other.
    """
    return DesignRequest(
        poses=(robot.pose(POSE),),
        winches=wishes.winches or min(WINCHES, wishes.cables),
        cables=wishes.cables,
        method=DesignMethod.TREES,
        constraints=wishes.constraints.restrict_to_trees(),
        options=replace(wishes.tree_options, shares=SHARES),
    ).fit_robot(robot)


def propose_network(robot: Robot, moment: ProposalInput, body: BodyPhysics) -> Proposal:
    """Find the network for one proposal input, with the pose that it reaches."""
    posed = with_pose(robot, POSE, moment.held)
    activation = Activation(
        target=posed.pose(POSE),
        fibres=edge_fibres(robot.body.mesh),
        tensions=moment.tensions,
        nodes=moment.nodes,
        errors=Anchored(robot.body.mesh).errors(moment.held, moment.nodes),
    )
    request = asked_of_trees(posed, moment.wishes)
    found = propose_trees(posed, request, [activation], body=body)
    if found is None:  # the knobs as wished give none that can be built
        usual = replace(TreeOptions(), phis=request.tree_options.phis)
        found = propose_trees(posed, replace(request, options=usual), [activation], body=body)
    if found is None:
        return Proposal(words="no cables found for these muscles. Bend the body more, or ask for fewer in Design")
    reached = solve_ik(Simulation(found, body=body), posed.pose(POSE), options=OPTIONS)
    return Proposal(winches=found.winches, cables=found.cables, error=reached.rms_error)


def propose_work(pipe: Connection) -> None:
    """Answer each `ProposalInput` from the pipe with a `Proposal`; a `Robot` in the pipe replaces the robot."""
    if hasattr(os, "nice"):
        os.nice(POLITE)
    robot: Robot | None = None
    body: BodyPhysics | None = None
    try:
        while True:
            given: Any = pipe.recv()
            if isinstance(given, Robot):
                robot, body = given, None
            elif robot is not None:
                body = body or BodyPhysics(robot)
                pipe.send(_answer(robot, given, body))
    except (EOFError, OSError, KeyboardInterrupt):
        return


def _answer(robot: Robot, moment: ProposalInput, body: BodyPhysics) -> Proposal:
    try:
        return propose_network(robot, moment, body)
    except HydrostatError as error:
        return Proposal(words=str(error))
