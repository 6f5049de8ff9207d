"""`read_measurements`: contractions and measured places of markers from a table."""

import csv
import math
from collections.abc import Sequence
from io import StringIO
from itertools import permutations
from pathlib import Path

import numpy as np

from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.identification.measurements import Measurements
from hydrostat.robot import Robot
from hydrostat.units import MM

MAX_BYTES = 20_000_000
"""Bytes that a table may have."""


def read_measurements(file: str | Path, robot: Robot) -> Measurements:
    """Read measurements from a CSV file.

    Columns: `left_mm`, the contraction of winch `left`; `tip_x_mm`, `tip_y_mm` (and `tip_z_mm`), the position of marker
    `tip`; `tip_load_g`, a mass hung at this marker; `tip_to_root_mm`, the distance between two markers, by ruler;
    `left_force_n`, the pull of winch `left`. A winch without a column does not contract. An empty cell means that the
    quantity was not measured. Columns `time_s`, `pose` and `row` are skipped.

    Raises:
        InputError: a file that cannot be read, or a column or value that does not fit; names file and line.
    """
    path = Path(file)
    try:
        rows = list(csv.reader(StringIO(read_stranger(path, most=MAX_BYTES).decode("utf-8-sig"), newline="")))
    except (UnicodeDecodeError, csv.Error):
        raise InputError(f"{path}: cannot be read as a table; save it as CSV in UTF-8") from None
    if len(rows) < 2:
        raise InputError(f"{path}: has no row of numbers below the names of its columns")
    columns = _Columns([cell.strip() for cell in rows[0]], robot, f"{path}, line 1")
    lines = [(number, row) for number, row in enumerate(rows[1:], start=2) if any(cell.strip() for cell in row)]
    if not lines:
        raise InputError(f"{path}: has no row of numbers below the names of its columns")
    found = [columns.read(row, f"{path}, line {line}") for line, row in lines]
    commands, places, masses, lengths, forces = (np.array(each) for each in zip(*found, strict=True))
    return Measurements(
        commands=commands,
        markers=columns.markers,
        places=places,
        masses=masses if masses.any() else None,
        pairs=columns.pairs,
        lengths=lengths if columns.pairs else None,
        forces=forces if np.isfinite(forces).any() else None,
    )


class _Columns:
    """Meaning of the columns of a table."""

    def __init__(self, head: Sequence[str], robot: Robot, where: str) -> None:
        self._axes, self._head = "xyz"[: robot.body.mesh.dim], head
        winches, markers = [winch.name for winch in robot.winches], [marker.name for marker in robot.markers]
        known = {f"{name}_mm": ("winch", name) for name in winches}
        known |= {f"{name}_{axis}_mm": ("place", name, axis) for name in markers for axis in self._axes}
        known |= {f"{name}_load_g": ("load", name) for name in markers}
        known |= {f"{name}_force_n": ("force", name) for name in winches}
        allowed = ", ".join(list(known)[:8]) + (f" and {len(known) - 8} more" if len(known) > 8 else "")
        known |= {f"{one}_to_{other}_mm": ("length", one, other) for one, other in permutations(markers, 2)}
        known |= {name: ("winch", name) for name in winches if name not in known}
        for name in head:
            if name not in known and name not in _SKIPPED:
                mark = " Separate columns by commas." if ";" in name or "\t" in name else ""
                raise InputError(f'{where}: unknown column "{name[:60]}". Available: {allowed}.{mark}')
        self._meanings = {column: known[name] for column, name in enumerate(head) if name in known}
        self._check_once(where)
        self._winches, self._travels = winches, {winch.name: winch.travel for winch in robot.winches}
        self.markers = tuple(dict.fromkeys(name for kind in ("place", "length") for name in self._names_of(kind)))
        self.pairs = tuple(
            (self.markers.index(one), self.markers.index(other)) for _, one, other in self._of("length").values()
        )
        for marker in dict.fromkeys(self._names_of("place")):
            for axis in self._axes:
                if ("place", marker, axis) not in self._meanings.values():
                    raise InputError(f'{where}: add a column "{marker}_{axis}_mm"; each marker needs all its axes')
        if unmeasured := [marker for marker in self._names_of("load") if marker not in self.markers]:
            raise InputError(f"{where}: {unmeasured[0]}_load_g needs the columns {unmeasured[0]}_x_mm ... as well")
        if not self.markers:
            places = [name for name, meaning in known.items() if meaning[0] == "place"]
            raise InputError(f"{where}: no column of a marker, such as {', '.join(places[:4])}.")

    def _of(self, kind: str) -> dict[int, tuple[str, ...]]:
        """Columns of a kind."""
        return {column: meaning for column, meaning in self._meanings.items() if meaning[0] == kind}

    def _names_of(self, kind: str) -> list[str]:
        """Names in the columns of a kind, in their order."""
        return [name for _, *names in self._of(kind).values() for name in (names[:1] if kind != "length" else names)]

    def _check_once(self, where: str) -> None:
        seen = set[tuple[str, ...]]()
        for column, meaning in self._meanings.items():
            key = (meaning[0], *sorted(meaning[1:])) if meaning[0] == "length" else meaning
            if key in seen:
                raise InputError(f'{where}: "{self._head[column]}" has two columns')
            seen.add(key)

    def read(self, row: Sequence[str], where: str) -> tuple[np.ndarray, ...]:
        """Commands [m], places [m], hung masses [kg], lengths [m] and forces [N] of one row."""
        if len(row) != len(self._head):
            raise InputError(f"{where}: {len(row)} cells, but there are {len(self._head)} columns")
        command, forces = np.zeros(len(self._winches)), np.full(len(self._winches), np.nan)
        places, masses = np.full((len(self.markers), len(self._axes)), np.nan), np.zeros(len(self.markers))
        lengths = []
        for column, (kind, name, *more) in self._meanings.items():
            value = self._number(row, column, where, may_lack=kind in EMPTY)
            if kind in POSITIVE and value < 0:
                raise InputError(f"{where}, column {self._head[column]}: must be 0 or more, not {value:g}")
            if kind == "winch":
                command[self._winches.index(name)] = MM * value
                if MM * abs(value) > TRAVELS * (travel := self._travels[name]):
                    raise InputError(
                        f"{where}, column {self._head[column]}: {value:g} mm, but the travel of {name} is "
                        f"{travel / MM:.0f} mm. Write mm."
                    )
            elif kind == "force":
                forces[self._winches.index(name)] = value
            elif kind == "load":
                masses[self.markers.index(name)] = 0.0 if math.isnan(value) else 1e-3 * value
            elif kind == "length":
                lengths.append(MM * value)
            else:
                places[self.markers.index(name), self._axes.index(more[0])] = MM * value
        return command, places, masses, np.array(lengths), forces

    def _number(self, row: Sequence[str], column: int, where: str, *, may_lack: bool) -> float:
        if may_lack and not row[column].strip():
            return math.nan
        try:
            number = float(row[column])
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise InputError(
                f'{where}, column {self._head[column]}: "{row[column].strip()[:30]}" is no number. '
                f"Write a number{' or nothing, if it was not measured' if may_lack else ''}."
            )
        return number


EMPTY, POSITIVE = ("place", "length", "force", "load"), ("load", "length")
"""Kinds of columns whose cells may be empty (no mass hung, else not measured), and whose numbers are not below 0."""

TRAVELS = 10
"""Contractions over the travel of their winch from which on their unit is wrong."""

_SKIPPED = ("time_s", "pose", "row")
"""Columns that are not read."""
