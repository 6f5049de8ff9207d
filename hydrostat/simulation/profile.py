"""`Profile`: contractions in time."""

import csv
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Self

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Robot, replace_file


@dataclass(frozen=True, kw_only=True, eq=False)
class Profile:
    """What each winch takes in at given times; in between along a line, or gently: at rest at each given time.

    Before the first time and after the last the contractions stand still.

    Attributes:
        times: rising [s].
        values: contractions at these times [m], a row a time, in winch order.
        gentle: 3 s^2 - 2 s^3 in place of a line.

    Raises:
        InputError: times that do not rise, numbers that are not finite, or rows that are not one for each time.
    """

    times: Vector
    values: Float[np.ndarray, "rows winches"] = field(repr=False)
    gentle: bool = False

    def __post_init__(self) -> None:
        if len(self.times) == 0 or len(self.values) != len(self.times):
            raise InputError(f"a profile needs contractions for each time: {len(self.values)} for {len(self.times)}")
        if not (np.isfinite(self.times).all() and np.isfinite(self.values).all()):
            raise InputError("a profile has a number that is not finite")
        if (np.diff(self.times) <= 0).any():
            raise InputError("the times of a profile must rise from row to row")

    @classmethod
    def ramp(cls, contractions: Vector, seconds: float) -> Self:
        """Gently from rest to the contractions [m] within some time [s]."""
        return cls(times=np.array([0.0, seconds]), values=np.array([0 * contractions, contractions]), gentle=True)

    def at(self, time: float) -> Vector:
        """Contractions at a time [s]."""
        place = int(np.clip(np.searchsorted(self.times, time) - 1, 0, max(len(self.times) - 2, 0)))
        if len(self.times) == 1:
            return self.values[0]
        share = float(np.clip((time - self.times[place]) / (self.times[place + 1] - self.times[place]), 0.0, 1.0))
        if self.gentle:
            share = share * share * (3 - 2 * share)
        return (1 - share) * self.values[place] + share * self.values[place + 1]


def read_profile(path: Path, robot: Robot) -> Profile:
    """A profile from a table: a column `time_s`, and one for each winch that moves, by its name, in millimetres.

    Raises:
        InputError: the file cannot be read, or is no such table; the text names the line.
    """
    try:
        rows = list(csv.reader(StringIO(path.read_text(encoding="utf-8-sig"))))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read as a table ({error})") from None
    head = [name.strip() for name in rows[0]] if rows else []
    if "time_s" not in head or len(set(head)) != len(head):
        raise InputError(f"{path}, line 1: name the columns: time_s and the winches, each once")
    names = [winch.name for winch in robot.winches]
    for name in head:
        if name != "time_s" and name not in names:
            raise InputError(f'{path}, line 1: there is no winch "{name}"; winches are: {", ".join(names)}')
    times, values = [], []
    for number, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        cells = _numbers(path, number, head, row)
        times.append(cells.pop("time_s"))
        values.append([1e-3 * cells.get(name, 0.0) for name in names])
    try:
        return Profile(times=np.array(times), values=np.array(values).reshape(len(times), len(names)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def write_profile(path: Path, robot: Robot, profile: Profile) -> Path:
    """Write a profile as `read_profile` reads it, whole or not at all; returns its path. A gentle one loses that."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time_s", *(winch.name for winch in robot.winches)])
    for time, row in zip(profile.times, 1e3 * profile.values, strict=True):
        writer.writerow([f"{time:.15g}", *(f"{value:.9g}" for value in row + 0.0)])
    return replace_file(path, text.getvalue().encode())


def _numbers(path: Path, number: int, head: list[str], row: list[str]) -> dict[str, float]:
    try:
        return {name: float(cell) for name, cell in zip(head, row, strict=True)}
    except ValueError:
        raise InputError(f"{path}, line {number}: write a number in each of the {len(head)} columns") from None
