"""What takes long now and then: reading a body that has to be meshed, and compiling."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hydrostat.robot import Robot
    from hydrostat.simulation import Simulation

PATIENCE = 3.0
"""Seconds after which a person is told what takes so long."""


@contextmanager
def patiently(words: str) -> Iterator[None]:
    """Say what is done if it takes long."""
    word = Timer(PATIENCE, lambda: print(words, flush=True))
    word.daemon = True
    word.start()
    try:
        yield
    finally:
        word.cancel()


def read_robot(path: Path) -> "Robot":
    """Robot from its folder or robot.toml; a body from a surface is meshed."""
    from hydrostat.robot import load_robot

    with patiently("meshing the body: a second for each 2,000 nodes or so ..."):
        return load_robot(path)


def prepared(robot: "Robot") -> "Simulation":
    """The physics of a robot, after one solve; the first time on a machine this compiles the kernels."""
    from hydrostat.simulation import Simulation

    with patiently("compiling, once for this machine: about 20 s ..."):
        simulation = Simulation(robot)
        simulation.solve({}, strict=False)
    return simulation
