"""Derivatives by central differences: the oracle of the conformance checks."""

from collections.abc import Callable, Iterator

import numpy as np

from hydrostat.arrays import Float


class ConformanceError(AssertionError):
    """Failed conformance check, such as "gradient", with the worst entry and its relative error."""

    def __init__(self, check: str, message: str, *, index: tuple[int, ...] = (), relative_error: float = 0.0) -> None:
        where = f" at {list(index)}" if index else ""
        off = f" (relative error {relative_error:.2g})" if relative_error else ""
        super().__init__(f"{check}{where}: {message}{off}")
        self.check, self.index, self.relative_error = check, index, relative_error


def central_differences(
    function: Callable[[np.ndarray], Float[np.ndarray, " values"]],
    point: Float[np.ndarray, " variables"],
    variables: np.ndarray,
    step: float,
) -> Float[np.ndarray, "values chosen"]:
    """Return the derivative of `function` by selected variables; fourth order in `step` (Richardson).

    A column is NaN where the function is not finite within reach of the step.
    """
    with np.errstate(all="ignore"):
        columns = [_richardson(function, point, int(variable), step) for variable in variables]
    return np.stack(columns, axis=1)


def steps(scale: float) -> Iterator[float]:
    """Steps to try in turn for a variable of this scale."""
    # fractions of a natural scale; the first is right for most functions
    relative_steps = (1e-3, 1e-4, 1e-2, 1e-5, 1e-6)
    return (relative * scale for relative in relative_steps)


def _richardson(
    function: Callable[[np.ndarray], np.ndarray], point: np.ndarray, variable: int, step: float
) -> np.ndarray:
    coarse, fine = (_derivative(function, point, variable, length) for length in (step, 0.5 * step))
    return (4 * fine - coarse) / 3


def _derivative(
    function: Callable[[np.ndarray], np.ndarray], point: np.ndarray, variable: int, step: float
) -> np.ndarray:
    ahead, behind = point.copy(), point.copy()
    ahead[variable] += step
    behind[variable] -= step
    derivative = (function(ahead) - function(behind)) / (ahead[variable] - behind[variable])
    return np.where(np.isfinite(derivative), derivative, np.nan)
