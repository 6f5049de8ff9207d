"""`check_columns`: units, axes and order of measurements, before a fit to them."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, permutations, product

import numpy as np
from scipy.optimize import linear_sum_assignment

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.identification.fit import FittedModel
from hydrostat.identification.measurements import Measurements
from hydrostat.robot import Robot
from hydrostat.units import MM

FAR = 0.02
"""RMS distance of markers from the assumed robot, over the size of the body, from which on columns are checked."""

CLEARER = 0.35
"""Share of this distance that may remain after a change of columns, for the columns to count as wrong."""

WORST_ROWS = 6
"""Rows farthest from the assumed robot: those in which a change of the contractions is tried first."""

UNITS = {10: "cm", 1000: "m"}
"""Units that contractions may be written in by mistake, by their size in mm."""

LEVELS = (0.15, 0.3, 0.45, 0.6, 0.8, 1.0)
"""Contractions tried for a winch without any, over its travel."""


def check_columns(
    assumed: FittedModel, measurements: Measurements, predicted: Float[np.ndarray, "rows markers dim"]
) -> None:
    """Check that no simple change of units, axes or order makes measurements fit the assumed robot far better.

    Args:
        assumed: robot as it is assumed to be built.
        measurements: rows of contractions and positions.
        predicted: positions that the assumed robot predicts for them [m].

    Raises:
        InputError: axes exchanged or reversed; two markers exchanged in all rows; positions in other rows than their
            contractions; contractions in cm or m, of two winches exchanged, or of a winch left out.
    """
    robot = assumed.model.robot(assumed.values)
    apart = _distances(predicted, measurements.places)
    if not _rms(apart) > FAR * robot.body.mesh.size:
        return
    rotates = any(name.startswith("frame.about") for name in assumed.values)
    _check_axes(predicted, measurements, _rms(apart), rotates=rotates)
    _check_idle(robot, measurements, predicted)
    worst = np.sort(np.argsort(-np.nansum(apart**2, axis=1))[:WORST_ROWS])
    for commands, message in _changed_commands(robot, measurements):
        if all(_fits(assumed, measurements, commands, apart, rows) for rows in (worst, np.arange(len(apart)))):
            raise InputError(message)
    _check_rows(predicted, measurements.places, _rms(apart))
    _check_left_out(assumed, measurements, apart, worst[~measurements.hung_masses[worst].any(axis=1)])


def _distances(predicted: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Distance of each marker, (rows, markers), after a common shift; NaN if unknown."""
    away = predicted - places
    known = np.isfinite(away).all(axis=2)
    return np.linalg.norm(away - (away[known].mean(axis=0) if known.any() else 0.0), axis=2)


def _rms(distances: np.ndarray) -> float:
    known = distances[np.isfinite(distances)]
    return float(np.sqrt((known**2).mean())) if len(known) else 0.0


def _check_axes(predicted: np.ndarray, measurements: Measurements, before: float, *, rotates: bool) -> None:
    """Check the order and signs of the axes, and the order of the markers: on a symmetric body both may fit.

    Axes that a rotation explains pass if the fit finds rotations (`rotates`).
    """
    places, names = measurements.places, measurements.markers
    axes = "xyz"[: places.shape[2]]
    exchanges = []
    for one, other in combinations(range(len(names)), 2):
        order = np.arange(len(names))
        order[[one, other]] = other, one
        exchanges.append((_rms(_distances(predicted, places[:, order])), names[one], names[other]))
    tried = [
        (_rms(_distances(predicted, places[..., list(order)] * signs)), order, signs)
        for order in permutations(range(len(axes)))
        for signs in product((1, -1), repeat=len(axes))
    ]
    least, order, signs = min(tried)
    swapped, *pair = min(exchanges, default=(np.inf,))
    if swapped < min(least, CLEARER * before):
        raise InputError(f"positions: those of {' and '.join(pair)} are exchanged. Exchange their columns.")
    is_turn = np.linalg.det(np.eye(len(axes))[list(order)] * signs) > 0
    if least < CLEARER * before and not (rotates and is_turn):
        changes = [
            f"{axis} by {'-' * (sign < 0)}{axes[other]}"
            for axis, other, sign in zip(axes, order, signs, strict=True)
            if axes[other] != axis or sign < 0
        ]
        raise InputError(
            f"positions: axes differ from those of the robot, whose y points up. Replace {' and '.join(changes)} in "
            f"all markers{', or add frame to --fit' if is_turn else ''}."
        )


