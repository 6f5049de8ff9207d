"""`PatternOptions`: how a pattern is drawn."""

import math
from dataclasses import dataclass, fields
from enum import StrEnum

from hydrostat.errors import InputError

_SHORTEST = 50.0
"""A piece of the gusset that is still worth sewing [mm]."""


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
        gusset: whether a strip of cloth between front and back makes the body as thick as it was simulated. None: where
            two panels alone, stuffed, would stay thinner. A limb that is thinner than simulated is softer, holds less
            cable, and is harder to turn right side out; the price is a second seam round the body.
        gusset_piece: longest piece of that strip, its seam allowances not counted [mm].
        force: draw what cannot be cut honestly all the same; `Pattern.problems` then says what.

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
    gusset: bool | None = None
    gusset_piece: float = 400.0
    force: bool = False

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, float | int) and not (math.isfinite(value) and value >= 0):
                raise InputError(f"{item.name} must not be negative, not {value:g} mm")
        if not self.pinhole > 0:
            raise InputError(f"pinhole must be above 0, not {self.pinhole:g} mm")
        if self.gusset_piece < _SHORTEST:
            raise InputError(f"gusset_piece must be at least {_SHORTEST:g} mm, not {self.gusset_piece:g} mm")
