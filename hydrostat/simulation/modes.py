"""`find_modes`: small free vibrations about an equilibrium."""

from dataclasses import dataclass
from typing import SupportsIndex

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.result_table import Columns, Tabular
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.simulation.linear_pose import LinearPose
from hydrostat.simulation.simulation import Simulation


@dataclass(frozen=True, kw_only=True, eq=False)
class Modes(Tabular):
    """Vibration modes about a pose at fixed controls, in order of frequency.

    Attributes:
        frequencies: frequency of each mode [Hz], without damping and with relaxed Maxwell branches.
        damping: damping ratio of each mode, to first order in viscosity and Maxwell branches; 1 is critical damping.
        shapes: node displacements in each mode, (modes, nodes, dim), of unit modal mass [1/kg^0.5].
    """

    frequencies: Vector
    damping: Vector
    shapes: Float[np.ndarray, "modes nodes dim"]

    def columns(self) -> Columns:
        """Return a table of frequency and damping ratio, one row for each mode."""
        return {"frequency_Hz": self.frequencies, "damping_ratio": self.damping}

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<{len(self.frequencies)} Modes: {', '.join(f'{value:.3g}' for value in self.frequencies)} Hz>"


def find_modes(simulation: Simulation, pose: Equilibrium | None = None, *, count: SupportsIndex = 6) -> Modes:
    """Compute the lowest vibration modes about an equilibrium; taut cables act as springs, and winches are fixed.

    Args:
        simulation: physics of the robot.
        pose: equilibrium; that without contractions if left out.
        count: number of modes.

    Raises:
        InputError: friction, or a count that is not from 1 to the number of unknowns.
        NotConvergedError: the pose is not a stable equilibrium.
    """
    pose = simulation.rest if pose is None else pose
    linear = LinearPose(simulation, pose)
    basis = linear.find_basis(count)
    rates = np.sqrt(np.diag(linear.reduce_stiffness(basis)))
    memory = simulation.dynamics.memory
    lost = sum(
        viscosity / (1 + (time * rates) ** 2) for viscosity, time in zip(memory.viscosities, memory.times, strict=True)
    )
    damping = lost * np.diag(linear.reduce_viscous(basis)) / (2 * rates)
    shapes = basis.T.reshape(-1, *linear.assembly.shape)[:, : len(pose.nodes)]
    return Modes(frequencies=rates / (2 * np.pi), damping=damping, shapes=shapes)
