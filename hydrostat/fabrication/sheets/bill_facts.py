"""`bill_facts`: the bill of materials in short, for the first page of a sheet."""

from collections.abc import Mapping
from typing import Any

from hydrostat.fabrication.lists.table import Cell, Table
from hydrostat.fabrication.sheets.sheet_input import SheetInput

Facts = dict[str, Any]
"""Plain data, as JSON has it."""

_TOTAL = "total"
"""What the bill calls the rows that sum others."""

_BY_DETAIL = ("screw or nut", "geared motor")
"""Things of the bill that are called by their specification."""

_UNITS = {"piece": "", "m^2": "m²"}


def bill_facts(given: SheetInput) -> Facts | None:
    """What is bought, how much of it, and what it costs, with the total."""
    bill = given.tables.get("bill_of_materials")
    if bill is None:
        return None
    known, title = [column.title for column in bill.columns], _cost_title(bill)
    rows = []
    for row, texts in zip(bill.rows, bill.texts, strict=True):
        cells = dict(zip(known, row, strict=True))
        what = str(cells.get("what", texts[0]))
        if what == _TOTAL:
            continue
        detail = str(cells.get("specification", "")).partition(",")[0]
        name = detail if what in _BY_DETAIL and detail else what
        cost = cells.get(title)
        rows.append([shortened(name, 40), _amount(cells), f"{cost:.0f}" if isinstance(cost, float | int) else ""])
    total = cost_of(given)
    if total is not None:
        rows.append(["together", "", f"{total:.0f}"])
    return {
        "file": "bill_of_materials.csv",
        "heads": ["what", "amount", "USD"],
        "right": [False, True, True],
        "rows": rows,
    }


def _amount(cells: Mapping[str, Cell]) -> str:
    """How much of a thing, small masses in grams."""
    quantity, unit = cells.get("quantity"), str(cells.get("unit", "") or "")
    if not isinstance(quantity, float | int):
        return str(quantity or "")
    if unit == "kg" and quantity < 1:
        return f"{1e3 * quantity:.0f} g"
    return f"{quantity:.3g} {_UNITS.get(unit, unit)}".strip()


def cost_of(given: SheetInput) -> float | None:
    """Of all that is used up [USD]; None if the bill does not say."""
    bill = given.tables.get("bill_of_materials")
    title = _cost_title(bill) if bill is not None else ""
    if bill is None or not title:
        return None
    named = bill.column("what") if any(column.title == "what" for column in bill.columns) else ("",) * len(bill.rows)
    costs = [
        cell
        for cell, what in zip(bill.column(title), named, strict=True)
        if isinstance(cell, float | int) and what != _TOTAL
    ]
    return float(sum(costs)) if costs else None


def _cost_title(bill: Table) -> str:
    """Under which title the bill says what a thing costs; empty if it does not."""
    known = [column.title for column in bill.columns]
    return next((title for title in ("used up", "cost") if title in known), "")


def shortened(text: str, most: int) -> str:
    """On one line, and of at most so many letters: the end of longer ones is an ellipsis."""
    line = " ".join(text.split())
    return line if len(line) <= most else line[: most - 1].rstrip() + "…"
