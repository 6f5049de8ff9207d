"""`find_swaps`, `find_slip` and `is_mirrored`: faults in the measurements of a fit."""

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from hydrostat.arrays import Float
from hydrostat.identification.fit import FittedModel
from hydrostat.identification.marker_predictor import MarkerPredictor, winch_ratios
from hydrostat.identification.measurements import Measurements
from hydrostat.identification.residuals import Residuals
from hydrostat.units import MM

CLEARER = 0.25
"""Share of the distances that must remain at most if two markers are exchanged, or all are mirrored."""

EXPLAINED = 0.6
"""Share of the squared residuals that one slip must explain."""

MIN_SHIFT = 0.01
"""Least distance of swapped markers, and least slip, over the size of the body."""


@dataclass(frozen=True, kw_only=True)
class Swap:
    """Two markers whose places were exchanged.

    Attributes:
        markers: their names.
        rows: rows in which they were, from 0.
    """

    markers: tuple[str, str]
    rows: tuple[int, ...]


@dataclass(frozen=True, kw_only=True)
class Slip:
    """A winch that lost or took up cable between two rows.

    Attributes:
        winch: its name.
        row: first row after it, from 0.
        length: cable that it lost [m]; below 0 if it took up more than it was asked for.
    """

    winch: str
    row: int
    length: float


def find_swaps(fitted: FittedModel, assumed: FittedModel, measurements: Measurements) -> list[Swap]:
    """Pairs of markers that stand much nearer to each other's prediction than to their own.

    A pair that is swapped in all rows leads the fit astray, so that predictions of the assumed robot count as well.
    """
    size = fitted.model.robot(fitted.values).body.mesh.size
    found = []
    predicted = [each.predict(measurements) for each in (fitted, assumed)]
    for one, other in combinations(range(len(measurements.markers)), 2):
        seen = measurements.places[:, [one, other]]
        swapped = np.zeros(len(seen), dtype=bool)
        for places in predicted:
            straight = np.linalg.norm(places[:, [one, other]] - seen, axis=2).max(axis=1)
            crossed = np.linalg.norm(places[:, [other, one]] - seen, axis=2).max(axis=1)
            swapped |= (crossed < CLEARER * straight) & (straight > MIN_SHIFT * size)
        if swapped.any():
            names = measurements.markers[one], measurements.markers[other]
            found.append(Swap(markers=names, rows=tuple(np.flatnonzero(swapped).tolist())))
    return found


def is_mirrored(assumed: FittedModel, measurements: Measurements) -> bool:
    """Check whether a mirror image of the measured positions fits the assumed robot much better than they do.

    Both are moved and rotated to fit best (Kabsch 1976). Positions in one plane of space have no such mirror image.
    """
    predicted = assumed.predict(measurements)
    known = np.isfinite(measurements.places).all(axis=2) & np.isfinite(predicted).all(axis=2)
    if known.sum() <= predicted.shape[2]:
        return False
    one, other = (places[known] - places[known].mean(axis=0) for places in (predicted, measurements.places))
    left, singular, right = np.linalg.svd(one.T @ other)
    last = float(np.sign(np.linalg.det(left @ right)) * singular[-1])
    total = float((one**2).sum() + (other**2).sum() - 2 * singular[:-1].sum())
    straight, mirrored = (np.sqrt(max(total - 2 * end, 0.0) / len(one)) for end in (last, -last))
    size = assumed.model.robot(assumed.values).body.mesh.size
    return bool(mirrored < CLEARER * straight and straight > MIN_SHIFT * size)


def find_slip(fitted: FittedModel, measurements: Measurements) -> Slip | None:
    """Slip of one winch before one row that explains most of the residuals; None if none does.

    All values are fitted again with it, to first order. At least two rows are on each side.
    """
    robot, count = fitted.model.robot(fitted.values), len(measurements.commands)
    ratios = winch_ratios(robot)
    predictor = MarkerPredictor(fitted.model, measurements, deviations={"slack": MM})
    residuals = Residuals.of(predictor.predict(fitted.numbers, with_jacobian=True), measurements)
    known = np.isfinite(residuals.errors)
    scales = np.where(residuals.is_force, fitted.force_noise, fitted.noise)[known]
    jacobian = residuals.jacobian[known] / scales[:, None]
    own = len(fitted.numbers)
    if jacobian.shape[1] != own + len(robot.cables):  # slack is fitted
        return None
    prior = np.zeros((own, len(ratios)))
    base = np.linalg.qr(np.concatenate([jacobian[:, :own], np.eye(own)]))[0]
    errors = _without(base, np.concatenate([residuals.errors[known] / scales, fitted.numbers]))
    best, found = EXPLAINED * float(errors @ errors), None
    effects = jacobian[:, own:] @ ratios.T
    is_tight = (measurements.commands > 0)[residuals.rows[known]]  # lost cable only loosens others further
    for row, moved in product(range(2, count - 1), (np.ones_like(is_tight), is_tight)):
        after = effects * moved * (residuals.rows[known] >= row)[:, None]
        changed = _without(base, np.concatenate([after, prior]))
        squares = np.maximum((changed**2).sum(axis=0), np.finfo(float).tiny)
        along = errors @ changed
        winch = int(np.argmax(along**2 / squares)) if len(ratios) else 0
        length = -MM * float(along[winch] / squares[winch]) if len(ratios) else 0.0
        if len(ratios) and along[winch] ** 2 / squares[winch] > best and abs(length) > MIN_SHIFT * robot.body.mesh.size:
            best = float(along[winch] ** 2 / squares[winch])
            found = Slip(winch=robot.winches[winch].name, row=row, length=length)
    return found


def _without(base: Float[np.ndarray, "rows basis"], columns: np.ndarray) -> np.ndarray:
    """Columns less their parts in an orthonormal basis."""
    return columns - base @ (base.T @ columns)
