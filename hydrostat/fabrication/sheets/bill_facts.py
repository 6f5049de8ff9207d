"""`bill_facts`: the bill of materials in short, for the first page of a sheet."""

from collections.abc import Mapping
from typing import Any

from hydrostat.fabrication.lists.table import Cell, Table
from hydrostat.fabrication.sheets.minds import shortened
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
        rows.append([shortened(name, 40), _amount(cells), _dollars(cost)])
    for words, total in zip(("used up", "in whole packs"), costs_of(given), strict=False):
        rows.append([words, "", f"{total:.0f}"])
    return {
        "file": "lists/bill_of_materials.csv",
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


def _dollars(cost: Cell) -> str:
    """In full dollars."""
    if not isinstance(cost, float | int):
        return ""
    return "<1" if 0 < cost < 0.5 else f"{cost:.0f}"


def costs_of(given: SheetInput) -> tuple[float, ...]:
    """Of all that is used up, and of all in whole packs [USD]; none if the bill does not say, one if it says one."""
    bill = given.tables.get("bill_of_materials")
    title = _cost_title(bill) if bill is not None else ""
    if bill is None or not title:
        return ()
    known = [column.title for column in bill.columns]
    named = bill.column("what") if "what" in known else ("",) * len(bill.rows)
    sums = []
    for column in (title, "in whole packs"):
        costs = [
            cell
            for cell, what in zip(bill.column(column) if column in known else (), named, strict=False)
            if isinstance(cell, float | int) and what != _TOTAL
        ]
        sums += [float(sum(costs))] if costs else []
    return tuple(sums)


def cost_text(given: SheetInput) -> tuple[str, ...]:
    """What it costs; nothing if nothing is known."""
    names = ("used up", "in whole packs")
    told = [f"{cost:.0f} USD {name}" for cost, name in zip(costs_of(given), names, strict=False)]
    return (f"about {', '.join(told)}",) if told else ()


def _cost_title(bill: Table) -> str:
    """Under which title the bill says what a thing costs; empty if it does not."""
    known = [column.title for column in bill.columns]
    return next((title for title in ("used up", "cost") if title in known), "")
