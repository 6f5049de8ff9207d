"""`DesignRun`: a design that goes on, or has just ended."""

from dataclasses import dataclass, field

import numpy as np

from hydrostat.design import AUTO, DesignMethod, DesignRequest, RouteOptions
from hydrostat.errors import InputError
from hydrostat.project import Wishes, wished_constraints
from hydrostat.robot import PoseTarget, Robot


def wished_request(robot: Robot, wishes: Wishes, options: RouteOptions | None = None) -> DesignRequest:
    """Build the design request from the design settings (InputError: no pose, or settings that do not fit the robot).

    The options are of the search for routes; if left out its usual ones, with the wished tolerance and simplicity.
    Winch trees are grown as the thesis does it, by one value of each of its knobs (R46).
    """
    trees = wishes.method is DesignMethod.TREES
    request = DesignRequest(
        poses=wished_poses(robot, wishes),
        winches=wishes.winches or AUTO,
        cables=wishes.cables,
        constraints=wished_constraints(robot, wishes),
        method=wishes.method,
        options=wishes.tree_options if trees else options or wishes.options,
        improve=wishes.improve,
    )
    request.fit_robot(robot)  # raises InputError for what does not fit
    return request


def wished_poses(robot: Robot, wishes: Wishes) -> tuple[PoseTarget, ...]:
    """The poses to reach: those that are named and still there; all if none is (InputError: the robot has no pose)."""
    if not robot.poses:
        raise InputError("no poses to design for. Drag the body in Pose and store a pose")
    named = [pose for name, pose in robot.poses.items() if name in wishes.poses]
    return tuple(named or robot.poses.values())


@dataclass(frozen=True, kw_only=True)
class ProgressPoint:
    """The best network at one moment."""

    seconds: float  # since the design was asked for
    error: float  # root of the mean squared marker error over all poses [m]
    winches: int  # how many it has
    cables: int  # how many it has
    minutes: float  # of cutting and stitching it [min]


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRun:
    """Progress of a design."""

    robot: Robot  # that is designed for
    request: DesignRequest  # what was asked
    began: float  # when, on a clock that only runs forward [s]
    rest: float  # error if nothing moved [m]
    best: Robot  # the robot with the best network so far; with what stays of its own before the first
    trail: tuple[ProgressPoint, ...] = field(default=())  # of the best network, in time


def starting_robot(robot: Robot, request: DesignRequest) -> Robot:
    """Return the robot with the network that a search starts from: its own if improved, else the kept parts of it."""
    limits = request.constraints
    if request.improve:
        return robot
    return robot.with_network(*limits.staying(robot))


def error_at_rest(robot: Robot, poses: tuple[PoseTarget, ...]) -> float:
    """Root of the mean squared distance of markers from their targets over all poses, if nothing moved [m]."""
    places = {marker.name: np.array(marker.at) for marker in robot.markers}
    squares = [
        np.mean([np.sum((places[name] - np.array(goal)) ** 2) for name, goal in pose.targets.items()])
        for pose in poses
        if pose.targets
    ]
    return float(np.sqrt(np.mean(squares))) if squares else 0.0
