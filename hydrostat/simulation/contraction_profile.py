"""`ContractionProfile`: contractions in time; `ProfileTable`: the one table that holds them, written and read."""

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.files import csv_text, read_stranger, replace_file
from hydrostat.given import check_not_negative, list_choices
from hydrostat.robot import Robot
from hydrostat.simulation.controls import contraction_values
from hydrostat.units import quote


@dataclass(frozen=True, kw_only=True, eq=False)
class ContractionProfile:
    """Contractions of the winches at given times; linear between them, or smooth with zero speed at each given time.

    Contractions are constant before the first time and after the last.

    Attributes:
        times: times in rising order [s].
        values: contractions at these times [m], one row for each time, in winch order, then drive values [rad or m].
        gentle: True to interpolate by 3 s^2 - 2 s^3 instead of linearly.

    Raises:
        InputError: times that do not rise, values that are not finite, or a wrong number of rows.
    """

    times: Vector
    values: Float[np.ndarray, "rows winches"] = field(repr=False)
    gentle: bool = False

    def __post_init__(self) -> None:
        try:
            times, values = np.array(self.times, dtype=float), np.array(self.values, dtype=float)
        except (TypeError, ValueError):
            raise InputError("a profile needs times [s], and contractions [m] as a row for each of them") from None
        if times.ndim != 1 or values.ndim != 2:
            raise InputError(f"a profile needs times and a row for each, not arrays of {times.shape}, {values.shape}")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)
        if len(self.times) == 0 or len(self.values) != len(self.times):
            raise InputError(f"a profile needs contractions for each time: {len(self.values)} for {len(self.times)}")
        if not (np.isfinite(self.times).all() and np.isfinite(self.values).all()):
            raise InputError("a profile has a number that is not finite")
        if (np.diff(self.times) <= 0).any():
            raise InputError("the times of a profile must rise from row to row")

    @classmethod
    def ramp(cls, contractions: Vector, seconds: float) -> Self:
        """Create a smooth profile from rest to contractions [m] in a duration [s] (InputError: names, not an array)."""
        _check_array(contractions)
        return cls(times=np.array([0.0, seconds]), values=np.array([0 * contractions, contractions]), gentle=True)

    @classmethod
    def step(cls, contractions: Vector, begin: float = 0.0) -> Self:
        """Create a step from 0 to contractions [m] at a time [s], within a microsecond.

        Raises InputError: names, not an array, or a time below 0.
        """
        _check_array(contractions)
        check_not_negative("begin", begin, "s")
        return cls(times=np.array([begin, begin + 1e-6]), values=np.array([0 * contractions, contractions]))

    def at(self, time: float) -> Vector:
        """Return the contractions at a time [s]."""
        place = int(np.clip(np.searchsorted(self.times, time) - 1, 0, max(len(self.times) - 2, 0)))
        if len(self.times) == 1:
            return self.values[0]
        share = float(np.clip((time - self.times[place]) / (self.times[place + 1] - self.times[place]), 0.0, 1.0))
        if self.gentle:
            share = share * share * (3 - 2 * share)
        return (1 - share) * self.values[place] + share * self.values[place + 1]

    @staticmethod
    def read(path: Path, robot: Robot) -> "ContractionProfile":
        """Read a profile from a `ProfileTable`.

        Raises:
            InputError: the file cannot be read, or is not such a table; names the line.
        """
        return ProfileTable.open(path, robot).profile

    def write(self, path: Path, robot: Robot) -> Path:
        """Write a profile for `ContractionProfile.read`, atomically; return its path.

        A smooth profile becomes linear.
        """
        return replace_file(path, self.text(robot))

    def text(self, robot: Robot) -> bytes:
        """Return a profile as the bytes of a `ProfileTable`; a smooth profile becomes linear."""
        heads, factors = zip(*_columns(robot).values(), strict=True) if _columns(robot) else ((), ())
        rows = zip(self.times, np.array(factors) * self.values + 0.0, strict=True)
        return csv_text(
            [TIME, *heads],
            ([f"{time:.15g}", *(f"{value:.9g}" for value in row)] for time, row in rows),
        )


def _check_array(contractions: object) -> None:
    if not isinstance(contractions, np.ndarray):
        raise InputError("a profile needs an array: simulation.as_contractions({...}) makes one of names")


def check_profile(profile: object, robot: Robot) -> None:
    """Check that a motion can be played by a profile (InputError: it is none, or one of another robot)."""
    if not isinstance(profile, ContractionProfile):
        raise InputError(
            "a motion is played by a ContractionProfile, such as ContractionProfile.ramp(simulation.as_contractions("
            f"{{...}}), seconds), not by {profile!r:.60}"
        )
    values = profile.values
    contraction_values(robot, values[0])
    contraction_values(robot, values[np.abs(values).argmax(axis=0), np.arange(values.shape[1])])


