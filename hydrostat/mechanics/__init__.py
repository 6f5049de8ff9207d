"""Physics on plain arrays: energies, their assembly, Newton's method. Independent of robots."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.mechanics.assembly import Assembly
    from hydrostat.mechanics.cable import CableEnergy, CableSegments
    from hydrostat.mechanics.cable_friction import FrictionCableEnergy
    from hydrostat.mechanics.capstan import ViaPointTurns
    from hydrostat.mechanics.contact import ContactEnergy
    from hydrostat.mechanics.controlled_load import ControlledLoad
    from hydrostat.mechanics.drive_energy import DriveEnergy
    from hydrostat.mechanics.energy import ContactForces, Energy, LowRankStiffness, Stencils
    from hydrostat.mechanics.factorization import Analysis, Backend, Factorization
    from hydrostat.mechanics.fibre import FibreEnergy
    from hydrostat.mechanics.foam_solid import FoamLaw, FoamSolid
    from hydrostat.mechanics.inertia import SCHEMES, InertiaEnergy
    from hydrostat.mechanics.inversion_barrier import InversionBarrier, pushed_elements
    from hydrostat.mechanics.moment_energy import MomentEnergy
    from hydrostat.mechanics.neo_hookean import NeoHookean
    from hydrostat.mechanics.newton import minimize
    from hydrostat.mechanics.newton_options import NewtonOptions
    from hydrostat.mechanics.newton_result import NewtonResult, Reason, RoundOff
    from hydrostat.mechanics.nodal_energies import LoadEnergy, PinEnergy, WeightEnergy
    from hydrostat.mechanics.obstacle import ObstacleEnergy
    from hydrostat.mechanics.patch_volume import PATCH_SIZE, PatchVolume, grow_patches
    from hydrostat.mechanics.plane_stress import PlaneStress, solve_thickening
    from hydrostat.mechanics.pressure import PressureEnergy
    from hydrostat.mechanics.quadratic_solid import POINTWISE, QuadraticSolid
    from hydrostat.mechanics.rigid import CarriedWarp, GuideEnergy, RigidBodyDofs, RigidEnergy
    from hydrostat.mechanics.rod_energy import RodEnergy, rod_points
    from hydrostat.mechanics.self_friction import SelfFrictionEnergy
    from hydrostat.mechanics.sheet_energy import SheetEnergy
    from hydrostat.mechanics.slider_energy import SliderEnergy
    from hydrostat.mechanics.stiffness import Stiffness
    from hydrostat.mechanics.tension_law import TensionLaw
    from hydrostat.mechanics.viscous import MaxwellBranches, Metrics
    from hydrostat.mechanics.warp import Bend, Warp

__all__ = [
    "PATCH_SIZE",
    "POINTWISE",
    "SCHEMES",
    "Analysis",
    "Assembly",
    "Backend",
    "Bend",
    "CableEnergy",
    "CableSegments",
    "CarriedWarp",
    "ContactEnergy",
    "ContactForces",
    "ControlledLoad",
    "DriveEnergy",
    "Energy",
    "Factorization",
    "FibreEnergy",
    "FoamLaw",
    "FoamSolid",
    "FrictionCableEnergy",
    "GuideEnergy",
    "InertiaEnergy",
    "InversionBarrier",
    "LoadEnergy",
    "LowRankStiffness",
    "MaxwellBranches",
    "Metrics",
    "MomentEnergy",
    "NeoHookean",
    "NewtonOptions",
    "NewtonResult",
    "ObstacleEnergy",
    "PatchVolume",
    "PinEnergy",
    "PlaneStress",
    "PressureEnergy",
    "QuadraticSolid",
    "Reason",
    "RigidBodyDofs",
    "RigidEnergy",
    "RodEnergy",
    "RoundOff",
    "SelfFrictionEnergy",
    "SheetEnergy",
    "SliderEnergy",
    "Stencils",
    "Stiffness",
    "TensionLaw",
    "ViaPointTurns",
    "Warp",
    "WeightEnergy",
    "grow_patches",
    "minimize",
    "pushed_elements",
    "rod_points",
    "solve_thickening",
]

open_package(__name__)
