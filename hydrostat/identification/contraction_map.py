"""`ContractionMap`: contractions that a model needs for those that are commanded, fitted to what it leaves over."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.identification.fit import FittedModel
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements, rms
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation

FILE = "correction.json"
"""Its file in a robot folder."""

BOUND = 0.2
"""Largest change of a contraction, as a share of the winch's travel."""

GAINED = 0.9
"""Share of the held-out error that must remain at most for a correction to be kept."""

FOLDS = 5
"""Parts of the rows, each of which is held out once."""

LEAST = 10
"""Rows from which on a correction is fitted."""

PENALTIES = tuple(10.0**power for power in range(-4, 3))
"""Penalties of the weights to choose from, as multiples of the mean square of the inputs."""

ROUNDS = 20
"""Steps of the inverse of a map."""

INEXACT = 1e-3
"""Largest error of the inverse, as a share of the travel."""

SAME = 5e-4
"""Difference of lengths below which travel and cables are those of the robot that was measured [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContractionMap:
    """Quadratic map from commanded contractions to those at which the model shows what the robot does.

    Attributes:
        winches: names of the winches.
        travel: travel of each [m].
        lengths: rest length of each cable of the robot that was measured [m].
        weights: change of each contraction, as a share of its travel, by `features` of all.
        before: root mean square distance of held-out markers without the map [m].
        after: the same with it [m].
    """

    winches: tuple[str, ...]
    travel: Vector
    lengths: Vector
    weights: Float[np.ndarray, "features winches"]
    before: float
    after: float

    def effective(self, commands: Float[np.ndarray, "... winches"]) -> Float[np.ndarray, "... winches"]:
        """Contractions of the model for commanded ones [m]."""
        change = np.clip(features(commands / self.travel) @ self.weights, -BOUND, BOUND)
        return commands + self.travel * change

    def command(self, contractions: Float[np.ndarray, "... winches"]) -> Float[np.ndarray, "... winches"]:
        """Contractions to command for those of the model [m], by fixed-point steps."""
        commands = contractions
        for _ in range(ROUNDS):
            commands = contractions - (self.effective(commands) - commands)
        return commands

    @property
    def is_invertible(self) -> bool:
        """True if `command` inverts `effective` within the travel, tried at 500 random contractions."""
        shares = np.random.default_rng(0).uniform(size=(500, len(self.travel)))
        missed = self.effective(self.command(shares * self.travel)) / self.travel - shares
        return bool(np.abs(missed).max(initial=0.0) < INEXACT)

    def text(self) -> bytes:
        """Text of its file."""
        told = {
            "about": "Correction of contractions by hydrostat identify.",
            "winches": list(self.winches),
            "travel_m": self.travel.tolist(),
            "cable_lengths_m": self.lengths.tolist(),
            "weights": self.weights.tolist(),
            "held_out_before_m": self.before,
            "held_out_after_m": self.after,
        }
        return (json.dumps(told, indent=1) + "\n").encode()

    @classmethod
    def read(cls, folder: Path, robot: Robot) -> "ContractionMap | None":
        """Map of a robot folder; None if it has none (InputError: a file that is no such map, or of other winches)."""
        file = folder / FILE
        if not file.exists():
            return None
        names = tuple(winch.name for winch in robot.winches)
        try:
            told = json.loads(read_stranger(file, most=1_000_000))
            winches, weights = tuple(told["winches"]), np.array(told["weights"], dtype=float)
            travel, lengths = (np.array(told[name], dtype=float) for name in ("travel_m", "cable_lengths_m"))
            errors = float(told["held_out_before_m"]), float(told["held_out_after_m"])
        except (ValueError, KeyError, TypeError, RecursionError):
            raise InputError(f"{file}: is no correction. Remove it, or run `hydrostat identify` again.") from None
        if winches != names:
            raise InputError(f"{file}: is for the winches {', '.join(map(str, winches))[:60]}. Remove it.")
        count = len(names)
        shape = (len(features(np.zeros(count))), count)
        if weights.shape != shape or travel.shape != (count,) or not np.isfinite([*weights.ravel(), *travel]).all():
            raise InputError(f"{file}: is no correction. Remove it, or run `hydrostat identify` again.")
        if not (travel > 0).all():
            raise InputError(f"{file}: travel_m must be above 0. Remove it, or run `hydrostat identify` again.")
        own = np.array([winch.travel for winch in robot.winches]), _cable_lengths(robot)
        for one, other in zip((travel, lengths), own, strict=True):
            if one.shape != other.shape or not (np.abs(one - other) < SAME).all():
                raise InputError(
                    f"{file}: is for other cables or travel. Remove it, or run `hydrostat identify` again."
                )
        found = cls(winches=winches, travel=travel, lengths=lengths, weights=weights, before=errors[0], after=errors[1])
        if not found.is_invertible:
            raise InputError(f"{file}: cannot be inverted. Remove it, or run `hydrostat identify` again.")
        return found


def _cable_lengths(robot: Robot) -> Vector:
    """Rest length of each cable [m]."""
    return np.array([cable.length for cable in robot.cables])


def features(shares: Float[np.ndarray, "... winches"]) -> Float[np.ndarray, "... features"]:
    """Contractions as shares of the travel, and their products."""
    one, other = np.triu_indices(shares.shape[-1])
    return np.concatenate([shares, shares[..., one] * shares[..., other]], axis=-1)


def fit_contraction_map(fitted: FittedModel, robot: Robot, measurements: Measurements) -> ContractionMap | None:
    """Fit a map to the errors that a fitted model leaves, by its exact slopes (ridge regression).

    The map is kept only if it predicts rows that it did not see with at most 90 % of the model's error. In each fold
    the penalty is chosen without the rows that are held out.

    Args:
        fitted: fitted model.
        robot: fitted robot.
        measurements: rows of commands and places.

    Returns:
        The map; None with fewer than ten rows, if it does not win, or if it cannot be inverted.
    """
    travel = np.array([winch.travel for winch in robot.winches])
    if len(measurements.commands) < LEAST or not len(travel) or not (travel > 0).all():
        return None
    values = fitted.values
    rest = fitted.model.contractions(values, np.zeros((1, len(travel))))
    commands = fitted.model.contractions(values, measurements.commands) - rest
    rows = _error_rows(fitted, measurements, features(commands / travel), travel)
    known = [row for row, (errors, _) in enumerate(rows) if len(errors)]
    if len(known) < LEAST:
        return None
    before, after = [], []
    for fold in range(FOLDS):
        seen = [row for place, row in enumerate(known) if place % FOLDS != fold]
        weights = _fit(rows, seen, _choose_penalty(rows, seen))
        for row in (row for place, row in enumerate(known) if place % FOLDS == fold):
            errors, slopes = rows[row]
            before.append(errors)
            after.append(errors + slopes @ weights)
    dim = measurements.places.shape[2]
    lengths = [rms(np.linalg.norm(np.concatenate(each).reshape(-1, dim), axis=1)) for each in (before, after)]
    if lengths[1] > GAINED * lengths[0]:
        return None
    weights = _fit(rows, known, _choose_penalty(rows, known)).reshape(-1, len(travel))
    names = tuple(winch.name for winch in robot.winches)
    found = ContractionMap(
        winches=names,
        travel=travel,
        lengths=_cable_lengths(robot),
        weights=weights,
        before=lengths[0],
        after=lengths[1],
    )
    return found if found.is_invertible else None


Rows = list[tuple[np.ndarray, np.ndarray]]
"""Errors of the measured markers of each row [m], and their slopes by all weights."""


def _error_rows(fitted: FittedModel, measurements: Measurements, inputs: np.ndarray, travel: Vector) -> Rows:
    """Predicted less measured coordinates, with the slopes of the markers by the weights of a map."""
    predictor = MarkerPredictor(fitted.model, measurements)
    places = predictor.predict(fitted.numbers, slopes=False).places
    step, rows = 1e-6, Rows()
    for row, pose in enumerate(predictor.poses):
        whole = np.isfinite(measurements.places[row]).all(axis=1)
        if pose is None or not whole.any() or not np.isfinite(places[row]).all():
            rows.append((np.zeros(0), np.zeros((0, inputs.shape[1] * len(travel)))))
            continue
        simulation = Simulation(pose.robot)
        order = [[marker.name for marker in pose.robot.markers].index(name) for name in measurements.markers]
        jacobian = simulation.marker_jacobian(pose)[order]
        at = np.array([pose.markers[name] for name in measurements.markers])
        turned = np.stack(
            [
                (fitted.model.places(fitted.values, at + step * column) - fitted.model.places(fitted.values, at)) / step
                for column in np.moveaxis(jacobian, 2, 0)
            ],
            axis=2,
        )
        by_weights = np.einsum("mdw,f->mdfw", turned * travel, inputs[row])[whole]
        errors = (places[row] - measurements.places[row])[whole]
        rows.append((errors.ravel(), by_weights.reshape(errors.size, -1)))
    return rows


def _fit(rows: Rows, chosen: list[int], penalty: float) -> Vector:
    """Weights with the least squares of errors and a penalty."""
    errors, slopes = (np.concatenate([rows[row][part] for row in chosen]) for part in (0, 1))
    size = penalty * float((slopes**2).sum()) / slopes.shape[1]
    return -np.linalg.solve(slopes.T @ slopes + max(size, 1e-30) * np.eye(slopes.shape[1]), slopes.T @ errors)


def _choose_penalty(rows: Rows, chosen: list[int]) -> float:
    """Penalty with the least error of rows that are left out in turn."""

    def left_out(penalty: float) -> float:
        total = 0.0
        for fold in range(FOLDS):
            weights = _fit(rows, [row for place, row in enumerate(chosen) if place % FOLDS != fold], penalty)
            for row in chosen[fold::FOLDS]:
                errors, slopes = rows[row]
                total += float(((errors + slopes @ weights) ** 2).sum())
        return total

    return min(PENALTIES, key=left_out)
