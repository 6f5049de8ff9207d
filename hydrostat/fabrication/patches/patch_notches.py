"""Notches of seams: where they are, their letters, and the stretch that stays open for turning."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from string import ascii_uppercase

import numpy as np

from hydrostat.fabrication.patches.seams import Seam
from hydrostat.fabrication.patterns.shape import Place

_SPACING = 60.0
"""About how far apart notches are along a seam [mm]."""

_SHORTEST = 10.0
"""A seam shorter than that [mm] needs no notch."""

_PAIR = 5.0
"""How far apart the strokes of a double notch are [mm]."""

_STUFFING = 80.0
"""Length of seam left open for turning and stuffing where there is no zipper [mm], about."""


@dataclass(frozen=True, kw_only=True)
class PatchNotch:
    """A mark by which two patches are matched.

    Attributes:
        name: the same letters on both; empty for the second stroke of a double notch.
        place: on the seam line [mm].
    """

    name: str
    place: Place


def _letters() -> Iterator[str]:
    """A, B, ... Z, AA, AB, ..."""
    yield from ascii_uppercase
    for first in _letters():
        yield from (first + second for second in ascii_uppercase)


def _steps(seam: Seam) -> list[tuple[float, bool]]:
    """How far along a seam its notches are [mm], and whether each has a letter."""
    if seam.length < _SHORTEST:
        return []
    if not seam.closed:
        count = max(1, round(seam.length / _SPACING) - 1)
        return [(seam.length * (step + 1) / (count + 1), True) for step in range(count)]
    count = max(4, round(seam.length / _SPACING))
    return [(0.0, True), (_PAIR, False), *((seam.length * step / count, True) for step in range(1, count))]


def _named(seams: tuple[Seam, ...]) -> list[list[tuple[str, float]]]:
    """Letters and places of the notches of each seam."""
    letters = _letters()
    return [[(next(letters) if lettered else "", along) for along, lettered in _steps(seam)] for seam in seams]


def patch_notches(seams: tuple[Seam, ...]) -> dict[int, list[PatchNotch]]:
    """The notches of each patch: at the same place of the body on both sides of a seam."""
    found: dict[int, list[PatchNotch]] = {number: [] for seam in seams for number in seam.patches}
    for seam, named in zip(seams, _named(seams), strict=True):
        for side, number in enumerate(seam.patches):
            found[number] += [PatchNotch(name=name, place=seam.place(along, side)) for name, along in named]
    return found


def stuffing_gap(seams: tuple[Seam, ...], names: tuple[str, ...]) -> tuple[str, ...]:
    """Where a body without a zipper is turned and stuffed, in words."""
    lengths = [seam.length for seam in seams]
    longest = int(np.argmax(lengths))
    seam, named = seams[longest], [notch for notch in _named(seams)[longest] if notch[0]]
    if len(named) < 2:
        return ("no seam is long enough to turn the body through: close the last one by hand",)
    first, second = min(pairwise(named), key=lambda pair: (abs(pair[1][1] - pair[0][1] - _STUFFING), pair[0][1]))
    one, other = (names[number] for number in seam.patches)
    return (
        f"leave the seam between {one} and {other} open from notch {first[0]} to notch {second[0]} "
        f"({second[1] - first[1]:.0f} mm): turn and stuff the body through it, then close it by hand",
    )
