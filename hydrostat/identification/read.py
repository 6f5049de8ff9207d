"""`read_measurements`: contractions and measured places of markers from a table."""

import csv
import math
from collections.abc import Sequence
from io import StringIO
from pathlib import Path

import numpy as np

from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.identification.measurements import Measurements
from hydrostat.robot import Robot
from hydrostat.units import MM

LARGEST = 20_000_000
"""Bytes that a table may have."""


def read_measurements(file: str | Path, robot: Robot) -> Measurements:
    """Measurements from a CSV file.

    Columns: `left_mm`, the contraction of winch `left`; `tip_x_mm`, `tip_y_mm` (and `tip_z_mm`), the place of marker
    `tip`; `tip_load_g`, a mass that hung there. A winch without a column does not contract. An empty cell of a marker
    says that it was not seen. Columns `time_s`, `pose` and `row` are skipped.

    Raises:
        InputError: a file that cannot be read, or a column or number that does not fit; the text names file and line.
    """
    path = Path(file)
    try:
        rows = list(csv.reader(StringIO(read_stranger(path, most=LARGEST).decode("utf-8-sig"), newline="")))
    except (UnicodeDecodeError, csv.Error):
        raise InputError(f"{path}: cannot be read as a table; save it as CSV in UTF-8") from None
    if len(rows) < 2:
        raise InputError(f"{path}: has no row of numbers below the names of its columns")
    columns = _Columns([cell.strip() for cell in rows[0]], robot, f"{path}, line 1")
    commands, places, masses = [], [], []
    for line, row in enumerate(rows[1:], start=2):
        if any(cell.strip() for cell in row):
            command, place, mass = columns.read(row, f"{path}, line {line}")
            masses.append(mass)
            commands.append(command)
            places.append(place)
    if not commands:
        raise InputError(f"{path}: has no row of numbers below the names of its columns")
    return Measurements(
        commands=np.array(commands),
        markers=columns.markers,
        places=np.array(places),
        masses=np.array(masses) if np.any(masses) else None,
    )


class _Columns:
    """Meaning of the columns of a table."""

    def __init__(self, head: Sequence[str], robot: Robot, where: str) -> None:
        winches = [winch.name for winch in robot.winches]
        self._axes = "xyz"[: robot.body.mesh.dim]
        places = {f"{marker.name}_{axis}_mm": (marker.name, axis) for marker in robot.markers for axis in self._axes}
        self._head = head
        self._winches: dict[int, int] = {}
        self._places: dict[int, tuple[str, str]] = {}
        self._loads: dict[int, str] = {}
        loads = {f"{marker.name}_load_g": marker.name for marker in robot.markers}
        for column, name in enumerate(head):
            bare = name.removesuffix("_mm")
            if name in places:
                self._places[column] = places[name]
            elif name in loads:
                self._loads[column] = loads[name]
            elif bare in winches:
                self._winches[column] = winches.index(bare)
            elif name not in _SKIPPED:
                known = [f"{winch}_mm" for winch in winches] + list(places) + list(loads)
                allowed = ", ".join(known[:8]) + (f" and {len(known) - 8} more" if len(known) > 8 else "")
                mark = " Separate columns by commas." if ";" in name or "\t" in name else ""
                raise InputError(f'{where}: unknown column "{name[:60]}". Available: {allowed}.{mark}')
        self._check_once(where)
        self.markers = tuple(dict.fromkeys(marker for marker, _ in self._places.values()))
        self._count = len(winches)
        for marker in self.markers:
            for axis in self._axes:
                if (marker, axis) not in self._places.values():
                    raise InputError(f'{where}: add a column "{marker}_{axis}_mm"; each marker needs all its axes')
        if unmeasured := [marker for marker in self._loads.values() if marker not in self.markers]:
            raise InputError(f"{where}: {unmeasured[0]}_load_g needs the columns {unmeasured[0]}_x_mm ... as well")
        if not self.markers:
            raise InputError(f"{where}: no column of a marker, such as {', '.join(list(places)[:4])}.")

    def _check_once(self, where: str) -> None:
        seen: set[object] = set()
        for meaning in (self._winches, self._places, self._loads):
            for column, one in meaning.items():
                key = (id(meaning), one)
                if key in seen:
                    raise InputError(f'{where}: "{self._head[column]}" has two columns')
                seen.add(key)

    def read(self, row: Sequence[str], where: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Commands [m], places [m] and hung masses [kg] of one row."""
        if len(row) != len(self._head):
            raise InputError(f"{where}: {len(row)} cells, but there are {len(self._head)} columns")
        command = np.zeros(self._count)
        for column, winch in self._winches.items():
            command[winch] = MM * self._number(row, column, where)
        places = np.full((len(self.markers), len(self._axes)), np.nan)
        for column, (marker, axis) in self._places.items():
            if row[column].strip():
                place = self.markers.index(marker), self._axes.index(axis)
                places[place] = MM * self._number(row, column, where)
        masses = np.zeros(len(self.markers))
        for column, marker in self._loads.items():
            mass = self._number(row, column, where)
            if mass < 0:
                raise InputError(f"{where}, column {self._head[column]}: a mass is 0 g or more, not {mass:g}")
            masses[self.markers.index(marker)] = 1e-3 * mass
        return command, places, masses

    def _number(self, row: Sequence[str], column: int, where: str) -> float:
        try:
            number = float(row[column])
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise InputError(
                f'{where}, column {self._head[column]}: "{row[column].strip()[:30]}" is no number. '
                f"Write a number{' or nothing, if the marker was not seen' if column in self._places else ''}."
            )
        return number


_SKIPPED = ("time_s", "pose", "row")
