"""Physics on plain arrays: energies, their assembly, Newton. It knows no robot."""

from hydrostat.mechanics.assembly import Assembly, nearest_semidefinite
from hydrostat.mechanics.cable import CableEnergy, TensionLaw
from hydrostat.mechanics.energy import Energy
from hydrostat.mechanics.factorisation import Factorisation
from hydrostat.mechanics.fibre import FibreEnergy
from hydrostat.mechanics.neo_hookean import NeoHookean
from hydrostat.mechanics.newton import NewtonOptions, NewtonResult, Reason, RoundOff, minimise
from hydrostat.mechanics.pin import PinEnergy

__all__ = [
    "Assembly",
    "CableEnergy",
    "Energy",
    "Factorisation",
    "FibreEnergy",
    "NeoHookean",
    "NewtonOptions",
    "NewtonResult",
    "PinEnergy",
    "Reason",
    "RoundOff",
    "TensionLaw",
    "minimise",
    "nearest_semidefinite",
]
