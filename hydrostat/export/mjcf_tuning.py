"""`MjcfTuning`: numbers of a MuJoCo model that differ from the robot's."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot

MAX_POISSON = 0.49  # largest Poisson's ratio of a model


@dataclass(frozen=True, kw_only=True, eq=False)
class MjcfTuning:
    """Parameters that compensate for the different material law of a MuJoCo model.

    Attributes:
        young: factor of Young's modulus of each material [-].
        poisson: shift of Poisson's ratio of each material [-], kept within 0 and 0.49.
        gains: contraction of the model for each contraction of a winch [-], in winch order.
    """

    young: float
    poisson: float
    gains: Vector

    def shift_poisson(self, poisson: float) -> float:
        """Return Poisson's ratio of a material in the model [-]."""
        return float(np.clip(poisson + self.poisson, 0.0, max(MAX_POISSON, poisson)))

    def describe(self, robot: Robot) -> str:
        """Return a sentence with all parameters."""
        pairs = zip(robot.winches, self.gains, strict=True)
        gains = ", ".join(f"{winch.name} {gain:.3f}" for winch, gain in pairs)
        return f"Young's modulus x {self.young:.3f}, Poisson's ratio {self.poisson:+.3f}, contraction x: {gains}"

    @classmethod
    def none(cls, robot: Robot) -> "MjcfTuning":
        """Return the tuning that changes nothing."""
        return cls(young=1.0, poisson=0.0, gains=np.ones(len(robot.winches)))
