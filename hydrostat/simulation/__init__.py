"""The one bridge between robots and mechanics: `Simulation`."""

from hydrostat.simulation.build import body_energies, cable_energy, round_off
from hydrostat.simulation.pose_file import pose_facts, write_pose
from hydrostat.simulation.simulation import Contractions, Simulation
from hydrostat.simulation.solved_pose import SolvedPose

__all__ = [
    "Contractions",
    "Simulation",
    "SolvedPose",
    "body_energies",
    "cable_energy",
    "pose_facts",
    "round_off",
    "write_pose",
]
