"""`fit_model`: parameters of a robot from measured places of its markers, by Gauss-Newton steps with exact Jacobian."""

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from scipy.optimize import least_squares

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.identification.build_variance import estimate_build_variance
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements, rms
from hydrostat.identification.mesh_shift import estimate_mesh_shift
from hydrostat.identification.model import IdentificationModel
from hydrostat.identification.residuals import Residuals
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import Robot
from hydrostat.units import MM


@dataclass(frozen=True)
class FitRules:
    """Rules of a fit, the same for all robots."""

    missing: float = 5.0
    """Residual of a coordinate without an equilibrium, in standard deviations of the noise."""

    rounds: int = 6
    """Most estimates of the noise, each followed by a fit with it."""

    noise_tolerance: float = 0.1
    """Relative change of the noise below which it is not estimated again."""

    min_free: float = 0.1
    """Least share of the measured coordinates that is left to show the noise."""

    min_force_noise: float = 0.02
    """Least noise of a force over the largest that was measured; the fit begins with five times that."""

    robust: float = 3.0
    """Residual beyond which the loss grows linearly, in standard deviations."""

    clipped: float = 2.0
    mean_square: float = 0.9205
    """Residual beyond which all count alike for the noise [standard deviations], and the mean square of normal ones."""

    inseparable: float = 0.9
    """Correlation of two parameters above which their values are hardly told apart."""

    wrong_unit: float = 9.0
    """Factor by which markers are closer or farther than on the robot from which on their unit is wrong.

    Units in use differ by 10 or more; tips of a gripper that closes come 6 times closer.
    """

    impossible: float = 1e4
    """Residual of every coordinate where the values make no robot: a step there is taken back."""


RULES = FitRules()


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedModel:
    """Parameters of a robot found from measurements.

    Attributes:
        model: robot and measurement as functions of the values.
        values: values by name.
        numbers: the same as coordinates of the fit: spreads from the start.
        covariance: covariance of `numbers` if errors were independent; 1 on the diagonal where the measurements tell
            nothing.
        spread: factor of the errors' variance by `spread_error`, as those of a model are alike in all rows.
        mesh_shift: changes of `numbers` that finer meshes would make, (shifts, parameters); 0 if not estimated.
        build_variance: variance of `numbers` if points of cables and Poisson's ratio are unknown as well; 0 if it was
            not estimated.
        noise: standard deviation of a measured coordinate or length about the model [m], from the residuals.
        force_noise: the same of a measured force [N]; NaN without forces.
        ends: low and high ends of the intervals of `numbers` by `profile_intervals`; None: by `interval_covariance`.
        error: root mean square distance between predicted and measured markers of the fitted rows [m].
        num_failed: fitted rows without an equilibrium.
        iterations: evaluations of the model.
        message: reason why the fit stopped.
    """

    model: IdentificationModel
    values: dict[str, float]
    numbers: Vector
    covariance: Float[np.ndarray, "parameters parameters"]
    spread: float
    mesh_shift: Float[np.ndarray, "shifts parameters"]
    build_variance: Vector
    noise: float
    error: float
    num_failed: int
    iterations: int
    message: str
    force_noise: float = np.nan
    ends: Float[np.ndarray, "two parameters"] | None = None

    @property
    def interval_covariance(self) -> Float[np.ndarray, "parameters parameters"]:
        """Covariance of `numbers` with the errors of the model that are alike in all rows, for this mesh."""
        prior = np.eye(len(self.numbers))
        information = np.linalg.inv(self.covariance) - prior
        return np.linalg.inv(information / self.spread + prior)

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Intervals that hold each value with a probability of about 95 %.

        They are the hull of two: one by the residuals (`ends` if profiled, else `interval_covariance`), and one by
        what residuals cannot show: `build_variance`, and any mesh error between none and the largest `mesh_shift`.
        """
        half = 1.96 * np.sqrt(np.diag(self.interval_covariance))
        low, high = (self.numbers - half, self.numbers + half) if self.ends is None else self.ends
        least, most = self.mesh_shift.min(axis=0, initial=0.0), self.mesh_shift.max(axis=0, initial=0.0)
        middle = self.numbers + 0.5 * (least + most)
        half = 1.96 * np.sqrt(self.build_variance + (most - least) ** 2 / 12)
        low, high = np.minimum(low, middle - half), np.maximum(high, middle + half)
        return {
            parameter.name: (parameter.from_fitted(one), parameter.from_fitted(other))
            for parameter, one, other in zip(self.model.parameters, low, high, strict=True)
        }

    @property
    def information_gains(self) -> dict[str, float]:
        """Share of each guess's uncertainty that the measurements took away: 0 for none, 1 for all."""
        kept = np.sqrt(np.diag(self.covariance))
        return {parameter.name: 1.0 - float(one) for parameter, one in zip(self.model.parameters, kept, strict=True)}

    @property
    def inseparable(self) -> list[tuple[str, str]]:
        """Pairs of nearly indistinguishable parameters: a change of one makes up for a change of the other."""
        spread = np.sqrt(np.diag(self.covariance))
        correlation = self.covariance / np.outer(spread, spread)
        names = [parameter.name for parameter in self.model.parameters]
        return [
            (names[one], names[other])
            for one, other in np.argwhere(np.abs(np.triu(correlation, 1)) > RULES.inseparable).tolist()
        ]

    def predict(self, measurements: Measurements) -> Float[np.ndarray, "rows markers dim"]:
        """Places of the markers [m] in the frame of the measurement, which is not used; NaN without an equilibrium."""
        return MarkerPredictor(self.model, measurements).predict(self.numbers, with_jacobian=False).places


