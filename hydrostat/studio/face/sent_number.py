"""`sent_number`: a number that a screen has sent."""

from typing import Any

LARGEST = 1e9
"""No number of a screen is larger."""


def sent_number(value: Any) -> float | None:
    """The number, or that of a text which a person is typing; None if it is none yet."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if -LARGEST <= number <= LARGEST else None
