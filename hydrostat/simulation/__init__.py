"""The one bridge between robots and mechanics: `Simulation`."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.simulation.body_physics import BodyPhysics
    from hydrostat.simulation.branches.branch import Branch
    from hydrostat.simulation.branches.continue_branch import continue_branch
    from hydrostat.simulation.branches.find_equilibria import Multistability, find_equilibria
    from hydrostat.simulation.branches.loading_paths import friction_hysteresis
    from hydrostat.simulation.cable_sensitivities import CableSensitivities, cable_sensitivities
    from hydrostat.simulation.compliance import marker_compliance
    from hydrostat.simulation.contact_patches import ContactPatch, find_contacts
    from hydrostat.simulation.contraction_profile import ContractionProfile, ProfileTable
    from hydrostat.simulation.controls import Contractions, contraction_values
    from hydrostat.simulation.equilibrium import Equilibrium, check_pose, largest_distance
    from hydrostat.simulation.modes import Modes, find_modes
    from hydrostat.simulation.motion_file import MotionTable, write_motion, write_pose
    from hydrostat.simulation.obstacle_frames import obstacle_forces, obstacles_in_pose, with_obstacles, with_replaced
    from hydrostat.simulation.sensitivities.adjoint import Sensitivity
    from hydrostat.simulation.sensor_reader import SensorReader
    from hydrostat.simulation.simulation import Simulation
    from hydrostat.simulation.state_space import StateSpace, linearize
    from hydrostat.simulation.static_obstacles import require_static_obstacles, rests_at_first, without_contact_friction
    from hydrostat.simulation.statics.batch_result import BatchResult
    from hydrostat.simulation.statics.static_solver import StaticSolver, not_converged
    from hydrostat.simulation.strain import node_strains, node_stresses
    from hydrostat.simulation.stuffed_motion import StuffedMotion, is_stuffed_motion_fast, solve_stuffed_motion
    from hydrostat.simulation.time.dynamics import StepOptions
    from hydrostat.simulation.time.motion import Motion
    from hydrostat.simulation.torch_bridge import solve_torch

__all__ = [
    "BatchResult",
    "BodyPhysics",
    "Branch",
    "CableSensitivities",
    "ContactPatch",
    "ContractionProfile",
    "Contractions",
    "Equilibrium",
    "Modes",
    "Motion",
    "MotionTable",
    "Multistability",
    "ProfileTable",
    "Sensitivity",
    "SensorReader",
    "Simulation",
    "StateSpace",
    "StaticSolver",
    "StepOptions",
    "StuffedMotion",
    "cable_sensitivities",
    "check_pose",
    "continue_branch",
    "contraction_values",
    "find_contacts",
    "find_equilibria",
    "find_modes",
    "friction_hysteresis",
    "is_stuffed_motion_fast",
    "largest_distance",
    "linearize",
    "marker_compliance",
    "node_strains",
    "node_stresses",
    "not_converged",
    "obstacle_forces",
    "obstacles_in_pose",
    "require_static_obstacles",
    "rests_at_first",
    "solve_stuffed_motion",
    "solve_torch",
    "with_obstacles",
    "with_replaced",
    "without_contact_friction",
    "write_motion",
    "write_pose",
]

open_package(__name__)
