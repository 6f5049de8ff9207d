"""Physics on plain arrays: energies, their assembly, Newton. It knows no robot."""

from typing import TYPE_CHECKING

from hydrostat.lazy import open_package

if TYPE_CHECKING:
    from hydrostat.mechanics.assembly import Assembly
    from hydrostat.mechanics.cable import CableEnergy, CableSegments
    from hydrostat.mechanics.chain_law import ChainLaw
    from hydrostat.mechanics.contact import ContactEnergy
    from hydrostat.mechanics.energy import Compliance, Coupling, Energy, Law, nearest_semidefinite
    from hydrostat.mechanics.factorisation import Analysis, Factorisation, factorise
    from hydrostat.mechanics.fibre import FibreEnergy
    from hydrostat.mechanics.friction import FrictionCableEnergy
    from hydrostat.mechanics.neo_hookean import NeoHookean
    from hydrostat.mechanics.newton import minimise
    from hydrostat.mechanics.newton_options import NewtonOptions, Reason, RoundOff
    from hydrostat.mechanics.newton_result import NewtonResult
    from hydrostat.mechanics.obstacle import ObstacleEnergy
    from hydrostat.mechanics.pin import PinEnergy
    from hydrostat.mechanics.rubbing import RubbingEnergy
    from hydrostat.mechanics.stiffness import Stiffness
    from hydrostat.mechanics.tension_law import TensionLaw
    from hydrostat.mechanics.turns import Turns
    from hydrostat.mechanics.warp import Warp
    from hydrostat.mechanics.weight import WeightEnergy

__all__ = [
    "Analysis",
    "Assembly",
    "CableEnergy",
    "CableSegments",
    "ChainLaw",
    "Compliance",
    "ContactEnergy",
    "Coupling",
    "Energy",
    "Factorisation",
    "FibreEnergy",
    "FrictionCableEnergy",
    "Law",
    "NeoHookean",
    "NewtonOptions",
    "NewtonResult",
    "ObstacleEnergy",
    "PinEnergy",
    "Reason",
    "RoundOff",
    "RubbingEnergy",
    "Stiffness",
    "TensionLaw",
    "Turns",
    "Warp",
    "WeightEnergy",
    "factorise",
    "minimise",
    "nearest_semidefinite",
]

open_package(__name__)
