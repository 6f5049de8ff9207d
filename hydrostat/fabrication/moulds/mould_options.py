"""`MouldOptions`: how a mould is made."""

import math
from dataclasses import dataclass
from enum import StrEnum

from hydrostat.errors import InputError


class MouldKind(StrEnum):
    """What the mould is made of."""

    PRINTED = "printed"
    SILICONE = "silicone"


@dataclass(frozen=True, kw_only=True)
class MouldOptions:
    """How a mould is made; lengths in millimetres.

    Attributes:
        kind: printed halves, or silicone cast round a printed positive (R52).
        wall: least thickness round the body [mm].
        bed: largest piece that the printer takes, along x, y and z [mm].
        key_clearance: between a key and its socket, on each side [mm].
        pocket_clearance: between a winch in the body and the foam, on each side [mm].
        mark_cables: dents in the foam show where cables run.
        mark_depth: cable points that lie no deeper below the surface are marked [mm].

    Raises:
        InputError: a length that is not above 0; a clearance of pockets may be 0.
    """

    kind: MouldKind = MouldKind.PRINTED
    wall: float = 8.0
    bed: tuple[float, float, float] = (220.0, 220.0, 250.0)
    key_clearance: float = 0.2
    pocket_clearance: float = 1.0
    mark_cables: bool = True
    mark_depth: float = 10.0

    def __post_init__(self) -> None:
        sizes = {"wall": self.wall, "key_clearance": self.key_clearance, "mark_depth": self.mark_depth}
        sizes |= {f"bed[{axis}]": side for axis, side in enumerate(self.bed)}
        for name, size in sizes.items():
            if not (math.isfinite(size) and size > 0):
                raise InputError(f"{name} must be above 0 mm, not {size:g} mm")
        if not (math.isfinite(self.pocket_clearance) and self.pocket_clearance >= 0):
            raise InputError(f"pocket_clearance must not be below 0 mm, not {self.pocket_clearance:g} mm")
