"""`Measurements`: commands of the winches, and the places, lengths and forces that were measured."""

from dataclasses import dataclass, replace

import numpy as np

from hydrostat.arrays import Bool, Float
from hydrostat.errors import InputError
from hydrostat.result_table import Columns, Tabular, marker_columns, named_columns


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurements(Tabular):
    """Measurements of a built robot, in rows.

    Attributes:
        commands: commanded contraction of each winch [m], (rows, winches).
        markers: names of the measured markers.
        places: measured positions [m], (rows, markers, dim), in any fixed frame; NaN for a marker that was not visible.
        masses: mass hung at each marker [kg], (rows, markers); none if left out.
        pairs: pairs of markers, by index in `markers`, with measured distances.
        lengths: these distances [m], (rows, pairs); NaN if not measured, none if left out.
        forces: pull of each winch [N], (rows, winches): torque divided by spool radius; NaN if not measured, none if
            left out.
        in_order: True if the rows are one loading path, in order, each starting where the previous one ended. Matters
            for path-dependent robots: friction of cables, hysteresis of materials.

    Raises:
        InputError: arrays that do not fit each other, or values that are not finite.
    """

    commands: Float[np.ndarray, "rows winches"]
    markers: tuple[str, ...]
    places: Float[np.ndarray, "rows markers dim"]
    masses: Float[np.ndarray, "rows markers"] | None = None
    pairs: tuple[tuple[int, int], ...] = ()
    lengths: Float[np.ndarray, "rows pairs"] | None = None
    forces: Float[np.ndarray, "rows winches"] | None = None
    in_order: bool = False

    def columns(self) -> Columns:
        """Return a table of winch commands and measured positions, one row for each pose."""
        names = [str(number) for number in range(1, 1 + self.commands.shape[1])]
        columns = named_columns("command", names, self.commands, "m")
        return columns | marker_columns({name: self.places[:, at] for at, name in enumerate(self.markers)})

    def __repr__(self) -> str:
        """Return a one-line summary."""
        rows, winches = self.commands.shape
        return f"<Measurements: {rows} poses, {winches} winches, {len(self.markers)} markers>"

    def __post_init__(self) -> None:
        if self.commands.ndim != 2 or not np.isfinite(self.commands).all():
            raise InputError("commands must be finite contractions [m], a row for each pose, a column for each winch")
        if self.places.ndim != 3 or self.places.shape[:2] != (len(self.commands), len(self.markers)):
            raise InputError(
                f"places must have the shape (rows, markers, axes), here ({len(self.commands)}, {len(self.markers)}, "
                f"...), not {self.places.shape}"
            )
        for name, value, columns in (
            ("lengths", self.lengths, len(self.pairs)),
            ("forces", self.forces, self.commands.shape[1]),
        ):
            if value is not None and value.shape != (len(self.commands), columns):
                raise InputError(f"{name} must have the shape ({len(self.commands)}, {columns}), not {value.shape}")
        for pair in self.pairs:
            if len({*pair} & {*range(len(self.markers))}) != 2:
                raise InputError(f"pairs must name two of the {len(self.markers)} markers by number from 0, not {pair}")
        for name in ("places", "lengths", "forces"):
            if np.isinf(getattr(self, name) if getattr(self, name) is not None else 0.0).any():
                raise InputError(f"{name} must be finite, or NaN where nothing was measured, not inf")
        masses = self.masses
        if masses is not None and not (
            masses.shape == self.places.shape[:2] and (masses >= 0).all() and np.isfinite(masses).all()
        ):
            raise InputError("masses must be 0 or more [kg], a row for each pose, a column for each marker")

    @property
    def hung_masses(self) -> Float[np.ndarray, "rows markers"]:
        """Mass hung at each marker [kg]."""
        return np.zeros(self.places.shape[:2]) if self.masses is None else self.masses

    @property
    def known_lengths(self) -> Float[np.ndarray, "rows pairs"]:
        """Measured distances of the pairs [m]."""
        return np.full((len(self.commands), len(self.pairs)), np.nan) if self.lengths is None else self.lengths

    @property
    def known_forces(self) -> Float[np.ndarray, "rows winches"]:
        """Measured forces of the winches [N]."""
        return np.full(self.commands.shape, np.nan) if self.forces is None else self.forces

    def is_measured(self, row: int) -> Bool[np.ndarray, " markers"]:
        """Return the markers with a measured coordinate or distance in a row."""
        known = np.isfinite(self.places[row]).any(axis=1)
        for pair, length in zip(self.pairs, self.known_lengths[row], strict=True):
            known[list(pair)] |= bool(np.isfinite(length))
        return known

    def rows(self, chosen: np.ndarray) -> "Measurements":
        """Return selected rows, by index or mask; for a loading path, all commands with only these measurements."""
        if self.in_order:
            left = np.ones(len(self.commands), dtype=bool)
            left[chosen] = False
            return replace(
                self,
                places=np.where(left[:, None, None], np.nan, self.places),
                lengths=None if self.lengths is None else np.where(left[:, None], np.nan, self.lengths),
                forces=None if self.forces is None else np.where(left[:, None], np.nan, self.forces),
            )
        kept = {
            name: value[chosen]
            for name in ("commands", "places", "masses", "lengths", "forces")
            if (value := getattr(self, name)) is not None
        }
        return replace(self, **kept)


def rms(distances: np.ndarray) -> float:
    """Root mean square of the known distances; NaN if there are none."""
    known = distances[np.isfinite(distances)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")
