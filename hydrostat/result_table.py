"""`ResultTable`: columns of numbers with names, for pandas, for spreadsheets and for notebooks."""

import html
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.files import csv_text, replace_file

if TYPE_CHECKING:
    import pandas  # type: ignore[import-not-found]

Columns = dict[str, Vector]
"""Numbers by name and unit, such as `contraction_left_m`, `marker_tip_x_m`, `tension_left 1_N`."""


class Tabular:
    """Result that is also a table: a row for each pose, lengths in meters, forces in newtons."""

    def columns(self) -> Columns:
        """Return the columns of its table."""
        raise NotImplementedError

    def texts(self) -> Mapping[str, Sequence[str]]:
        """Return columns of text, which follow those of numbers in files; none by default."""
        return {}

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return its table for pandas (InputError: pandas is not installed)."""
        try:
            frame: Any = import_module("pandas").DataFrame
        except ImportError:
            raise InputError("to_dataframe needs pandas: pip install pandas. write_csv works without.") from None
        return frame({**self.columns(), **self.texts()})

    def write_csv(self, path: str | Path) -> Path:
        """Write its table as CSV, with nine digits (InputError: the file cannot be written); returns the path."""
        columns = {name: [f"{value:.9g}" for value in values] for name, values in self.columns().items()}
        columns |= {name: list(values) for name, values in self.texts().items()}
        return replace_file(Path(path), csv_text(list(columns), zip(*columns.values(), strict=True)))

    def _repr_html_(self) -> str:
        """Summary and the first rows, for a notebook."""
        return table_html(self)


@dataclass(frozen=True, eq=False)
class ResultTable(Tabular):
    """Rows of several results.

    Attributes:
        numbers: columns by name.
    """

    numbers: Mapping[str, Vector]

    @staticmethod
    def of(results: Iterable[Tabular]) -> "ResultTable":
        """Return one table with the rows of several poses, motions or other results.

        Raises:
            InputError: no results, or results with different columns.
        """
        parts = [result.columns() for result in results]
        if not parts or any(list(part) != list(parts[0]) for part in parts):
            raise InputError("a table needs at least one result, and all of the same robot and kind")
        return ResultTable({name: np.concatenate([part[name] for part in parts]) for name in parts[0]})

    def columns(self) -> Columns:
        """Return the columns."""
        return dict(self.numbers)

    def __repr__(self) -> str:
        """Return a one-line summary."""
        rows = len(next(iter(self.numbers.values()), ()))
        return f"<ResultTable of {rows} x {len(self.numbers)}: {', '.join(self.numbers)}>"


def marker_columns(places: Mapping[str, Any]) -> Columns:
    """Return a column for each coordinate of each marker, (rows, dim)."""
    return {
        f"marker_{name}_{axis}_m": np.asarray(rows, dtype=float)[:, column]
        for name, rows in places.items()
        for column, axis in zip(range(np.shape(rows)[1]), "xyz", strict=False)
    }


def named_columns(kind: str, names: Iterable[str], values: Any, unit: str) -> Columns:
    """Return a column for each name, (rows, names)."""
    return {
        f"{kind}_{name}_{unit}": np.asarray(column, dtype=float) for name, column in zip(names, values.T, strict=True)
    }


def control_columns(winches: Sequence[str], drives: Mapping[str, str], values: Any) -> Columns:
    """Return a column for each winch and drive, (rows, winches and drives); `drives` are units by name."""
    columns = named_columns("contraction", winches, values[:, : len(winches)], "m")
    for (name, unit), column in zip(drives.items(), values[:, len(winches) :].T, strict=True):
        columns[f"drive_{name}_{unit}"] = np.asarray(column, dtype=float)
    return columns


def table_html(table: Tabular, title: str = "") -> str:
    """Return a title and the first rows of a table as HTML."""
    most = 10
    columns = table.columns()
    head = "".join(f"<th>{html.escape(name)}</th>" for name in columns)
    cells = [[f"<td>{value:.4g}</td>" for value in row] for row in zip(*columns.values(), strict=True)]
    body = "".join(f"<tr>{''.join(row)}</tr>" for row in cells[:most])
    left = f"<p>{len(cells) - most} more rows</p>" if len(cells) > most else ""
    above = f"<pre>{html.escape(title or repr(table))}</pre>"
    return f"<div>{above}<table><tr>{head}</tr>{body}</table>{left}</div>"
