"""Which contractions reach a pose."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.ik.image_length import image_length, usable_spans
    from hydrostat.ik.left_free import left_free
    from hydrostat.ik.limits import Limits
    from hydrostat.ik.new_robot import BegunRobot, NewRobotWish, begin_robot, new_robot
    from hydrostat.ik.objectives.centre_goal import CentreGoal
    from hydrostat.ik.objectives.closeness import Closeness, ClosenessKind
    from hydrostat.ik.objectives.effort import Effort, EffortKind
    from hydrostat.ik.objectives.marker_goal import MarkerGoal, named_targets
    from hydrostat.ik.objectives.objective import Moves, Objective, Posture, Term, moves_at, place, posture_at
    from hydrostat.ik.objectives.point_goal import PointGoal
    from hydrostat.ik.objectives.shape_goal import ShapeGoal, drawn_pose
    from hydrostat.ik.outlook import Outlook
    from hydrostat.ik.reach import FoundReach, find_reach
    from hydrostat.ik.reached_pose import InverseReason, ReachedPose
    from hydrostat.ik.search.linear_model import least_squares
    from hydrostat.ik.search.problem import InverseOptions
    from hydrostat.ik.solve_ik import Targets, solve_ik
    from hydrostat.ik.tracker import Tracker
    from hydrostat.ik.trajectory.keys import Key, Keyframe
    from hydrostat.ik.trajectory.poses import Snap
    from hydrostat.ik.trajectory.solve_ik_trajectory import TrajectoryOptions, solve_ik_trajectory
    from hydrostat.ik.trajectory.trajectory import KeyPose, PathKind, Trajectory

__all__ = [
    "BegunRobot",
    "CentreGoal",
    "Closeness",
    "ClosenessKind",
    "Effort",
    "EffortKind",
    "FoundReach",
    "InverseOptions",
    "InverseReason",
    "Key",
    "KeyPose",
    "Keyframe",
    "Limits",
    "MarkerGoal",
    "Moves",
    "NewRobotWish",
    "Objective",
    "Outlook",
    "PathKind",
    "PointGoal",
    "Posture",
    "ReachedPose",
    "ShapeGoal",
    "Snap",
    "Targets",
    "Term",
    "Tracker",
    "Trajectory",
    "TrajectoryOptions",
    "begin_robot",
    "drawn_pose",
    "find_reach",
    "image_length",
    "least_squares",
    "left_free",
    "moves_at",
    "named_targets",
    "new_robot",
    "place",
    "posture_at",
    "solve_ik",
    "solve_ik_trajectory",
    "usable_spans",
]

open_package(__name__)
