"""Keys of the facts of a sheet. Oracle: the text of the templates that use them."""

import re
from importlib.resources import files
from typing import get_args

import pytest

from hydrostat.fabrication.sheets.facts import (
    CheckFacts,
    MoldFacts,
    PictureFacts,
    PictureName,
    PieceFacts,
    PowerFacts,
    SheetData,
    StepFacts,
    SummaryFacts,
    TableFacts,
    WinchFacts,
)

RECORDS = {
    "data": SheetData,
    "list": TableFacts,
    "bill": TableFacts,
    "cables": TableFacts,
    "tubes": TableFacts,
    "step": StepFacts,
    "row": SummaryFacts,
    "winch": WinchFacts,
    "piece": PieceFacts,
    "check": CheckFacts,
    "mould": MoldFacts,
    "power": PowerFacts,
    "drawn": PictureFacts,
}
"""What the templates call each record."""

METHODS = {"any", "at", "first", "flatten", "last", "len", "map", "slice"}
"""Methods of typst that are called on records and lists of them."""


def templates() -> str:
    """All templates of the assembly sheet, without comments."""
    room = files("hydrostat.fabrication.sheets")
    texts = [path.read_text(encoding="utf-8") for path in room.iterdir() if path.name.endswith(".typ")]
    return re.sub(r"//.*", "", "\n".join(texts))


def used_keys(text: str) -> dict[type, set[str]]:
    """Keys that a text of typst takes from each kind of record, as in `data.title`."""
    found: dict[type, set[str]] = {record: set() for record in RECORDS.values()}
    for name, key in re.findall(r"(?<![\w/-])(\w+)\.(?=(\w+))", text):
        if name in RECORDS and key not in METHODS:
            found[RECORDS[name]].add(key)
    return found


@pytest.mark.parametrize("record", dict.fromkeys(RECORDS.values()), ids=lambda record: record.__name__)
def test_templates_use_the_keys_of_each_record(record: type) -> None:
    assert used_keys(templates())[record] == set(record.__annotations__)


def test_templates_place_every_picture() -> None:
    text = templates()
    assert set(re.findall(r'picture\("(\w+)"', text)) == set(get_args(PictureName))
    assert set(re.findall(r'"(\w+)" in data\.pictures', text)) <= set(get_args(PictureName))


def test_a_key_that_no_record_has_is_found() -> None:
    found = used_keys("if data.mould.foam { data.winches.map(winch => winch.marks) }")
    assert found[SheetData] == {"mould", "winches"}
    assert found[MoldFacts] - set(MoldFacts.__annotations__) == {"foam"}
    assert found[WinchFacts] - set(WinchFacts.__annotations__) == {"marks"}


def test_records_are_told_apart_from_files() -> None:
    assert not any(used_keys("lists/bill.csv parts/winch.stl").values())
