"""The one bridge between robots and mechanics: `Simulation`."""

from hydrostat.simulation.build import body_energies, cable_energies, round_off
from hydrostat.simulation.simulation import Contractions, Simulation
from hydrostat.simulation.solved_pose import SolvedPose

__all__ = ["Contractions", "Simulation", "SolvedPose", "body_energies", "cable_energies", "round_off"]