@dataclass(frozen=True, kw_only=True, eq=False)
class ProfileTable:
    """CSV of moves: a column `time_s`, and in millimeters one for each winch that moves, `left_mm` or just `left`.

    Drives that slide have such columns too, drives that turn one in degrees, `base_deg`, drives of loads `thumb_share`.

    The studio, `hydrostat trajectory`, `hydrostat play` and `hydrostat simulate --play` write and read this table.

    Attributes:
        name: name of the file.
        profile: contractions in the file, linear from row to row.
        lines: line number of each row in the file.
    """

    name: str
    profile: ContractionProfile
    lines: tuple[int, ...] = field(repr=False)

    @classmethod
    def read(cls, content: bytes, robot: Robot, *, name: str) -> Self:
        """Read the bytes of a file.

        Args:
            content: bytes of the file.
            robot: robot whose winches the file names; winches that it omits do not contract.
            name: name of the file, for messages.

        Raises:
            InputError: it is no such table; the text names the line, the column, and what is allowed.
        """
        try:
            reader = csv.reader(StringIO(content.decode("utf-8-sig"), newline=""))
            rows = [(reader.line_num, row) for row in reader]
        except UnicodeDecodeError:
            raise InputError(f"{name}: is no text in UTF-8; save it again as CSV in UTF-8") from None
        except csv.Error as error:
            raise InputError(f"{name}: cannot be read as a table ({error})") from None
        columns = _columns(robot)
        names, parts = list(columns), "winch or drive" if robot.drives else "winch"
        head = [_column(cell.strip(), columns) for cell in rows[0][1]] if rows else []
        if TIME not in head or len(set(head)) != len(head):
            first = ",".join(rows[0][1]) if rows else ""
            other = next((said for mark, said in _MARKS.items() if re.match(mark, first)), "")
            example = ",".join([TIME, *(head for head, _ in list(columns.values())[:2])])
            raise InputError(
                f"{name}, line 1: not a table of moves. Name the columns, each once: {TIME} and winches, as in "
                f"{example}{other}"
            )
        for column in head:
            if column not in (TIME, *names):
                heads = [full.removesuffix(MILLIMETERS) for full, _ in columns.values()]
                known = list_choices("winches and drives" if robot.drives else "winches", heads, column)
                raise InputError(f"{name}, line 1: unknown {parts} {quote(column)}. {known}")
        lines, times, values = [], [], []
        for line, row in rows[1:]:
            if any(cell.strip() for cell in row):
                numbers = _numbers(f"{name}, line {line}", head, row, columns)
                if times and numbers[TIME] <= times[-1]:
                    raise InputError(
                        f"{name}, line {line}, column {TIME}: the times must rise from row to row; "
                        f"{numbers[TIME]:g} comes after {times[-1]:g}"
                    )
                lines.append(line)
                times.append(numbers[TIME])
                values.append([numbers.get(each, 0.0) / factor for each, (_, factor) in columns.items()])
        if not times:
            raise InputError(f"{name}: has no row of numbers below the names of its columns")
        profile = ContractionProfile(times=np.array(times), values=np.array(values).reshape(len(times), len(names)))
        return cls(name=name, profile=profile, lines=tuple(lines))

    @classmethod
    def open(cls, path: Path, robot: Robot) -> Self:
        """Read a file.

        Raises:
            InputError: it cannot be read, or see `read`.
        """
        most = 50_000_000  # Bytes that a table of moves may have
        return cls.read(read_stranger(path, most=most), robot, name=str(path))

    def place(self, row: int) -> str:
        """File and line of a row, for messages."""
        return f"{self.name}, line {self.lines[row]}"


def _columns(robot: Robot) -> dict[str, tuple[str, float]]:
    """Head of the column of each winch and drive, and the factor from SI, by name."""
    found = {winch.name: (f"{winch.name}{MILLIMETERS}", 1e3) for winch in robot.winches}
    return found | {drive.name: drive.column for drive in robot.drives}


def _column(head: str, columns: Mapping[str, tuple[str, float]]) -> str:
    """Winch or drive that a column is of, if it is of one; else its head."""
    named = {full: name for name, (full, _) in columns.items()}
    return named.get(head, head)


def _numbers(
    place: str, head: Sequence[str], row: Sequence[str], columns: Mapping[str, tuple[str, float]]
) -> dict[str, float]:
    """Numbers of a row by the names of their columns."""
    if len(row) != len(head):
        raise InputError(f"{place}: write a number in each of the {len(head)} columns, not {len(row)} of them")
    found = {}
    for column, cell in zip(head, row, strict=True):
        try:
            found[column] = float(cell)
        except ValueError:
            found[column] = math.nan
        if not math.isfinite(found[column]):
            full = column if column == TIME else columns[column][0]
            wanted = _VALUES[full.rpartition("_")[2]]
            shown = full.removesuffix(MILLIMETERS)
            raise InputError(f"{place}, column {shown}: write {wanted}, not {quote(cell.strip())}")
    return found


TIME = "time_s"
"""Name of the column of times [s]."""

MILLIMETERS = "_mm"  # ends the head of a column of contractions

_VALUES = {
    "s": "a number of seconds",
    "mm": "a number of millimeters",
    "deg": "a number of degrees",
    "share": "a share without unit, such as 0.5",
}
"""Values of a column by the end of its head."""


_MARKS = {
    r"\s*[{\[]": "; this is JSON: hydrostat trajectory writes trajectory.csv",
    rf"\s*{TIME}.*;": "; commas part them, not semicolons",
    rf"\s*{TIME}.*\t": "; commas part them, not tabs",
}
