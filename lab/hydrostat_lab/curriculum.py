"""`Curriculum`: how the tolerance of a success goes on as a policy gets better."""

from enum import StrEnum

import numpy as np

MASTERED = 0.9
"""Share of successes at which a tolerance is mastered (R83)."""


class Curriculum(StrEnum):
    """Change of the tolerance once it is mastered (thesis 5.4.2 and 5.4.3)."""

    FIXED = "fixed"
    HALVE = "halve"  # a
    TENTH = "less a tenth"  # b
    CURRENT = "current error"  # proposed, not done (F10)

    def next(self, tolerance: np.ndarray, success: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Tolerances of the next epoch, of those of this one, shares of successes and mean distances."""
        smaller = {
            Curriculum.FIXED: tolerance,
            Curriculum.HALVE: 0.5 * tolerance,
            Curriculum.TENTH: 0.9 * tolerance,
            Curriculum.CURRENT: np.minimum(tolerance, distance),
        }[self]
        return np.where(success >= MASTERED, smaller, tolerance)
