"""`sent_number`: a number that a screen has sent."""

from typing import Any

LARGEST = 1e9
"""No number of a screen is larger."""


def sent_number(value: Any) -> float | None:
    """The number; None if it is none, which no screen of ours sends."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if -LARGEST <= value <= LARGEST else None
