"""`arrange_units`: layout of all winch units in a flat body, within its seam and clear of each other if possible."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from hydrostat.arrays import Vector
from hydrostat.fabrication.parts.places import COMPRESSION_SHARE, OVERLAP_TOLERANCE, UnitBox, UnitPlace
from hydrostat.fabrication.solids.construct import sides_text
from hydrostat.units import list_words

_SWEEPS = 8  # rounds of a search


@dataclass(frozen=True, eq=False, kw_only=True)
class LaidUnit:
    """A unit as it is laid in the body."""

    place: UnitPlace  # place and orientation
    problems: tuple[str, ...] = ()  # why it cannot be built well
    is_piled: bool = False  # True if another lies above or below it
    notes: tuple[str, ...] = ()  # information for the builder: a bulge, units one above the other


def arrange_units(boxes: Sequence[UnitBox], seam: BaseGeometry, thickness: float) -> tuple[LaidUnit, ...]:
    """Lay each unit, in their order, within a seam and a thickness [mm], with its problems and notes.

    Each in turn takes the way in which it is within the seam, shares least of the plane with the others, bulges least
    and is moved least, until none changes. Those that still meet lie one above the other, if the body is thick
    enough for that. The last answers are kept: motor, refusals and effort of a network ask for the same.
    """
    return _arrange_units(tuple(boxes), seam, thickness)


@lru_cache(maxsize=128)
def _arrange_units(boxes: tuple[UnitBox, ...], seam: BaseGeometry, thickness: float) -> tuple[LaidUnit, ...]:
    """Lay each unit."""
    ways = [_Ways(box.ways_to_lie(seam), thickness) for box in boxes]
    total, places = _settle_units(ways)
    if total[0] > 0:
        thin = [way.thinnest() if _meets_another(places, number) else way for number, way in enumerate(ways)]
        places = min((total, places), _settle_units(thin), key=lambda pair: pair[0])[1]
    problems, notes = (
        [_alone(place, thickness) for place in places],
        [_bulging(place, thickness) for place in places],
    )
    piled: set[int] = set()
    for pile in _piles(places):
        words, possible = _describe_pile([places[number] for number in pile], thickness)
        piled |= set(pile)
        (notes if possible else problems)[pile[0]].append(words)
    return tuple(
        LaidUnit(place=place, problems=tuple(wrong), is_piled=number in piled, notes=tuple(told))
        for number, (place, wrong, told) in enumerate(zip(places, problems, notes, strict=True))
    )


class _Ways:
    """All ways to lay one unit; `places` are those that are least outside the seam, and not too deep if they can."""

    def __init__(self, places: list[UnitPlace], thickness: float) -> None:
        outside = [round(max(place.outside - OVERLAP_TOLERANCE, 0.0), 3) for place in places]
        deep = [place.depth > (1 + COMPRESSION_SHARE) * thickness for place in places]
        first = min(zip(outside, deep, strict=True))
        self._all = places
        self.places = [place for place, *before in zip(places, outside, deep, strict=True) if tuple(before) == first]
        self._footprints = np.array([place.footprint for place in self.places])
        self._depths = np.array([place.depth for place in self.places])
        self._thickness = thickness
        self._room = (1 + COMPRESSION_SHARE) * thickness
        bulges = np.maximum(self._depths - thickness, 0.0).round(3).tolist()
        self._after = list(zip(bulges, range(len(self.places)), strict=True))
        self._shares: dict[int, tuple[UnitPlace, Vector, Vector]] = {}
        self.alone, _ = self.best([])

    def best(self, others: Sequence[UnitPlace]) -> tuple[UnitPlace, tuple[float, float]]:
        """Return the best place next to others, and the areas shared with them [mm^2]: not stackable, and stackable."""
        hard, soft = np.zeros(len(self.places)), np.zeros(len(self.places))
        for other in others:
            _, without, above = self._overlap_areas(other)
            hard += without
            soft += above
        number = min(
            range(len(self.places)),
            key=lambda way: (float(hard[way]), float(soft[way]), *self._after[way]),
        )
        return self.places[number], (float(hard[number]), float(soft[number]))

    def thinnest(self) -> "_Ways":
        """Those that take the least of the thickness, of those within the seam if there are any."""
        inside = [place for place in self._all if place.outside <= OVERLAP_TOLERANCE] or self._all
        least = min(place.depth for place in inside)
        return _Ways([place for place in inside if place.depth <= least + 1e-9], self._thickness)

    def _overlap_areas(self, other: UnitPlace) -> tuple[UnitPlace, Vector, Vector]:
        """Areas shared with another unit for each placement [mm^2]: where stacking is impossible, and possible."""
        if id(other) not in self._shares:
            near = shapely.intersects(self._footprints, other.footprint)
            area = np.zeros(len(self.places))
            area[near] = shapely.area(shapely.intersection(self._footprints[near], other.footprint))
            area = np.round(np.where(area > OVERLAP_TOLERANCE, area, 0.0), 3)
            above = self._depths + other.depth <= self._room
            self._shares[id(other)] = (other, np.where(above, 0.0, area), np.where(above, area, 0.0))
        return self._shares[id(other)]


def _settle_units(ways: list[_Ways]) -> tuple[tuple[float, float], list[UnitPlace]]:
    """Place each in turn at its best until none changes; return shared areas and places of the best start."""
    found: list[tuple[tuple[float, float], list[UnitPlace]]] = []
    for first in range(len(ways)):
        total, places = _swept(ways, [*range(first, len(ways)), *range(first)])
        if total == (0.0, 0.0):
            return total, places
        found.append((total, places))
    return min(found, key=lambda pair: pair[0]) if found else ((0.0, 0.0), [])


def _swept(ways: list[_Ways], order: Sequence[int]) -> tuple[tuple[float, float], list[UnitPlace]]:
    """Find where all are after some rounds in an order, and what they share."""
    chosen = [way.alone for way in ways]
    hard = soft = 0.0
    for _ in range(_SWEEPS):
        before, hard, soft = list(chosen), 0.0, 0.0
        for number in order:
            chosen[number], shared = ways[number].best([*chosen[:number], *chosen[number + 1 :]])
            hard, soft = hard + shared[0], soft + shared[1]
        if all(one is other for one, other in zip(before, chosen, strict=True)):
            break
    return (hard, soft), chosen


def _meet(places: Sequence[UnitPlace], numbers: Sequence[int]) -> bool:
    """Return True if some units all cover a common part of the plane."""
    return float(shapely.intersection_all([places[number].footprint for number in numbers]).area) > OVERLAP_TOLERANCE


def _meets_another(places: Sequence[UnitPlace], number: int) -> bool:
    return any(_meet(places, (number, other)) for other in range(len(places)) if other != number)


def _piles(places: Sequence[UnitPlace]) -> list[tuple[int, ...]]:
    """Units that lie above each other, the largest piles only."""
    piles: list[tuple[int, ...]] = []
    grown = [(number,) for number in range(len(places))]
    while grown:
        more = [
            (*pile, number)
            for pile in grown
            for number in range(pile[-1] + 1, len(places))
            if _meet(places, (*pile, number))
        ]
        piles = [pile for pile in piles if not any(set(pile) < set(larger) for larger in more)] + more
        grown = more
    return piles


def _describe_pile(pile: Sequence[UnitPlace], thickness: float) -> tuple[str, bool]:
    """Return the sentence on units above each other, and True if they can be built."""
    high = sum(place.depth for place in pile)
    names = list_words(f'"{place.box.winch}"' for place in pile) + _sizes(pile)
    possible = high <= (1 + COMPRESSION_SHARE) * thickness
    if possible:
        bulge = f", so it bulges by {high - thickness:.0f} mm" if high > thickness else ""
        return (
            f"the units of winches {names} overlap in every tested place. Lay them one above the other, "
            f"{high:.0f} mm in a body of {thickness:.0f} mm{bulge}",
            True,
        )
    return (
        f"the units of winches {names} overlap in every tested place, and one above the other they need "
        f"{high:.0f} mm in a body of {thickness:.0f} mm. Move the winches apart or choose smaller motors",
        False,
    )


def _sizes(pile: Sequence[UnitPlace]) -> str:
    """Sizes of units, and for two the distance between their winches, in brackets."""
    sides = [sides_text(place.box.size) for place in pile]
    alike = len(set(sides)) == 1
    apart = f", {math.dist(pile[0].box.at, pile[1].box.at):.0f} mm apart" if len(pile) == 2 else ""
    return f" ({sides[0]} mm each{apart})" if alike else f" ({list_words(sides)} mm{apart})"


def _alone(place: UnitPlace, thickness: float) -> list[str]:
    """Return the reasons why a unit cannot be built well, even alone."""
    found = []
    if place.outside > OVERLAP_TOLERANCE:
        share = 100 * place.outside / place.footprint.area
        words = f"{share:.0f}" if share >= 1 else "less than 1"
        found.append(
            f"{place.box.words} does not fit within the seam at any angle ({words} % outside). Move the winch inwards "
            "or choose a smaller motor or spool"
        )
    if place.depth > (1 + COMPRESSION_SHARE) * thickness:
        found.append(
            f"{place.box.words} needs {place.depth:.0f} mm in a body of {thickness:.0f} mm, which bulges by "
            f"{100 * COMPRESSION_SHARE:.0f} % at most. Choose a smaller motor or spool, or a thicker body"
        )
    return found


def _bulging(place: UnitPlace, thickness: float) -> list[str]:
    if not thickness + 0.5 <= place.depth <= (1 + COMPRESSION_SHARE) * thickness:  # mm
        return []
    return [
        f"{place.box.words} is thicker than the body of {thickness:.0f} mm, which will bulge by "
        f"{place.depth - thickness:.0f} mm. Choose a smaller motor or spool, or a thicker body"
    ]
