"""`prepared`: a simulation whose first solve is not slowed by compiling."""

from threading import Timer
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.robot import Robot
    from hydrostat.simulation import Simulation

PATIENCE = 3.0
"""Seconds after which a person is told what takes so long."""


def prepared(robot: "Robot") -> "Simulation":
    """The physics of a robot, after one solve; the first time on a machine this compiles the kernels."""
    from hydrostat.simulation import Simulation

    word = Timer(PATIENCE, lambda: print("compiling, once for this machine: about 20 s ..."))
    word.daemon = True
    word.start()
    try:
        simulation = Simulation(robot)
        simulation.solve({}, strict=False)
    finally:
        word.cancel()
    return simulation
