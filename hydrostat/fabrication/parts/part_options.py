"""`PartOptions`: how printed parts are made."""

import math
from dataclasses import dataclass, fields

from hydrostat.errors import InputError


@dataclass(frozen=True, kw_only=True)
class PartOptions:
    """Sizes that depend on the printer and on what is bought; lengths in millimetres.

    Attributes:
        clearance: between parts that move in each other, on each side [mm].
        fit: between parts that are put into each other and stay, on each side [mm].
        wall: least thickness of a wall [mm].
        cable: diameter of the cable, a braided line [mm].
        tube: outer diameter of the PTFE sheath [mm].
        bore: inner diameter of the sheath [mm].
        run: how far in front of the base for winches outside a body can stand [mm].
        spare_wraps: turns of cable that stay on a spool when it is let out as far as it may be.

    Raises:
        InputError: a number out of its range.
    """

    clearance: float = 0.3
    fit: float = 0.15
    wall: float = 1.6
    cable: float = 0.4
    tube: float = 2.0
    bore: float = 1.0
    run: float = 100.0
    spare_wraps: float = 2.0

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not (math.isfinite(value) and value >= 0):
                raise InputError(f"{item.name} must not be negative, not {value:g}")
        for name in ("wall", "cable", "tube", "bore"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} must be above 0 mm, not {getattr(self, name):g} mm")
        if not self.cable < self.bore < self.tube:
            raise InputError(
                f"cable {self.cable:g} mm, bore {self.bore:g} mm and tube {self.tube:g} mm must rise: "
                "the cable runs in the bore of the tube"
            )
