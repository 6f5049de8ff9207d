"""Tables: what is printed and what stands in the CSV."""

import csv
import io
from dataclasses import dataclass
from typing import Annotated

import pytest

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.table import Align, Column, Table, columns_of, number_column, text_column


@dataclass(frozen=True)
class Row:
    """A name, two numbers, and what is not printed."""

    name: Annotated[str, text_column("name")]
    length: Annotated[float | None, number_column("length", "mm")]
    turns: Annotated[float | None, number_column("turns", decimals=3)]
    hidden: float = float("nan")


def table(*rows: tuple) -> Table[Row]:
    return Table(name="test", title="Test", row=Row, rows=tuple(Row(*row) for row in rows))


def read(content: bytes) -> list[list[str]]:
    return list(csv.reader(io.StringIO(content.decode("utf-8"), newline="")))


def test_reads_back_with_units_in_the_headings() -> None:
    made = table(("left", 12.345, 1.0), ('a "b", c', 7, None))
    assert read(made.csv) == [["name", "length [mm]", "turns"], ["left", "12.3", "1.000"], ['a "b", c', "7", ""]]


def test_lines_end_as_the_standard_says() -> None:
    content = table(("a", 1.0, 2.0), ("b\nc", 1.0, 2.0)).csv
    assert content.count(b"\r\n") == content.count(b"\n") == 3  # RFC 4180; a line break in a name is no new line


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@SUM(A1)", " =1", "\t=1", "\r=1", "\n@x", "＝1"])
def test_a_name_never_becomes_a_formula(name: str) -> None:
    cell = read(table((name, 1.0, 2.0)).csv)[1][0]
    assert cell.startswith("'")
    assert cell.lstrip("'") == name.strip()


def test_numbers_below_nought_stay_numbers() -> None:
    assert read(table(("a", -1.25, -2)).csv)[1] == ["a", "-1.2", "-2"]


def test_no_minus_before_nought() -> None:
    assert table(("a", -0.01, 0.0)).texts[0][1] == "0.0"


def test_letters_of_all_languages() -> None:
    assert read(table(("größe 手", 1.0, 1.0)).csv)[1][0] == "größe 手"


@pytest.mark.parametrize("row", [("a", float("nan"), 1.0), ("a", 1.0, float("inf"))])
def test_refuses_what_is_no_number(row: tuple) -> None:
    with pytest.raises(InputError, match="row 0"):
        table(row)


def test_refuses_a_row_of_another_type() -> None:
    with pytest.raises(InputError, match="row 1 must be a Row, not a tuple"):
        Table(name="test", title="Test", row=Row, rows=(Row("a", 1.0, 2.0), ("a", 1.0, 2.0)))  # type: ignore[arg-type]


def test_columns_are_the_fields_that_are_printed() -> None:
    columns = {"name": ("name", Align.LEFT), "length": ("length", Align.RIGHT), "turns": ("turns", Align.RIGHT)}
    assert {field: (column.title, column.align) for field, column in columns_of(Row).items()} == columns
    assert Column(title="x").heading == "x"


def test_one_field_as_it_is_printed() -> None:
    assert table(("a", 1.0, 2.0), ("b", None, 4.0)).texts_of("length") == ("1.0", "")
    with pytest.raises(KeyError, match="width"):
        table().texts_of("width")