def fit_model(
    model: IdentificationModel,
    measurements: Measurements,
    *,
    noise: float | None = None,
    evaluations: int = 30,
    refine: bool = True,
    progress: Progress = no_progress,
) -> FittedModel:
    """Most probable values of the parameters: least squares over measured places, lengths, forces and guesses.

    Bounded Gauss-Newton steps in a trust region (SciPy, `trf`) with a loss that grows linearly beyond three standard
    deviations, so that swapped or misread markers count little. The noise is that of the residuals,
    estimated until it settles.

    Args:
        model: robot and measurement.
        measurements: rows of commands and places.
        noise: standard deviation of a measured coordinate about the model [m]; estimated if left out.
        evaluations: most evaluations of the model.
        refine: estimate the shift by finer elements, and the uncertainty by what is not fitted.
        progress: callback for progress, after each evaluation.

    Raises:
        InputError: measurements that do not fit the robot, or fewer measured coordinates than one.
    """
    robot = model.robot(model.start)
    check_fit(robot, measurements)
    fit = MarkerFit(model, measurements, noise or 0.02 * robot.body.mesh.size, progress)
    numbers = np.zeros(len(model.parameters))
    limits = np.array([parameter.limits for parameter in model.parameters]).reshape(-1, 2).T
    message, jac = "", cast("Any", fit.jacobian)
    for _ in range(RULES.rounds):
        solved = least_squares(
            fit.residuals,
            numbers,
            jac=jac,
            bounds=(limits[0], limits[1]),
            loss="soft_l1",
            f_scale=RULES.robust,
            max_nfev=max(evaluations - fit.count, 2),
            ftol=1e-4,
            xtol=1e-4,
        )
        numbers, message = solved.x, solved.message
        fit.residuals(numbers)
        if noise is not None or fit.count >= evaluations or not fit.estimate_noise(1e-6 * robot.body.mesh.size):
            break
    jacobian, nothing = fit.jacobian(numbers), np.zeros(len(numbers))
    known = model, measurements, numbers, (fit.noise, fit.force_noise)
    return FittedModel(
        model=model,
        values=model.values(numbers),
        numbers=numbers,
        covariance=np.linalg.inv(jacobian.T @ jacobian),
        spread=spread_error(fit.errors, fit.noise, len(measurements.commands), is_known=noise is not None),
        mesh_shift=estimate_mesh_shift(*known) if refine else nothing[None],
        build_variance=estimate_build_variance(*known) if refine else nothing,
        noise=fit.noise,
        error=rms(fit.distances),
        num_failed=fit.num_failed,
        iterations=fit.count,
        message=message,
        force_noise=fit.force_noise,
    )


