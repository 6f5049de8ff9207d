"""`IdentificationModel`: a robot and its measurement as functions of the unknown numbers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Points
from hydrostat.errors import InputError
from hydrostat.robot import Robot

Values = Mapping[str, float]
"""Values of the parameters by name."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """Unknown number of a robot or of its measurement, with what is known about it before: a normal distribution.

    Attributes:
        name: unique name, such as `young` or `left.slack`.
        start: best guess, at which the fit begins.
        spread: standard deviation of the guess, in the unit of `start`; with `log` that of the logarithm.
        unit: unit for people, such as "Pa".
        log: fit the logarithm, for numbers above 0 whose scale is unknown.
        low: least value.
        high: largest value.

    Raises:
        InputError: a spread that is not above 0, a start outside its limits, or a logarithm of what is not above 0.
    """

    name: str
    start: float
    spread: float
    unit: str = ""
    log: bool = False
    low: float = -np.inf
    high: float = np.inf

    def __post_init__(self) -> None:
        if not self.spread > 0:
            raise InputError(f"{self.name}: spread must be above 0, not {self.spread:g}")
        if not self.low <= self.start <= self.high:
            raise InputError(f"{self.name}: start ({self.start:g}) must be from {self.low:g} to {self.high:g}")
        if self.log and not self.start > 0:
            raise InputError(f"{self.name}: start ({self.start:g}) must be above 0, as its logarithm is fitted")

    def to_fitted(self, value: float) -> float:
        """Value in the coordinate of the fit: in spreads from the start."""
        return (float(np.log(value / self.start)) if self.log else value - self.start) / self.spread

    def from_fitted(self, number: float) -> float:
        """Value that stands for a coordinate of the fit."""
        return self.start * float(np.exp(number * self.spread)) if self.log else self.start + number * self.spread

    @property
    def limits(self) -> tuple[float, float]:
        """Limits in the coordinate of the fit."""
        low = self.to_fitted(self.low) if self.low > (0 if self.log else -np.inf) else -np.inf
        return low, self.to_fitted(self.high) if self.high < np.inf else np.inf


@dataclass(frozen=True, kw_only=True)
class IdentificationModel:
    """A robot and its measurement as functions of the values of its parameters.

    All three functions must be smooth. They are differentiated by small changes of the values; the equilibrium, which
    takes the time, by its adjoint. `robot` may change all that `Sensitivity` differentiates, and places of markers.

    Attributes:
        parameters: the unknown numbers.
        robot: robot with these values.
        contractions: contractions [m] of all rows, (rows, winches), from the commands with these values: gains and
            zeros of winches, backlash.
        places: places in the frame of the measurement [m], (..., dim), of places in the frame of the robot.
        force_scale: measured over simulated forces of the winches, such as that of a torque constant.
    """

    parameters: tuple[Parameter, ...]
    robot: Callable[[Values], Robot]
    contractions: Callable[[Values, Float[np.ndarray, "rows winches"]], Float[np.ndarray, "rows winches"]] = (
        lambda _, commands: commands
    )
    places: Callable[[Values, Points], Points] = lambda _, places: places
    force_scale: Callable[[Values], float] = lambda _: 1.0

    @property
    def start(self) -> dict[str, float]:
        """Values before the fit."""
        return {parameter.name: parameter.start for parameter in self.parameters}

    def values(self, numbers: np.ndarray) -> dict[str, float]:
        """Values at coordinates of the fit."""
        return {
            parameter.name: parameter.from_fitted(float(number))
            for parameter, number in zip(self.parameters, numbers, strict=True)
        }
