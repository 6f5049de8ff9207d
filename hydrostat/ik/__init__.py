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
from hydrostat.ik.tracker import Tracker

__all__ = [
    "CentreGoal",
    "Closeness",
    "ClosenessKind",
    "Effort",
    "EffortKind",
    "InverseOptions",
    "InverseReason",
    "Limits",
    "MarkerGoal",
    "Moves",
    "Objective",
    "Posture",
    "ReachedPose",
    "ShapeGoal",
    "Targets",
    "Term",
    "Tracker",
    "drawn_pose",
    "moves_at",
    "posture_at",
    "solve_ik",
]
