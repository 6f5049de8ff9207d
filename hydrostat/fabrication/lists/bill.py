"""The bill of materials: what is bought, how much of it, and what it costs, roughly, and where that is from."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Annotated

from hydrostat.errors import InputError
from hydrostat.fabrication.lists.table import Table, number_column, text_column
from hydrostat.fabrication.moulds.casting import SILICONE_PRICE

NO_SOURCE = "estimate, no source"


@dataclass(frozen=True, kw_only=True)
class Price:
    """A rough price (InputError: an amount below 0, or a pack of nothing)."""

    amount: float  # in its currency, of one unit
    unit: str = "piece"  # unit of the price, such as "m" or "kg"
    pack: float = 1.0  # in how many units it is sold
    month: str = ""  # when it was asked or noted; empty if the source has no date
    source: str = NO_SOURCE  # source of the price, in words
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


FELT_SHEET = (228.6, 304.8)
"""Width and height of a sheet of craft felt, 9 by 12 inches [mm]."""

_SHEET = 1e-6 * FELT_SHEET[0] * FELT_SHEET[1]  # area of that sheet [m^2]
_BAG = 32 * 0.0283495  # mass of a bag of fibre filling, 32 oz [kg]
_ANGLER = 91.44  # line on a spool, 100 yards [m]

_PUPPETS = "a puppet maker's list of costs (The Tucson Puppet Lady)"
_SUPPLY = "parts list of SO-ARM100 1.3 (TheRobotStudio): power supply, 10 USD, 13 EUR"
_ROVER = "estimate in the parts list of a printed rover (Johnny 5)"
_LUGGAGE = "hardware report of a luggage robot (SmoothOperator)"
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
        "decoration": Price(amount=3.0, unit="set"),
        "line": Price(
            amount=6.95 / _ANGLER,
            unit="m",
            pack=_ANGLER,
            month="2007-10",
            source="an angler's notes (Singlebarbed): braided Dyneema line, 6.95 for 100 yd",
        ),
        "tube": Price(amount=2.0, unit="m"),
        "uno board": Price(amount=14.99, source=f"{_LUGGAGE}: Arduino Uno R3"),
        "mega board": Price(amount=22.99, source=f"{_LUGGAGE}: Arduino Mega 2560 R3"),
        "esp32 board": Price(
            amount=10.0,
            month="2026-11",
            source="parts list of the robot MARPY (LevinTamir): its older sister ESP32 DevKit V1 with screw terminals",
        ),
        "shifter": Price(amount=2.0),
        "servo board": Price(
            amount=28.64,
            source="parts list of a gripper with two Dynamixel servos (force_gripper_hardware): OpenRB-150",
        ),
        "bus adapter": Price(
            amount=11.0,
            month="2026-11",
            source="parts list of SO-ARM100 1.3 (TheRobotStudio): Waveshare's bus servo adapter, 11 USD, 12 EUR",
        ),
        "driver": Price(amount=5.0),
        "supply": Price(amount=10.0, month="2025-04", source=_SUPPLY),
        "fuse": Price(amount=3.0, month="2026-06", source=f"{_ROVER}: blade fuse with holder in the lead"),
        "switch": Price(amount=3.0, month="2026-06", source=f"{_ROVER}: toggle switch for 10 A or more"),
        "lead": Price(
            amount=1.1,
            unit="m",
            month="2026-09",
            source="notes of thenar-jx1 (nickthelegend): two wires AWG 16, 49 INR/m each at Robu, at 0.0113 USD",
        ),
        "servo cable": Price(amount=2.0),
        "servo's own cable": Price(
            amount=0.0,
            source="package of DFRobot's SER0069 (Little Bird Electronics) and an assembly guide of SO-ARM101 "
            "(Robonine): a cable comes with each STS3215",
        ),
        "encoder": Price(
            amount=4.475, pack=2.0, source="order list of the team ASROB-sumo: Pololu's kit of two for 8.95"
        ),
        "USB supply": Price(amount=10.0, month="2025-04", source=_SUPPLY),
        "small parts": Price(amount=1.0, unit="set"),
        "screws": Price(amount=0.08, pack=100.0, source="parts list of a printed robot hand: M3 screws, 8 for 100"),
        "pla": Price(
            amount=19.99, unit="kg", month="2023-05", source="parts list of SCUTTLE mini (D. Malawey): filament, 1 kg"
        ),
        "flexible filament": Price(
            amount=41.99, unit="kg", source="slicer profile of a TPU of 95 Shore A (BambuStudio): price of a kilogram"
        ),
        "foam": Price(amount=40.0, unit="kg", pack=0.5),
        "silicone": Price(amount=SILICONE_PRICE, unit="kg"),
        "release": Price(
            amount=12.8,
            unit="can",
            source="a model maker's notes (D. Neat): wax release spray, 10 GBP for 400 ml at Tiranti, at 1.28 USD",
        ),
        "glue": Price(amount=15.0, unit="can"),
        "sealer": Price(amount=8.0, unit="can"),
        "clay": Price(amount=8.0, unit="pack"),
        "plastic glue": Price(amount=5.0, unit="tube"),
        "bolts": Price(amount=0.25),
        "rod": Price(amount=1.0, unit="m", pack=0.3),
        "skin": Price(amount=8.0),
        "wire": Price(amount=2.0, unit="m"),
        "soft part": Price(amount=40.0, unit="kg", pack=0.1),
        "stiff part": Price(amount=20.0, unit="kg", pack=0.1),
    }
)
"""By key; none is younger than its month says, and those without a source are guesses: ask your shop."""


class BillGroup(StrEnum):
    """Group of items of the bill."""

    BODY = "body"
    CABLES = "cables"
    WINCHES = "winches"
    CONTROL = "control"
    MOULD = "mold"


@dataclass(frozen=True, kw_only=True)
class Item:
    """Item of the bill."""

    group: BillGroup  # group that its costs are added to
    what: str  # is bought
    specification: str  # kind or size
    quantity: float  # in the unit of its price
    price: Price  # price of one unit
    mass: float | None = None  # total mass [g]; None if it is unknown
    is_tool: bool = False  # True for a tool, of which a robot uses up nothing
    is_poured: bool = False  # True for foam or silicone of the body
    is_named_by_kind: bool = False  # True if the sheet names it by the beginning of its specification
    search: str = ""  # words that find it in a shop

    @property
    def cost(self) -> float:
        """Cost of what is used up, in the currency of its price."""
        return 0.0 if self.is_tool else self.quantity * self.price.amount

    @property
    def cost_packs(self) -> float:
        """Cost of the whole packs, in the currency of its price."""
        return self.price.of_packs(self.quantity)


def cost_of(items: Iterable[Item], group: BillGroup | None = None) -> float:
    """Cost of what is used up of all items, or of those of a group."""
    return sum(item.cost for item in items if group in (None, item.group))


@dataclass(frozen=True, kw_only=True)
class BillRow:
    """Line of the bill: an item, or the total of a group or of all."""

    group: Annotated[str, text_column("group")]
    what: Annotated[str, text_column("what")]
    spec: Annotated[str, text_column("specification")] = ""
    search: Annotated[str, text_column("search for")] = ""
    amount: Annotated[float | None, number_column("quantity", decimals=2)] = None
    unit: Annotated[str, text_column("unit")] = ""
    mass: Annotated[float | None, number_column("mass", "g")]
    price: Annotated[float | None, number_column("price", "USD", decimals=2)] = None
    cost_used: Annotated[float, number_column("used up", "USD", decimals=2)]
    cost_packs: Annotated[float, number_column("in whole packs", "USD", decimals=2)]
    source: Annotated[str, text_column("source of the price")] = ""
    short_name: str  # name on the sheet
    is_total: bool = False  # True for a sum of other rows


def bill_table(items: tuple[Item, ...], notes: tuple[str, ...] = ()) -> Table[BillRow]:
    """The bill, with totals of the groups and of all (InputError: a price not in USD: currencies cannot be added)."""
    for item in items:
        if item.price.currency != "USD":
            raise InputError(f"the price of {item.what} must be in USD, not {item.price.currency}")
    rows: list[BillRow] = []
    for group in dict.fromkeys(item.group for item in items):
        mine = [item for item in items if item.group == group]
        rows += [_item_row(item) for item in mine]
        rows.append(_total_row(group, mine))
    rows.append(_total_row("all", items))
    return Table(
        name="bill_of_materials",
        title="Bill of materials",
        row=BillRow,
        rows=tuple(rows),
        notes=(
            "Quantities are what one robot takes, without waste. Used up: that share of the packs; in whole packs: "
            "what a first robot costs.",
            "Prices are rough: those with a source were true then and there, the others are guesses.",
            *notes,
        ),
    )


def _item_row(item: Item) -> BillRow:
    kind = item.specification.partition(",")[0] if item.is_named_by_kind else ""
    return BillRow(
        group=item.group,
        what=item.what,
        spec=item.specification,
        search=item.search,
        amount=item.quantity,
        unit=item.price.unit,
        mass=item.mass,
        price=item.price.amount,
        cost_used=item.cost,
        cost_packs=item.cost_packs,
        source=item.price.words,
        short_name=kind or item.what,
    )


def _total_row(group: str, items: Iterable[Item]) -> BillRow:
    """Total of a group of items; their masses as far as they are known."""
    items = tuple(items)
    return BillRow(
        group=group,
        what="total",
        mass=float(sum(item.mass or 0.0 for item in items)),
        cost_used=cost_of(items),
        cost_packs=float(sum(item.cost_packs for item in items)),
        short_name="total",
        is_total=True,
    )
