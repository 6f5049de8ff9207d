"""Tables: what is printed and what stands in the CSV."""

import csv
import io

import pytest

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.table import Align, Column, Table

COLUMNS = (Column(title="name", align=Align.LEFT), Column(title="length", unit="mm"), Column(title="turns", decimals=3))


def table(*rows: tuple) -> Table:
    return Table(name="test", title="Test", columns=COLUMNS, rows=rows)


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


@pytest.mark.parametrize("row", [("a", 1.0), ("a", float("nan"), 1.0), ("a", 1.0, float("inf"))])
def test_refuses_what_is_no_row(row: tuple) -> None:
    with pytest.raises(InputError, match="row 0"):
        table(row)


def test_columns_by_title() -> None:
    assert table(("a", 1.0, 2.0), ("b", 3.0, 4.0)).column("length") == (1.0, 3.0)
    with pytest.raises(InputError, match="name, length, turns"):
        table().column("width")
