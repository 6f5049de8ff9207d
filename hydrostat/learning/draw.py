"""`SamplingScheme`: the ways in which contractions are drawn, each by scrambled Sobol points."""

from collections.abc import Sequence
from enum import StrEnum

import numpy as np
from jaxtyping import Float, Int

from hydrostat.arrays import Vector

Rows = Float[np.ndarray, "samples winches"]
Points = Float[np.ndarray, "samples dimensions"]
Winches = Sequence[Sequence[int]]


class SamplingScheme(StrEnum):
    """Distribution of the contractions."""

    BOX = "box"  # each winch between its release and its travel
    ANTAGONIST = "antagonist"  # of two winches that work against one another only one takes in (thesis 5.3.2)
    FACES = "faces"  # as box, but each winch is left at 0 in half of the samples
    TENSION = "tension"  # as box, let out until no cable pulls harder than allowed


def dimensions(draw: SamplingScheme, pairs: Winches, winches: int) -> int:
    """Number of random numbers of a sample."""
    return {SamplingScheme.ANTAGONIST: len(pairs), SamplingScheme.FACES: 2 * winches}.get(draw, winches)


def contractions(draw: SamplingScheme, points: Points, low: Vector, high: Vector, pairs: Winches) -> Rows:
    """Contractions [m] of points in the unit cube.

    Args:
        draw: distribution of the contractions.
        points: (samples, dimensions).
        low: least contraction of each winch [m].
        high: largest [m].
        pairs: winches that work against one another, two by two; those that have no partner alone.
    """
    if draw is SamplingScheme.ANTAGONIST:
        return _against(points, high, pairs)
    box = low + points[:, : len(low)] * (high - low)
    return np.where(points[:, len(low) :] < 0.5, box, 0.0) if draw is SamplingScheme.FACES else box


def shared_numbers(rows: Rows, high: Vector, pairs: Winches) -> Points:
    """Points in the unit cube, (samples, pairs), that give such contractions drawn by `SamplingScheme.ANTAGONIST`."""
    shares = rows / np.where(high > 0, high, 1.0)
    columns = [
        shares[:, one] if not other else 0.5 + 0.5 * (shares[:, one] - shares[:, other[0]]) for one, *other in pairs
    ]
    return np.stack(columns, axis=1)


def antagonists(moves: Float[np.ndarray, "winches coordinates"]) -> tuple[tuple[int, ...], ...]:
    """Winches two by two whose markers go opposite ways, and the others alone: each is the best partner of its partner.

    Args:
        moves: displacements of the markers for the contraction of each winch [m].
    """
    lengths = np.linalg.norm(moves, axis=1, keepdims=True)
    ways = moves / np.where(lengths > 0, lengths, 1.0)
    cosines = ways @ ways.T
    np.fill_diagonal(cosines, 1.0)
    partner: Int[np.ndarray, " winches"] = np.argmin(cosines, axis=1)
    groups: list[tuple[int, ...]] = []
    for winch, other in enumerate(partner):
        paired = partner[other] == winch and cosines[winch, other] < _OPPOSITE
        if not paired:
            groups.append((winch,))
        elif winch < other:
            groups.append((winch, int(other)))
    return tuple(groups)


def _against(points: Points, high: Vector, pairs: Winches) -> Rows:
    """Contractions of which only one of each pair is above 0: the first above the middle, the second below it."""
    rows = np.zeros((len(points), len(high)))
    for column, winches in enumerate(pairs):
        value = points[:, column]
        if len(winches) == 1:
            rows[:, winches[0]] = value * high[winches[0]]
            continue
        one, other = winches
        rows[:, one] = np.maximum(2 * value - 1, 0) * high[one]
        rows[:, other] = np.maximum(1 - 2 * value, 0) * high[other]
    return rows


_OPPOSITE = -0.3
"""Cosine of the ways of markers below which two winches work against one another."""
