"""Inverse kinematics: contractions that reach a target pose."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.ik.correct_contractions import CORRECTION_DAMPING, correct_contractions
    from hydrostat.ik.ik_result import IKResult, IKStatus
    from hydrostat.ik.inverse_kinematics import Targets, solve_ik
    from hydrostat.ik.limits import Limits, spool_arms
    from hydrostat.ik.linearized_pose import LinearizedPose, unconstrained_motion
    from hydrostat.ik.objectives.center_of_mass_target import CenterOfMassTarget
    from hydrostat.ik.objectives.effort import Effort
    from hydrostat.ik.objectives.marker_target import MarkerTarget, PointTarget, named_targets
    from hydrostat.ik.objectives.objective import EquilibriumState, Objective, Residual, StateJacobian, place
    from hydrostat.ik.objectives.pose_regularizer import PoseRegularizer
    from hydrostat.ik.objectives.shape_target import ShapeTarget, load_target_outline
    from hydrostat.ik.pulls import solve_pulls
    from hydrostat.ik.robot_draft import BegunRobot, NewRobotWish, new_robot, with_first_pose
    from hydrostat.ik.search.linear_model import least_squares, solve_nonnegative
    from hydrostat.ik.search.problem import IKOptions
    from hydrostat.ik.tracker import Tracker
    from hydrostat.ik.trajectory.keys import Keyframe
    from hydrostat.ik.trajectory.solve_ik_trajectory import TrajectoryOptions, solve_ik_trajectory
    from hydrostat.ik.trajectory.trajectory import KeyPose, PathKind, Trajectory
    from hydrostat.ik.workspace import MarkerWorkspace, find_workspaces, usable_spans, workspace_extent

__all__ = [
    "CORRECTION_DAMPING",
    "BegunRobot",
    "CenterOfMassTarget",
    "Effort",
    "EquilibriumState",
    "IKOptions",
    "IKResult",
    "IKStatus",
    "KeyPose",
    "Keyframe",
    "Limits",
    "LinearizedPose",
    "MarkerTarget",
    "MarkerWorkspace",
    "NewRobotWish",
    "Objective",
    "PathKind",
    "PointTarget",
    "PoseRegularizer",
    "Residual",
    "ShapeTarget",
    "StateJacobian",
    "Targets",
    "Tracker",
    "Trajectory",
    "TrajectoryOptions",
    "correct_contractions",
    "find_workspaces",
    "least_squares",
    "load_target_outline",
    "named_targets",
    "new_robot",
    "place",
    "solve_ik",
    "solve_ik_trajectory",
    "solve_nonnegative",
    "solve_pulls",
    "spool_arms",
    "unconstrained_motion",
    "usable_spans",
    "with_first_pose",
    "workspace_extent",
]

open_package(__name__)
