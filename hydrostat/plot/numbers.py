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


def millimetres(error: float) -> str:
    """An error [m] in millimetres: to a hundredth, below a tenth of a millimetre to two digits."""
    value = MILLIMETRES * error
    return f"{value:.2f}" if value >= 0.1 or value == 0 else f"{value:.2g}"
