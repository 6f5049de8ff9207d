"""The bill of materials: what is bought, how much of it, and what it costs."""

from collections.abc import Iterable
from dataclasses import dataclass

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.prices import Price
from hydrostat.fabrication.lists.table import Cell, Table, number_columns, text_columns


@dataclass(frozen=True, kw_only=True)
class Item:
    """One line of the bill."""

    group: str  # such as "body"
    what: str  # is bought
    specification: str  # which kind
    quantity: float  # in the unit of its price
    price: Price  # of one unit
    mass: float | None = None  # of all of it [g]; None where it is not known

    @property
    def cost(self) -> float:
        """Cost of what is used up, in the currency of its price."""
        return self.quantity * self.price.amount

    @property
    def spent(self) -> float:
        """Cost of the whole packs, in the currency of its price."""
        return self.price.of_packs(self.quantity)


def cost_of(items: Iterable[Item], group: str | None = None) -> float:
    """Cost of what is used up of all items, or of those of a group."""
    return sum(item.cost for item in items if group in (None, item.group))


def bill_table(items: tuple[Item, ...], notes: tuple[str, ...] = ()) -> Table:
    """The bill, with a total after each group and at the end.

    Raises InputError: a price that is not in USD: currencies cannot be added.
    """
    for item in items:
        if item.price.currency != "USD":
            raise InputError(f"the price of {item.what} must be in USD, not {item.price.currency}")
    rows: list[tuple[Cell, ...]] = []
    for group in dict.fromkeys(item.group for item in items):
        mine = [item for item in items if item.group == group]
        rows += [_row(item) for item in mine]
        rows.append((group, "total", "", None, "", _mass(mine), None, cost_of(mine), _spent(mine), ""))
    rows.append(("all", "total", "", None, "", _mass(items), None, cost_of(items), _spent(items), ""))
    return Table(
        name="bill_of_materials",
        title="Bill of materials",
        columns=(
            *text_columns("group", "what", "specification"),
            *number_columns("quantity", decimals=2),
            *text_columns("unit"),
            *number_columns("mass", unit="g"),
            *number_columns("price", "used up", "in whole packs", unit="USD", decimals=2),
            *text_columns("source of the price"),
        ),
        rows=tuple(rows),
        notes=(
            "Quantities are what one robot takes, without waste. Used up: that share of the packs; in whole packs: "
            "what a first robot costs.",
            "Prices are rough: those with a source were true then and there, the others are guesses.",
            *notes,
        ),
    )


def _row(item: Item) -> tuple[Cell, ...]:
    price = item.price
    return (
        *(item.group, item.what, item.specification, item.quantity, price.unit, item.mass),
        *(price.amount, item.cost, item.spent, price.words),
    )


def _spent(items: Iterable[Item]) -> float:
    return float(sum(item.spent for item in items))


def _mass(items: Iterable[Item]) -> float:
    """Mass of all items, as far as it is known [g]."""
    return float(sum(item.mass or 0.0 for item in items))
