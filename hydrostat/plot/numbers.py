"""Numbers as the report writes them: in millimetres, with a true minus sign."""

import numpy as np

from hydrostat.plot.sheet import MILLIMETRES


def place(point: object) -> str:
    """Coordinates [m] in millimetres."""
    return ", ".join(number(MILLIMETRES * float(value), 1) for value in np.asarray(point))


def number(value: float, digits: int) -> str:
    """A number with so many digits after the point."""
    text = f"{value:.{digits}f}"
    text = text.lstrip("-") if float(text) == 0 else text
    return text.replace("-", "\N{MINUS SIGN}")
