"""Keys, bolt holes and pry slots of a mold, all in the rim round the cavity.

In the coordinates of the mold: x across, y upwards as it stands when poured, z along the pull, parted at z = 0.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from manifold3d import Manifold

from hydrostat.fabrication.moulds.openings import Sprue
from hydrostat.fabrication.moulds.solids import join_solids, rod
from hydrostat.fabrication.solids.construct import Cuboid

RIM = 13.0  # least width of the rim round the cavity [mm]: a key or a bolt with walls on both sides
INSET = 6.5  # from the outer side of the rim to the middle of keys and bolts [mm]
BOLT = 2.25  # radius of a hole for an M4 bolt or threaded rod [mm]

_ROOT = 1.0
_GAP = 2.0

Spot = tuple[float, float]  # a place in the parting plane [mm]


@dataclass(frozen=True)
class MoldBlock(Cuboid):
    """Outside of a mold [mm]."""

    x_cuts: tuple[float, ...] = ()  # places of cuts across x that make it fit the printer
    y_cuts: tuple[float, ...] = ()  # places of cuts across y

    @property
    def solid(self) -> Manifold:
        """All of it."""
        return Manifold.cube(self.size).translate(self.low)


@dataclass(frozen=True, eq=False, kw_only=True)
class Closing:
    """Keys, bolts and slots by which the halves meet."""

    # middles and radii of the keys [mm]; one is smaller, so that the halves fit one way round
    keys: tuple[tuple[Spot, float], ...]
    bolts: tuple[Spot, ...]  # middles of the bolt holes [mm]
    bumps: Manifold  # on the lower half, reaching a little into it
    sockets: Manifold  # solid that is removed from the upper half
    holes: Manifold  # all bolt holes
    slots: Manifold  # for a flat tool, in the upper half


def make_closing(block: MoldBlock, *, sprue: Sprue | None, vents: tuple[float, ...], clearance: float) -> Closing:
    """Keys at the corners with a clearance on each side [mm], bolts along the sides, slots to pry at left and right.

    Bolts keep off the sprue's funnel and off `vents`, the x of what leaves through the top [mm].
    """
    (left, bottom, low), (right, top, high) = block.low, block.high
    xs, ys = (left + INSET, right - INSET), (bottom + INSET, top - INSET)
    key = 4.0
    odd_key = 3.0
    keys = tuple(((x, y), odd_key if (x, y) == (xs[1], ys[1]) else key) for x in xs for y in ys)
    rows = [(x, y) for y in _bolt_places(bottom, top, block.y_cuts) for x in xs]
    taken = [(vent, BOLT) for vent in vents] + ([] if sprue is None else [(sprue.x, sprue.funnel)])
    free = [_beside(x, taken) for x in _bolt_places(left, right, block.x_cuts)]
    rows += [(x, ys[0]) for x in _bolt_places(left, right, block.x_cuts)]
    rows += [(x, ys[1]) for x in free if left + 4 * INSET < x < right - 4 * INSET]
    bolts = tuple(sorted(rows))
    return Closing(
        keys=keys,
        bolts=bolts,
        bumps=join_solids([_key(spot, radius, 0.0) for spot, radius in keys]),
        sockets=join_solids([_key(spot, radius, clearance) for spot, radius in keys]),
        holes=join_solids([rod(np.array([x, y, low - 1.0]), np.array([x, y, high + 1.0]), BOLT) for x, y in bolts]),
        slots=join_solids([_slot(block, side, [y for x, y in bolts if x == xs[side]]) for side in (0, 1)]),
    )


def _bolt_places(low: float, high: float, cuts: tuple[float, ...]) -> list[float]:
    """Places along a side, evenly within each piece between two cuts."""
    found = []
    pitch = 110.0  # bolts are no further apart [mm]
    for start, end in pairwise((low, *cuts, high)):
        count = max(int(np.ceil((end - start) / pitch)), 1)
        found += [start + (end - start) * (step + 0.5) / count for step in range(count)]
    return found


def _beside(x: float, taken: list[tuple[float, float]]) -> float:
    """The nearest place to x that keeps off what is in the top rim."""
    shifts = sorted((step * 1.0 for step in range(-60, 61)), key=lambda shift: (abs(shift), shift))
    for shift in shifts:
        if all(abs(x + shift - other) >= radius + BOLT + _GAP for other, radius in taken):
            return x + shift
    return -np.inf


def _key(spot: Spot, radius: float, clearance: float) -> Manifold:
    """A key, or with a clearance its socket, as high as it is above the plane and rooted below it."""
    key_height = 4.0
    wide, height = radius + clearance, key_height + clearance
    root = rod(np.array([*spot, -_ROOT]), np.array([*spot, 0.0]), wide)
    taper = 0.8
    return root + rod(np.array([*spot, 0.0]), np.array([*spot, height]), wide, taper * radius + clearance)


def _slot(block: MoldBlock, side: int, bolts: list[float]) -> Manifold:
    """Slot for a screwdriver at a side, half way between two bolts or a bolt and a key."""
    slot = (6.0, 16.0, 2.5)
    depth, length, height = slot
    marks = sorted([block.low[1] + INSET, *bolts, block.high[1] - INSET])
    gaps = [(end - start, (start + end) / 2) for start, end in pairwise(marks)]
    clear = [
        (gap, middle) for gap, middle in gaps if all(abs(middle - cut) > length / 2 + _GAP for cut in block.y_cuts)
    ] or gaps
    middle = max(clear)[1]
    x = block.low[0] - 1.0 if side == 0 else block.high[0] - depth
    return Manifold.cube((depth + 1.0, length, height)).translate((x, middle - length / 2, 0.0))
