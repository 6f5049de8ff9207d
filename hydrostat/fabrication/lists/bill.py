"""The bill of materials: what is bought, how much of it, and what it costs, roughly, and where that is from."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from types import MappingProxyType

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.table import Cell, Table, number_columns, text_columns
from hydrostat.fabrication.moulds.casting import SILICONE_PRICE

NO_SOURCE = "estimate, no source"


@dataclass(frozen=True, kw_only=True)
class Price:
    """A rough price (InputError: an amount below 0, or a pack of nothing)."""

    amount: float  # in its currency, of one unit
    unit: str = "piece"  # what it is of, such as "m" or "kg"
    pack: float = 1.0  # in how many units it is sold
    month: str = ""  # when it was asked or noted; empty if the source has no date
    source: str = NO_SOURCE  # where it is from, in words
    currency: str = "USD"  # its code

    def __post_init__(self) -> None:
        if not (math.isfinite(self.amount) and self.amount >= 0):
            raise InputError(f"amount must be at least 0 {self.currency}, not {self.amount:g}")
        if not (math.isfinite(self.pack) and self.pack > 0):
            raise InputError(f"pack must be above 0 {self.unit}, not {self.pack:g}")

    @property
    def words(self) -> str:
        """Its source and its month, in words."""
        if self.source == NO_SOURCE:
            return NO_SOURCE
        return f"rough, from {self.source}; {self.month or 'no date'}"

    def packs(self, quantity: float) -> int:
        """Count of the packs that hold a quantity."""
        return math.ceil(quantity / self.pack - 1e-9)

    def of_packs(self, quantity: float) -> float:
        """Cost of the packs that hold a quantity."""
        return self.packs(quantity) * self.pack * self.amount


_SHEET = 0.2286 * 0.3048  # of craft felt, 9 by 12 inches [m^2]
_BAG = 32 * 0.0283495  # of fibre filling, 32 oz [kg]
_ANGLER = 91.44  # line on a spool, 100 yards [m]

_PUPPETS = "a puppet maker's list of costs (The Tucson Puppet Lady)"
_BEARS = "a sewing group's list of costs (Crafting 4 Jesus)"

PRICES = MappingProxyType(
    {
        "felt": Price(
            amount=0.40 / _SHEET, unit="m^2", pack=_SHEET, source=f"{_PUPPETS}: craft felt, 0.40 a sheet of 9 by 12 in"
        ),
        "thread": Price(amount=3.0, unit="spool", source=f"{_PUPPETS}: all-purpose thread, 3 a spool"),
        "filling": Price(
            amount=5.99 / _BAG, unit="kg", pack=_BAG, month="2011-01", source=f"{_BEARS}: fibre filling, 5.99 for 32 oz"
        ),
        "zipper": Price(amount=2.0),
        "needle": Price(amount=5.0, unit="set"),
        "line": Price(
            amount=6.95 / _ANGLER,
            unit="m",
            pack=_ANGLER,
            month="2007-10",
            source="an angler's notes (Singlebarbed): braided Dyneema line, 6.95 for 100 yd",
        ),
        "tube": Price(amount=2.0, unit="m"),
        "controller": Price(
            amount=5.44, source="parts list of a drawing robot (RISE STEM kits): board like the Arduino Nano"
        ),
        "servo board": Price(
            amount=28.64,
            source="parts list of a gripper with two Dynamixel servos (force_gripper_hardware): OpenRB-150",
        ),
        "driver": Price(amount=5.0),
        "supply": Price(amount=10.0),
        "fuse": Price(amount=2.0),
        "switch": Price(amount=3.0),
        "lead": Price(amount=1.0, unit="m"),
        "servo cable": Price(amount=2.0),
        "encoder": Price(amount=5.0),
        "small parts": Price(amount=1.0, unit="set"),
        "screws": Price(amount=0.08, pack=100.0, source="parts list of a printed robot hand: M3 screws, 8 for 100"),
        "pla": Price(
            amount=19.99, unit="kg", month="2023-05", source="parts list of SCUTTLE mini (D. Malawey): filament, 1 kg"
        ),
        "foam": Price(amount=40.0, unit="kg", pack=0.5),
        "silicone": Price(amount=SILICONE_PRICE, unit="kg"),
        "release": Price(amount=15.0, unit="can"),
        "glue": Price(amount=15.0, unit="can"),
        "sealer": Price(amount=8.0, unit="can"),
        "clay": Price(amount=8.0, unit="pack"),
        "plastic glue": Price(amount=5.0, unit="tube"),
        "bolts": Price(amount=0.25),
        "rod": Price(amount=1.0, unit="m", pack=0.3),
        "skin": Price(amount=8.0),
    }
)
"""By key; none is younger than its month says, and those without a source are guesses: ask your shop."""


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
    """The bill, with totals of the groups and of all (InputError: a price not in USD: currencies cannot be added)."""
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
