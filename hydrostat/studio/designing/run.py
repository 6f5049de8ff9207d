"""`DesignRun`: a design that goes on, or has just ended."""

import time
from dataclasses import dataclass, field, replace

import numpy as np

from hydrostat.design import BuildCost, DesignMethod, DesignRequest, RouteOptions, assign_cable_sides
from hydrostat.project import Wishes
from hydrostat.robot import PoseTarget, Robot
from hydrostat.studio.designing.design_work import BestSoFar


def wished_request(robot: Robot, wishes: Wishes, options: RouteOptions | None = None) -> DesignRequest:
    """Build the design request from the design settings (InputError: no pose, or settings that do not fit the robot).

    The options are of the search for routes; if left out its usual ones, with the wished tolerance and simplicity.
    Winch trees are grown as the thesis does it, by one value of each of its knobs (R46).
    """
    request = DesignRequest(
        poses=wishes.to_poses(robot),
        winches=wishes.winches or "auto",
        cables=wishes.cables,
        constraints=wishes.to_constraints(robot),
        method=DesignMethod.CHANG2018 if wishes.method.grows_trees else wishes.method,
        options=wishes.tree_options if wishes.method.grows_trees else options or wishes.options,
        warm_start=wishes.improve,
    )
    request.fit_robot(robot)  # raises InputError for what does not fit
    return request


@dataclass(frozen=True, kw_only=True)
class ProgressPoint:
    """The best network at one moment."""

    seconds: float  # since the design was asked for
    error: float  # root of the mean squared marker error over all poses [m]
    winches: int  # how many it has
    cables: int  # how many it has
    minutes: float  # of cutting and stitching it [min]
    words: str = ""  # what was done to get it, such as "a cable exchanged"
    num_evaluated: int = 0  # number of networks tried until then


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRun:
    """Progress of a design."""

    robot: Robot  # that is designed for
    request: DesignRequest  # what was asked
    began: float  # when, on a clock that only runs forward [s]
    rest: float  # error if nothing moved [m]
    best: Robot  # the robot with the best network so far; with what stays of its own before the first
    trail: tuple[ProgressPoint, ...] = field(default=())  # of the best network, in time
    is_live: bool = False  # whether a knob began it, rather than the button

    def with_better(self, found: BestSoFar) -> "DesignRun":
        """Return the run with a better network, found now."""
        best = assign_cable_sides(self.robot).with_network(found.winches, found.cables)
        mark = ProgressPoint(
            seconds=time.monotonic() - self.began,
            error=found.error,
            winches=len(found.winches),
            cables=len(found.cables),
            minutes=BuildCost.cable_minutes(best),
            words=found.words,
            num_evaluated=found.num_evaluated,
        )
        return replace(self, best=best, trail=(*self.trail, mark))


def share_done(request: DesignRequest, stage: str, done: int, total: int) -> float | None:
    """Share of a search that is done, 0 to 1, by typical times of its stages; None where it cannot be told.

    The stages of a search whose number of winches is open repeat.
    """
    if request.is_open or (stage == "Growing networks" and not done):
        return None
    start, end = SHARES.get(stage, (0.0, 0.0))
    return start + (end - start) * min(done / total if total else 0.0, 1.0) if end else None


SHARES = {
    "Drawing networks": (0.08, 0.45),
    "Growing networks": (0.45, 0.57),
    "Refining": (0.57, 0.62),
    "Exchanging cables": (0.62, 0.84),
    "Activating muscles": (0.0, 0.35),
    "Growing winch trees": (0.35, 0.55),
    "Judging networks": (0.55, 0.9),
}
"""Share of the time of a search at which each of its stages begins and ends, as measured on gallery robots."""


def time_left(seconds: float, share: float | None) -> str:
    """Time that a search still takes, in words, from that since it began [s]; "" where it cannot be told yet."""
    known = 0.15  # share of the search before which nothing can be said
    if share is None or share < known:
        return ""
    left = seconds * (1.0 - share) / share
    step = 5 if left < 60 else 15
    return f"about {max(round(left / step), 1) * step:.0f} s left"


def starting_robot(robot: Robot, request: DesignRequest) -> Robot:
    """Return the robot with the network that a search starts from: its own if improved, else the kept parts of it."""
    limits = request.constraints
    if request.warm_start:
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
