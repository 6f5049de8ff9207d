"""`PatternOptions`: how a pattern is drawn."""

import math
from dataclasses import dataclass, fields
from enum import StrEnum

from hydrostat.errors import InputError


class Corner(StrEnum):
    """How the cut goes round an outward corner of the seam."""

    ROUND = "round"
    MITRE = "mitre"


@dataclass(frozen=True, kw_only=True)
class PatternOptions:
    """How a pattern is drawn; lengths in millimetres, as everywhere in fabrication.

    Attributes:
        seam_allowance: cloth between the seam and the cut [mm].
        corner: how the cut goes round an outward corner.
        pinhole: diameter of the hole for a cable [mm].
        cloth: least cloth between a pinhole and the seam [mm].
        gap: between the panels, and round the sheet [mm].
        back_pinholes: whether the back panel gets the pinholes too, mirrored.
        marker_names: whether markers are drawn, with their names.
        opening_reach: how far the opening goes beyond the outermost winches [mm]; 0 for no opening.
        force: draw what cannot be cut honestly all the same, and warn in `Pattern.warnings`.

    Raises:
        InputError: a length out of its range.
    """

    seam_allowance: float = 8.0
    corner: Corner = Corner.ROUND
    pinhole: float = 2.0
    cloth: float = 1.5
    gap: float = 10.0
    back_pinholes: bool = False
    marker_names: bool = False
    opening_reach: float = 30.0
    force: bool = False

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, float | int) and not (math.isfinite(value) and value >= 0):
                raise InputError(f"{item.name} must not be negative, not {value:g} mm")
        if not self.pinhole > 0:
            raise InputError(f"pinhole must be above 0, not {self.pinhole:g} mm")
