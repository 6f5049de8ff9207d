"""`Measurements`: commands of the winches and the places of markers that were measured."""

from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Bool, Float
from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurements:
    """Rows of measurements of a built robot.

    Attributes:
        commands: contraction asked of each winch [m], (rows, winches).
        markers: names of the measured markers.
        places: measured places [m], (rows, markers, dim), in any fixed frame; NaN where a marker was not seen.
        masses: mass hung at each marker [kg], (rows, markers); none if left out.

    Raises:
        InputError: arrays that do not fit one another, or numbers that are not finite.
    """

    commands: Float[np.ndarray, "rows winches"]
    markers: tuple[str, ...]
    places: Float[np.ndarray, "rows markers dim"]
    masses: Float[np.ndarray, "rows markers"] | None = None

    def __post_init__(self) -> None:
        if self.commands.ndim != 2 or not np.isfinite(self.commands).all():
            raise InputError("commands must be finite contractions [m], a row for each pose, a column for each winch")
        if self.places.ndim != 3 or self.places.shape[:2] != (len(self.commands), len(self.markers)):
            raise InputError(
                f"places must have the shape (rows, markers, axes), here ({len(self.commands)}, {len(self.markers)}, "
                f"...), not {self.places.shape}"
            )

        masses = self.masses
        if masses is not None and not (masses.shape == self.places.shape[:2] and (masses >= 0).all()):
            raise InputError("masses must be 0 or more [kg], a row for each pose, a column for each marker")

    @property
    def hung_masses(self) -> Float[np.ndarray, "rows markers"]:
        """Mass hung at each marker [kg]."""
        return np.zeros(self.places.shape[:2]) if self.masses is None else self.masses

    def is_measured(self, row: int) -> Bool[np.ndarray, " markers"]:
        """Markers of which a coordinate is known in a row."""
        return np.isfinite(self.places[row]).any(axis=1)

    def rows(self, chosen: np.ndarray) -> "Measurements":
        """Some of the rows, by index or mask."""
        masses = None if self.masses is None else self.masses[chosen]
        return replace(self, commands=self.commands[chosen], places=self.places[chosen], masses=masses)


def rms(distances: np.ndarray) -> float:
    """Root mean square of the known distances; NaN if there are none."""
    known = distances[np.isfinite(distances)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")