def _check_rows(predicted: np.ndarray, places: np.ndarray, before: float) -> None:
    """Check that positions stand in the rows of their contractions."""
    apart = predicted[:, None] - places[None]
    known = np.isfinite(apart).all(axis=3)
    if not known.all():
        return
    squares = (apart**2).sum(axis=(2, 3))
    found = linear_sum_assignment(squares)[1]
    if _rms(_distances(predicted, places[found])) < CLEARER * before:
        row = int(np.flatnonzero(found != np.arange(len(found)))[0])
        raise InputError(
            f"positions: contractions of row {row + 1} fit the positions of row {found[row] + 1}. Write both of a pose "
            "in one row."
        )


def _check_idle(robot: Robot, measurements: Measurements, predicted: np.ndarray) -> None:
    """Check that a winch contracts, if markers move without another reason."""
    away = np.where(np.any(measurements.hung_masses, axis=1)[:, None, None], np.nan, measurements.places - predicted)
    if measurements.commands.any() or not robot.winches or not np.isfinite(away).any():
        return
    seen = np.any(np.isfinite(away).all(axis=2), axis=0)  # markers
    away[:, seen] -= np.nanmedian(away[:, seen], axis=0)
    moved = np.nan_to_num(np.linalg.norm(away, axis=2))
    row, marker = np.unravel_index(int(np.argmax(moved)), moved.shape)
    if moved[row, marker] < FAR * robot.body.mesh.size:
        return
    columns = ", ".join(f"{winch.name}_mm" for winch in robot.winches)
    raise InputError(
        f"contractions: all 0, but {measurements.markers[marker]} moves by {moved[row, marker] / MM:.0f} mm (row "
        f"{row + 1}). Add the columns {columns}."
    )


def _changed_commands(robot: Robot, measurements: Measurements) -> Iterator[tuple[np.ndarray, str]]:
    """Contractions with other units or order, within the travel of the winches, and the message if they fit."""
    commands, names = measurements.commands, [winch.name for winch in robot.winches]
    travel = np.array([winch.travel for winch in robot.winches])
    is_used = np.any(commands, axis=0)
    used = np.flatnonzero(is_used).tolist()
    for factor, unit in UNITS.items():
        for chosen in dict.fromkeys([tuple(used), *((winch,) for winch in used)]):
            changed = commands.copy()
            changed[:, list(chosen)] *= factor
            if (np.abs(changed) <= 1.2 * travel).all():
                yield (
                    changed,
                    f"contractions of {', '.join(names[winch] for winch in chosen)}: markers move {factor} times as "
                    f"far, as if written in {unit}. Write tables in mm, arrays in m.",
                )
    for one, other in combinations(range(len(names)), 2):
        changed = commands.copy()
        changed[:, [one, other]] = changed[:, [other, one]]
        if (is_used[one] or is_used[other]) and (np.abs(changed) <= 1.2 * travel).all():
            yield (
                changed,
                f"contractions of {names[one]} and {names[other]}: markers move as if these were exchanged. Exchange "
                "their columns.",
            )


def _fits(
    assumed: FittedModel, measurements: Measurements, commands: np.ndarray, apart: np.ndarray, rows: np.ndarray
) -> bool:
    """Check whether other contractions bring the markers of some rows far nearer."""
    changed = replace(measurements, commands=commands).rows(rows)
    predicted = assumed.predict(changed)
    if measurements.in_order:
        predicted = predicted[rows]
    found = _distances(predicted, measurements.places[rows])
    known = np.isfinite(apart[rows])
    return bool(np.isfinite(found[known]).all() and _rms(found) < CLEARER * _rms(apart[rows]))


def _check_left_out(assumed: FittedModel, measurements: Measurements, apart: np.ndarray, rows: np.ndarray) -> None:
    """Check that a winch without contractions has none in the rows farthest from the assumed robot."""
    robot = assumed.model.robot(assumed.values)
    for index, winch in enumerate(robot.winches):
        if measurements.commands[:, index].any() or measurements.in_order or len(measurements.markers) < 2:
            continue
        best = apart[rows]
        pulls = np.zeros(len(rows))
        for level in LEVELS:
            commands = measurements.commands.copy()
            commands[:, index] = level * winch.travel
            predicted = assumed.predict(replace(measurements, commands=commands).rows(rows))
            found = np.linalg.norm(predicted - measurements.places[rows], axis=2)
            nearer = np.nansum(found**2, axis=1) < np.nansum(best**2, axis=1)
            nearer &= np.isfinite(found).any(axis=1)
            best, pulls = np.where(nearer[:, None], found, best), np.where(nearer, level * winch.travel, pulls)
        if pulls.any() and _rms(best) < CLEARER * _rms(apart[rows]):
            row = int(np.argmax(pulls))
            raise InputError(
                f"contractions of {winch.name}: all 0, but markers move as if it contracts by {pulls[row] / MM:.0f} mm "
                f"(row {rows[row] + 1}). Add its column {winch.name}_mm."
            )
