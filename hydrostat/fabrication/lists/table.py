"""`Table`: typed rows, formatted last, for the sheet and as CSV."""

import csv
import io
import math
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, Generic, TypeVar, get_type_hints

from hydrostat.errors import InputError

Cell = str | int | float | None  # value of one field; None: nothing

_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
"""A text that begins with one of these is run as a formula by spreadsheets; the last four are their wide forms."""


class Align(StrEnum):
    """Side of its column on which a text stands."""

    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True, kw_only=True)
class Column:
    """Format of one field of a row; it stands in the annotation of the field."""

    title: str  # title of the column
    unit: str = ""  # unit of its numbers; empty for none
    decimals: int = 1  # to which its numbers are rounded
    align: Align = Align.RIGHT  # left for text, right for numbers

    @property
    def heading(self) -> str:
        """Its title with its unit, such as "length [mm]"."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title

    def text(self, cell: Cell) -> str:
        """A cell as it is printed."""
        if cell is None:
            return ""
        if isinstance(cell, float):
            rounded = round(cell, self.decimals)
            return f"{rounded + 0.0:.{self.decimals}f}"  # + 0.0: no minus before nought
        return str(cell)


def text_column(title: str) -> Column:
    """Column of text, on the left."""
    return Column(title=title, align=Align.LEFT)


def number_column(title: str, unit: str = "", *, decimals: int = 1) -> Column:
    """Column of numbers, on the right."""
    return Column(title=title, unit=unit, decimals=decimals)


@cache
def columns_of(row: type) -> MappingProxyType[str, Column]:
    """Columns of a type of rows, by field; a field without a `Column` in its annotation is not printed."""
    found: dict[str, Column] = {}
    for field, hint in get_type_hints(row, include_extras=True).items():
        for extra in getattr(hint, "__metadata__", ()):
            if isinstance(extra, Column):
                found[field] = extra
    return MappingProxyType(found)


Row = TypeVar("Row")


@dataclass(frozen=True, kw_only=True)
class Table(Generic[Row]):
    """Rows of one type (InputError: a row of another type, or a number that is not finite)."""

    name: str  # stem of its file
    title: str  # title for a person
    row: type[Row]  # dataclass of its rows, with a `Column` in the annotation of each printed field
    rows: tuple[Row, ...]  # in the order in which they are printed
    notes: tuple[str, ...] = ()  # sentences that belong below it

    def __post_init__(self) -> None:
        for index, row in enumerate(self.rows):
            if not isinstance(row, self.row):
                raise InputError(f"{self.name}: row {index} must be a {self.row.__name__}, not a {type(row).__name__}")
            for column, cell in zip(self.columns.values(), self._cells(row), strict=True):
                if isinstance(cell, float) and not math.isfinite(cell):
                    raise InputError(f'{self.name}: row {index}: "{column.title}" is {cell}, not a number')

    @property
    def columns(self) -> MappingProxyType[str, Column]:
        """Columns by field, in their order."""
        return columns_of(self.row)

    @property
    def headings(self) -> tuple[str, ...]:
        """Headings of its columns, with units."""
        return tuple(column.heading for column in self.columns.values())

    @cached_property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """Its rows as they are printed."""
        columns = self.columns.values()
        return tuple(
            tuple(column.text(cell) for column, cell in zip(columns, self._cells(row), strict=True))
            for row in self.rows
        )

    def texts_of(self, field: str) -> tuple[str, ...]:
        """One field of all rows as it is printed."""
        column = self.columns[field]
        return tuple(column.text(getattr(row, field)) for row in self.rows)

    @property
    def csv(self) -> bytes:
        """Headings and rows as CSV (RFC 4180, UTF-8); text that spreadsheets would run as a formula gets a ' before."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\r\n")
        writer.writerow(_harmless(heading) for heading in self.headings)
        for row, texts in zip(self.rows, self.texts, strict=True):
            writer.writerow(
                _harmless(text) if isinstance(cell, str) else text
                for cell, text in zip(self._cells(row), texts, strict=True)
            )
        return out.getvalue().encode()

    def _cells(self, row: Any) -> tuple[Cell, ...]:
        return tuple(getattr(row, field) for field in self.columns)


def _harmless(text: str) -> str:
    """Text that no spreadsheet takes for a formula, on one line."""
    line = " ".join(text.split())
    return f"'{line}" if line.startswith(_FORMULA) else line
