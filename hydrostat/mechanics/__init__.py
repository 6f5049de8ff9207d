"""Physics on plain arrays: energies, their assembly, Newton's method. Independent of robots."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.mechanics.assembly import Assembly
    from hydrostat.mechanics.cable import CableEnergy, CableSegments
    from hydrostat.mechanics.cable_friction import FrictionCableEnergy
    from hydrostat.mechanics.capstan import ViaPointTurns
    from hydrostat.mechanics.energy import ContactForces, Energy, LowRankStiffness, Stencils
    from hydrostat.mechanics.factorization import Backend, Factorization, SymbolicFactorization
    from hydrostat.mechanics.factorized_hessian import FactorizedHessian
    from hydrostat.mechanics.fibre import FibreEnergy
    from hydrostat.mechanics.foam_solid import FoamLaw, FoamSolid
    from hydrostat.mechanics.frictional_self_contact import FrictionalSelfContactEnergy
    from hydrostat.mechanics.inertia import SCHEMES, InertiaEnergy
    from hydrostat.mechanics.inversion_barrier import InversionBarrier, pushed_elements
    from hydrostat.mechanics.moment_energy import MomentEnergy
    from hydrostat.mechanics.neo_hookean import NeoHookean
    from hydrostat.mechanics.newton import minimize
    from hydrostat.mechanics.newton_options import NewtonOptions
    from hydrostat.mechanics.newton_result import NewtonResult, NewtonStatus, RoundOff
    from hydrostat.mechanics.nodal_energies import (
        DeadLoadEnergy,
        DrivenLoadEnergy,
        DrivenPinEnergy,
        LoadEnergy,
        PinEnergy,
    )
    from hydrostat.mechanics.obstacle import ObstacleEnergy
    from hydrostat.mechanics.patch_dilatation import PATCH_SIZE, PatchDilatation, grow_patches
    from hydrostat.mechanics.plane_stress import solve_thickening
    from hydrostat.mechanics.prandtl_energy import PrandtlEnergy
    from hydrostat.mechanics.pressure import PressureEnergy
    from hydrostat.mechanics.quadratic_solid import MAX_POINTWISE_RATIO, QuadraticSolid
    from hydrostat.mechanics.rigid import GuideEnergy, RigidBodyDofs, RigidBodyWarp, RigidEnergy
    from hydrostat.mechanics.rod_energy import RodEnergy, rod_points
    from hydrostat.mechanics.rod_twist_energy import RodTwistEnergy
    from hydrostat.mechanics.self_contact import SelfContactEnergy
    from hydrostat.mechanics.sheet_energy import SheetEnergy
    from hydrostat.mechanics.tension_law import TensionLaw
    from hydrostat.mechanics.viscous import MaxwellBranches, ViscousMetrics
    from hydrostat.mechanics.warp import StepMap, Warp

__all__ = [
    "MAX_POINTWISE_RATIO",
    "PATCH_SIZE",
    "SCHEMES",
    "Assembly",
    "Backend",
    "CableEnergy",
    "CableSegments",
    "ContactForces",
    "DeadLoadEnergy",
    "DrivenLoadEnergy",
    "DrivenPinEnergy",
    "Energy",
    "Factorization",
    "FactorizedHessian",
    "FibreEnergy",
    "FoamLaw",
    "FoamSolid",
    "FrictionCableEnergy",
    "FrictionalSelfContactEnergy",
    "GuideEnergy",
    "InertiaEnergy",
    "InversionBarrier",
    "LoadEnergy",
    "LowRankStiffness",
    "MaxwellBranches",
    "MomentEnergy",
    "NeoHookean",
    "NewtonOptions",
    "NewtonResult",
    "NewtonStatus",
    "ObstacleEnergy",
    "PatchDilatation",
    "PinEnergy",
    "PrandtlEnergy",
    "PressureEnergy",
    "QuadraticSolid",
    "RigidBodyDofs",
    "RigidBodyWarp",
    "RigidEnergy",
    "RodEnergy",
    "RodTwistEnergy",
    "RoundOff",
    "SelfContactEnergy",
    "SheetEnergy",
    "Stencils",
    "StepMap",
    "SymbolicFactorization",
    "TensionLaw",
    "ViaPointTurns",
    "ViscousMetrics",
    "Warp",
    "grow_patches",
    "minimize",
    "pushed_elements",
    "rod_points",
    "solve_thickening",
]

open_package(__name__)
