"""The one bridge between robots and mechanics: `Simulation`."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.simulation.adjoint import Sensitivity
    from hydrostat.simulation.balanced import balanced
    from hydrostat.simulation.body_physics import BodyPhysics
    from hydrostat.simulation.branch import Branch, BranchPoint, BranchReason, CriticalKind, CriticalPoint
    from hydrostat.simulation.dynamics import Dynamics, PinShifts, StepOptions
    from hydrostat.simulation.filled import FilledMotion, filled_motion, quickly_filled
    from hydrostat.simulation.follow_branch import BranchOptions, follow_branch
    from hydrostat.simulation.friction_band import friction_band
    from hydrostat.simulation.many_poses import ManyPoses
    from hydrostat.simulation.meeting import as_posed, carried_frames, obstacle_forces, replacing, with_obstacles
    from hydrostat.simulation.motion import Motion
    from hydrostat.simulation.motion_file import MotionTable, write_motion
    from hydrostat.simulation.obstacles import not_converged
    from hydrostat.simulation.path_dependence import FoundPose, PathDependence, path_dependence
    from hydrostat.simulation.pose_file import pose_facts, write_pose
    from hydrostat.simulation.profile import Profile, ProfileTable, profile_text, read_profile, write_profile
    from hydrostat.simulation.rig_slopes import RigSlopes, rig_slopes
    from hydrostat.simulation.simulation import Simulation
    from hydrostat.simulation.solved_pose import (
        Contractions,
        SolvedPose,
        check_pose,
        contraction_values,
        largest_distance,
    )
    from hydrostat.simulation.static_solver import StaticSolver
    from hydrostat.simulation.still import check_still, rests_at_first, smooth_robot
    from hydrostat.simulation.strain import node_strains, node_stresses
    from hydrostat.simulation.touches import Touch, touch_words, touches

__all__ = [
    "BodyPhysics",
    "Branch",
    "BranchOptions",
    "BranchPoint",
    "BranchReason",
    "Contractions",
    "CriticalKind",
    "CriticalPoint",
    "Dynamics",
    "FilledMotion",
    "FoundPose",
    "ManyPoses",
    "Motion",
    "MotionTable",
    "PathDependence",
    "PinShifts",
    "Profile",
    "ProfileTable",
    "RigSlopes",
    "Sensitivity",
    "Simulation",
    "SolvedPose",
    "StaticSolver",
    "StepOptions",
    "Touch",
    "as_posed",
    "balanced",
    "carried_frames",
    "check_pose",
    "check_still",
    "contraction_values",
    "filled_motion",
    "follow_branch",
    "friction_band",
    "largest_distance",
    "node_strains",
    "node_stresses",
    "not_converged",
    "obstacle_forces",
    "path_dependence",
    "pose_facts",
    "profile_text",
    "quickly_filled",
    "read_profile",
    "replacing",
    "rests_at_first",
    "rig_slopes",
    "smooth_robot",
    "touch_words",
    "touches",
    "with_obstacles",
    "write_motion",
    "write_pose",
    "write_profile",
]

open_package(__name__)
