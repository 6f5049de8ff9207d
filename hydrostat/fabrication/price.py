"""`Price`: what something costs, roughly, and where that is from."""

import math
from dataclasses import dataclass

from hydrostat.errors import InputError

NO_SOURCE = "estimate, no source"


@dataclass(frozen=True, kw_only=True)
class Price:
    """A rough price.

    Attributes:
        amount: in its currency, of one unit.
        unit: what it is of, such as "m" or "kg".
        pack: in how many units it is sold.
        month: when it was asked or noted; empty if the source has no date.
        source: where it is from, in words.
        currency: its code.

    Raises:
        InputError: an amount below 0, or a pack of nothing.
    """

    amount: float
    unit: str = "piece"
    pack: float = 1.0
    month: str = ""
    source: str = NO_SOURCE
    currency: str = "USD"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.amount) and self.amount >= 0):
            raise InputError(f"amount must be at least 0 {self.currency}, not {self.amount:g}")
        if not (math.isfinite(self.pack) and self.pack > 0):
            raise InputError(f"pack must be above 0 {self.unit}, not {self.pack:g}")

    @property
    def words(self) -> str:
        """Where it is from and when."""
        if self.source == NO_SOURCE:
            return NO_SOURCE
        return f"rough, from {self.source}; {self.month or 'no date'}"

    def packs(self, quantity: float) -> int:
        """How many packs hold a quantity."""
        return math.ceil(quantity / self.pack - 1e-9)

    def of_packs(self, quantity: float) -> float:
        """Cost of the packs that hold a quantity."""
        return self.packs(quantity) * self.pack * self.amount
