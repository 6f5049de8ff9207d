"""`Table`: rows of text and numbers, for the sheet and as CSV."""

import csv
import io
import math
from dataclasses import dataclass
from enum import StrEnum

from hydrostat.errors import InputError

Cell = str | int | float | None  # what stands in one field; None: nothing

_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
"""A text that begins with one of these is run as a formula by spreadsheets; the last four are their wide forms."""


class Align(StrEnum):
    """Side of its column on which a text stands."""

    LEFT = "left"
    RIGHT = "right"


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column."""

    title: str  # what it holds
    unit: str = ""  # of its numbers; empty for none
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


def text_columns(*titles: str) -> tuple[Column, ...]:
    """Columns of text, on the left."""
    return tuple(Column(title=title, align=Align.LEFT) for title in titles)


def number_columns(*titles: str, unit: str = "", decimals: int = 1) -> tuple[Column, ...]:
    """Columns of numbers, on the right, all of one unit and so many decimals."""
    return tuple(Column(title=title, unit=unit, decimals=decimals) for title in titles)


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows of text and numbers (InputError: a row of another length, or a number that is not finite)."""

    name: str  # stem of its file
    title: str  # what a person calls it
    columns: tuple[Column, ...]  # of each row
    rows: tuple[tuple[Cell, ...], ...]  # as many cells as columns each
    notes: tuple[str, ...] = ()  # sentences that belong below it

    def __post_init__(self) -> None:
        for index, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise InputError(
                    f"{self.name}: row {index} has {len(row)} cells, the table {len(self.columns)} columns"
                )
            for column, cell in zip(self.columns, row, strict=True):
                if isinstance(cell, float) and not math.isfinite(cell):
                    raise InputError(f'{self.name}: row {index}: "{column.title}" is {cell}, not a number')

    @property
    def headings(self) -> tuple[str, ...]:
        """Headings of its columns, with units."""
        return tuple(column.heading for column in self.columns)

    @property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """Its rows as they are printed."""
        return tuple(
            tuple(column.text(cell) for column, cell in zip(self.columns, row, strict=True)) for row in self.rows
        )

    def column(self, title: str) -> tuple[Cell, ...]:
        """All cells under a title (InputError: there is no such column)."""
        titles = [column.title for column in self.columns]
        if title not in titles:
            raise InputError(f'{self.name}: unknown column "{title}". Available: {", ".join(titles)}.')
        place = titles.index(title)
        return tuple(row[place] for row in self.rows)

    @property
    def csv(self) -> bytes:
        """Headings and rows as CSV (RFC 4180, UTF-8); text that spreadsheets would run as a formula gets a ' before."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\r\n")
        writer.writerow(_harmless(heading) for heading in self.headings)
        for row, texts in zip(self.rows, self.texts, strict=True):
            writer.writerow(
                _harmless(text) if isinstance(cell, str) else text for cell, text in zip(row, texts, strict=True)
            )
        return out.getvalue().encode()


def _harmless(text: str) -> str:
    """Text that no spreadsheet takes for a formula, on one line."""
    line = " ".join(text.split())
    return f"'{line}" if line.startswith(_FORMULA) else line
