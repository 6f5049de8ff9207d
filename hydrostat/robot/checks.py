"""What the records check of their numbers; each complaint begins with the name of its field, which the reader seeks."""

import math

from hydrostat.errors import InputError
from hydrostat.robot.point import Point


def check_positive(field: str, value: float, unit: str) -> None:
    """Refuse what is not finite and above 0."""
    if not 0 < value < math.inf:
        raise InputError(f"{field} must be finite and above 0, not {value:g} {unit}")


def check_not_negative(field: str, value: float, unit: str) -> None:
    """Refuse what is not finite or is below 0."""
    if not 0 <= value < math.inf:
        raise InputError(f"{field} must be finite and not negative, not {value:g} {unit}")


def check_point(field: str, point: Point) -> None:
    """Refuse what is no place in the plane or in space."""
    try:
        count, finite = len(point), all(map(math.isfinite, point))
    except TypeError:
        raise InputError(f"{field} must be two or three coordinates [m], not {point!r:.60}") from None
    if count not in (2, 3):
        raise InputError(f"{field} has {count} coordinates; a point has two, or three in space")
    if not finite:
        raise InputError(f"{field} must have finite coordinates, not {[float(value) for value in point]}")