def spread_error(errors: Vector, noise: float, rows: int, *, is_known: bool) -> float:
    """Factor of the variance of errors by which errors of the model count more than independent noise.

    An error of the model is alike in all rows, so that more rows do not average it out: they count as one. Without a
    known noise, the whole residual is such an error, and the factor is the number of rows. With it, only the rest is.

    Args:
        errors: residuals [m].
        noise: standard deviation of a measured coordinate [m].
        rows: number of rows.
        is_known: True if the noise was given, not estimated from the residuals.
    """
    if not is_known:
        return float(max(rows, 1))
    excess = float(np.mean((errors / noise) ** 2)) - 1.0 if len(errors) else 0.0
    return 1.0 + rows * max(excess, 0.0)


def robust_scale(errors: Vector) -> float:
    """Standard deviation of errors of which a tenth may be wrong (Huber 1964, proposal 2).

    The largest s where mean(min(error^2, (clipped s)^2)) = mean_square s^2 (`FitRules`); 0 if 77 % or more are 0.
    With very large errors in a tenth it is 1.3 times too large, in a fifth 2.6 times; from 23 % on they alone decide.
    """
    squares = np.sort(errors**2)
    # of s^2, where these are clipped
    rest = RULES.mean_square * len(squares) - RULES.clipped**2 * np.arange(len(squares))[::-1]
    return float(np.sqrt(np.min(np.cumsum(squares)[rest > 0] / rest[rest > 0])))


class MarkerFit:
    """Residuals and their Jacobian for `least_squares`, in standard deviations."""

    def __init__(
        self,
        model: IdentificationModel,
        measurements: Measurements,
        noise: float,
        progress: Progress = no_progress,
    ) -> None:
        self._measurements, self._progress = measurements, progress
        self._predictor = MarkerPredictor(model, measurements)
        self._residuals: Residuals
        self._asked: np.ndarray | None = None
        self._last: Vector  # last known residual of each quantity
        largest = float(
            np.max(np.abs(measurements.known_forces), initial=0.0, where=~np.isnan(measurements.known_forces))
        )
        self._least_force = RULES.min_force_noise * largest
        self.noise, self.force_noise, self.count = noise, 5 * self._least_force or np.nan, 0

    def residuals(self, numbers: Vector) -> Vector:
        """Residuals of all that was measured, then of the guesses."""
        self._ask(numbers)
        return np.concatenate([self._errors / self._scales, numbers])

    def jacobian(self, numbers: Vector) -> np.ndarray:
        """Their Jacobian."""
        self._ask(numbers)
        return np.concatenate([self._residuals.jacobian / self._scales[:, None], np.eye(len(numbers))])

    @property
    def errors(self) -> Vector:
        """Predicted less measured coordinates and lengths of rows with an equilibrium [m]."""
        return self._residuals.errors[self._solved & ~self._residuals.is_force]

    @property
    def distances(self) -> Vector:
        """Distances of predicted from measured markers, and of lengths [m]."""
        return self._residuals.distances

    @property
    def num_failed(self) -> int:
        """Rows without an equilibrium."""
        return len(np.unique(self._residuals.rows[~self._solved]))

    @property
    def _scales(self) -> Vector:
        """Standard deviation of each residual."""
        return np.where(self._residuals.is_force, self.force_noise, self.noise)

    def estimate_noise(self, least: float) -> bool:
        """Take noises from the residuals, at least `least` [m]; False if they were about that already."""
        before, is_force = (self.noise, self.force_noise), self._residuals.is_force
        self.noise, self.force_noise = (
            self._noise_of(self._solved & ~is_force, least, before[0]),
            self._noise_of(self._solved & is_force, self._least_force, before[1]),
        )
        return not np.allclose(
            [self.noise, self.force_noise], before, rtol=RULES.noise_tolerance, atol=0.0, equal_nan=True
        )

    def _noise_of(self, chosen: np.ndarray, least: float, before: float) -> float:
        """Noise of some residuals, of which the parameters take up a share (MacKay 1992)."""
        if not chosen.any():
            return before
        scaled = self._residuals.jacobian / self._scales[:, None]
        information = scaled[self._solved].T @ scaled[self._solved] + np.eye(scaled.shape[1])
        taken = float(np.sum(scaled[chosen] * np.linalg.solve(information, scaled[chosen].T).T))
        free = max(1.0 - taken / int(chosen.sum()), RULES.min_free)
        return max(robust_scale(self._residuals.errors[chosen]) / free**0.5, least)

    def _ask(self, numbers: Vector) -> None:
        if self._asked is not None and (self._asked == numbers).all():
            return
        self._residuals, missing = self._predict(numbers)
        errors = self._residuals.errors
        if not self.count:
            self._last = np.zeros(len(errors))
        self._solved = np.isfinite(errors)
        self._errors = np.where(self._solved, errors, np.maximum(missing * self._scales, self._last))
        self._last = np.where(self._solved, np.abs(errors), self._last)
        self.count, self._asked = self.count + 1, numbers.copy()
        self._progress(f"evaluation {self.count}: {1e3 * rms(self.distances):.2f} mm off (RMS)", 0, 0)

    def _predict(self, numbers: Vector) -> tuple[Residuals, float]:
        """Residuals, and what each lacks; values that no robot can have are far off after the first."""
        try:
            found = self._predictor.predict(numbers, with_jacobian=True)
            return Residuals.of(found, self._measurements), RULES.missing
        except InputError:
            if not self.count:
                raise
        nothing = np.full(len(self._last), np.nan)
        return replace(
            self._residuals, errors=nothing, jacobian=np.zeros_like(self._residuals.jacobian)
        ), RULES.impossible


