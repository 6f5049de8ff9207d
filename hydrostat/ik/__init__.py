"""Which contractions reach a pose."""

from hydrostat.ik.centre_goal import CentreGoal
from hydrostat.ik.closeness import Closeness, ClosenessKind
from hydrostat.ik.drawn_pose import drawn_pose
from hydrostat.ik.effort import Effort, EffortKind
from hydrostat.ik.limits import Limits
from hydrostat.ik.marker_goal import MarkerGoal
from hydrostat.ik.objective import Moves, Objective, Posture, Term
from hydrostat.ik.postures import moves_at, posture_at
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.ik.search import InverseOptions
from hydrostat.ik.shape_goal import ShapeGoal
from hydrostat.ik.solve_ik import Targets, solve_ik
from hydrostat.ik.solve_ik_trajectory import TrajectoryOptions, solve_ik_trajectory
from hydrostat.ik.tracker import Tracker
from hydrostat.ik.trajectory import KeyPose, PathKind, Trajectory
from hydrostat.ik.trajectory_keys import Key, Keyframe
from hydrostat.ik.trajectory_poses import Snap

__all__ = [
    "CentreGoal",
    "Closeness",
    "ClosenessKind",
    "Effort",
    "EffortKind",
    "InverseOptions",
    "InverseReason",
    "Key",
    "KeyPose",
    "Keyframe",
    "Limits",
    "MarkerGoal",
    "Moves",
    "Objective",
    "PathKind",
    "Posture",
    "ReachedPose",
    "ShapeGoal",
    "Snap",
    "Targets",
    "Term",
    "Tracker",
    "Trajectory",
    "TrajectoryOptions",
    "drawn_pose",
    "moves_at",
    "posture_at",
    "solve_ik",
    "solve_ik_trajectory",
]
