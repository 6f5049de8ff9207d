"""Controls of a robot: contractions of its winches, then values of its drives."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.given import check_type, list_choices
from hydrostat.robot import PinDrive, Robot
from hydrostat.units import plural

Contractions = Mapping[str, float] | Sequence[float] | Vector
"""Cable taken in [m] and values of drives [rad or m]: by name (others 0), or numbers of winches, then of drives."""


def split_controls(robot: Robot, controls: Vector) -> dict[str, Vector]:
    """Contractions and values of the drives, as fields of an `Equilibrium`."""
    count = len(robot.winches)
    return (
        {"contractions": controls[:count], "drives": controls[count:]} if robot.drives else {"contractions": controls}
    )


def contraction_values(robot: Robot, given: Contractions) -> Vector:
    """Contractions as an array in winch order [m], then the values of the drives [rad or m].

    Raises:
        InputError: an unknown winch or drive, a wrong number of values, or a value that is not finite.
    """
    winches, wanted = (*robot.winches, *robot.drives), given
    if isinstance(given, Mapping):
        known = [part.name for part in winches]
        if unknown := [name for name in given if name not in known]:
            kind, kinds = ("winch or drive", "winches or drives") if robot.drives else ("winch", "winches")
            raise InputError(f'unknown {kind} "{unknown[0]}". {list_choices(kinds, known, unknown[0])}')
        wanted = np.array([given.get(winch.name, 0.0) for winch in winches], dtype=object)
    try:
        kinds = np.array(wanted, dtype=object).ravel()
        values = np.array(wanted, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"contractions must be numbers [m], not {given!r}") from None
    if any(isinstance(kind, bool | np.bool_ | str) for kind in kinds):
        raise InputError(f"contractions must be numbers [m], not {given!r:.60}")
    if values.ndim > 1:
        raise InputError(
            f"contractions must be one number for each of {len(winches)} winches, not an array of {values.shape}; "
            "solve_batch takes a row for each pose"
        )
    names = ", ".join(winch.name for winch in winches)
    if values.ndim == 0:
        raise InputError(f"contractions must be given by winch, or a number for each of {names}, not {given!r:.60}")
    if robot.drives and values.shape == (len(robot.winches),):
        values = np.append(values, np.zeros(len(robot.drives)))
    if values.shape != (len(winches),):
        raise InputError(f"{values.size} contractions given for {plural(len(winches), 'winch')}: {names}")
    if not np.isfinite(values).all():
        raise InputError("a contraction is not a finite number")
    _check_meters(robot, values[: len(robot.winches)])
    PinDrive.check_radians(robot.drives, values[len(robot.winches) :])
    return values


def contraction_rows(robot: Robot, given: Iterable[Contractions]) -> Float[np.ndarray, "poses controls"]:
    """Contractions as in `contraction_values`, a row for each pose.

    Raises:
        InputError: no rows, or as there, with the row.
    """
    check_type(given, Iterable, "contractions must be a row for each pose")
    rows = []
    for number, row in enumerate(given):
        try:
            rows.append(contraction_values(robot, row))
        except InputError as error:
            raise InputError(f"contractions[{number}]: {error}") from None
    return np.array(rows).reshape(len(rows), robot.num_controls)


def _check_meters(robot: Robot, contractions: Vector) -> None:
    """Reject contractions that no winch can reach, such as values in millimeters."""
    size = robot.body.mesh.size
    most = 3.0  # A winch moves at most so many lengths of body and cable together
    if np.abs(contractions).max(initial=0.0) <= most * size:  # no winch has a lower limit
        return
    bare = {winch.name: 0.0 for winch in robot.winches}
    for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True):
        bare[cable.winch] = max(bare[cable.winch], cable.length / abs(float(ratio)))
    for winch, value in zip(robot.winches, contractions, strict=True):
        if abs(value) > most * (size + bare[winch.name]):
            raise InputError(
                f'the contraction of winch "{winch.name}", {value:g} m, is far more than the body, {size:.3g} m, and '
                "all of its cable; contractions are in meters: 12 mm is 0.012"
            )
