"""`draw_sobol`: scrambled Sobol points, equal to SciPy's, without the import of scipy.stats."""

from pathlib import Path

import numpy as np


def draw_sobol(size: int, count: int, random: np.random.Generator, *, first: int = 0) -> np.ndarray:
    """Draw scrambled Sobol points in the unit cube, (count, size).

    They equal those of `scipy.stats.qmc.Sobol`, which imports for 0.6 s: Joe and Kuo's direction numbers, a random
    linear scramble of their bits (Matousek 1998) and a random shift.

    Args:
        size: dimensions.
        count: number of points.
        random: source of the scramble; equal ones give equal sequences.
        first: number of the first point in the sequence.
    """
    known = _read_directions()
    if known is None or size > len(known[0]):
        from scipy.stats.qmc import Sobol

        points = Sobol(size, rng=random)
        balanced = 1 << (count - 1).bit_length()  # points that SciPy draws without a warning
        return (points.fast_forward(first) if first else points).random(balanced)[:count]
    own = random.spawn(1)[0]
    powers = 2 ** np.arange(_BITS, dtype=np.uint32)
    shift = own.integers(2, size=(size, _BITS), dtype=np.uint32) @ powers
    scramble = np.tril(own.integers(2, size=(size, _BITS, _BITS), dtype=np.uint32), -1) + np.eye(_BITS, dtype=np.uint32)
    bits = _directions(size, *known)[:, :, None] // powers[::-1] % 2
    directions = np.einsum("dpk,djk->djp", scramble, bits) % 2 @ powers[::-1]
    numbers = np.arange(first, first + count)
    gray = (numbers ^ (numbers >> 1))[:, None] >> np.arange(_BITS) & 1
    points = np.repeat(shift[None], count, axis=0)
    for bit in range(_BITS):
        points ^= np.where(gray[:, bit, None], directions[:, bit], np.uint32(0)).astype(np.uint32)
    return points * 2.0**-_BITS


def _directions(size: int, polynomials: list[int], starts: list[list[int]]) -> np.ndarray:
    """Direction numbers before the scramble, (size, bits), by the recurrence of Bratley and Fox (1988)."""
    table = np.zeros((size, _BITS), np.uint32)
    for dimension in range(size):
        polynomial = polynomials[dimension]
        degree = polynomial.bit_length() - 1
        row = [1] * _BITS if dimension == 0 else starts[dimension][:degree]
        for place in range(len(row), _BITS):
            new = row[place - degree]
            for term in range(1, degree + 1):
                if polynomial >> (degree - term) & 1:
                    new ^= row[place - term] << term
            row.append(new)
        table[dimension] = [number << (_BITS - 1 - place) for place, number in enumerate(row[:_BITS])]
    return table


def _read_directions() -> tuple[list[int], list[list[int]]] | None:
    """Read primitive polynomials and first direction numbers from SciPy's file; None where it is not there."""
    import scipy

    file = Path(str(scipy.__file__)).with_name("stats") / "_sobol_direction_numbers.npz"
    try:
        with np.load(file) as stored:
            return tuple(stored[name][:_MAX_DIMENSIONS].tolist() for name in ("poly", "vinit"))
    except (OSError, KeyError, ValueError):
        return None


_BITS = 30
"""Bits of a coordinate, as in SciPy."""

_MAX_DIMENSIONS = 1000
"""Dimensions that are read."""
