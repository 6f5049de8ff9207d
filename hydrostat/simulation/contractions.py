"""`Contractions`: cable taken in, as it may be given."""

from collections.abc import Mapping

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Robot

Contractions = Mapping[str, float] | Vector
"""Cable taken in [m]: by the name of a winch (others 0), or an array in winch order."""


def contraction_values(robot: Robot, given: Contractions) -> Vector:
    """Contractions as an array in winch order [m].

    Raises:
        InputError: an unknown winch, a wrong number of values, or a value that is not finite.
    """
    winches = robot.winches
    if isinstance(given, Mapping):
        for name in given:
            robot.winch(name)
        given = np.array([given.get(winch.name, 0.0) for winch in winches], dtype=object)
    try:
        values = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"contractions must be numbers [m], not {given!r}") from None
    if values.shape != (len(winches),):
        raise InputError(f"{values.size} contractions given for {len(winches)} winches")
    if not np.isfinite(values).all():
        raise InputError("a contraction is not a finite number")
    return values