def check_fit(robot: Robot, measurements: Measurements) -> None:
    """Check that measurements have the winches, axes, markers and unit of a robot (InputError: others)."""
    winches, dim = len(robot.winches), robot.body.mesh.dim
    if measurements.commands.shape[1] != winches:
        raise InputError(f"commands have {measurements.commands.shape[1]} columns, but the robot has {winches} winches")
    if measurements.places.shape[2] != dim:
        raise InputError(f"places have {measurements.places.shape[2]} coordinates, but the body has {dim} axes")
    known = [marker.name for marker in robot.markers]
    for name in measurements.markers:
        if name not in known:
            raise InputError(f'no marker "{name}"; the robot has {", ".join(known) or "none"}')
    if not (np.isfinite(measurements.places).any() or np.isfinite(measurements.known_lengths).any()):
        raise InputError("no place of a marker and no distance of two markers was measured")
    forces = measurements.known_forces
    if np.isfinite(forces).any() and not np.any(forces[np.isfinite(forces)]):
        raise InputError("forces: every measured force is 0 N. Leave them out if no force was read.")
    _check_unit(robot, measurements)


def _check_unit(robot: Robot, measurements: Measurements) -> None:
    """Check that markers are about as far apart as on the robot at rest (InputError: a wrong unit)."""
    at = {marker.name: marker.at for marker in robot.markers}
    places = measurements.places[np.isfinite(measurements.places).all(axis=(1, 2))]
    if len(places) and len(measurements.markers) > 1:
        rest = np.array([at[name] for name in measurements.markers])
        seen, own = (float(np.std(each - each.mean(axis=-2, keepdims=True))) for each in (places, rest))
        if own > 0.02 * robot.body.mesh.size and not own < RULES.wrong_unit * seen < RULES.wrong_unit**2 * own:
            raise InputError(
                f"markers are {seen / MM:.3g} mm apart (standard deviation), on the robot {own / MM:.3g} mm. "
                "Write tables in mm, arrays in m."
            )
