"""`sheathed_segments`, `sheaths`: which segments of a cable run in a sheath."""

from collections.abc import Collection

import numpy as np

from hydrostat.robot import Cable


def sheathed_segments(cable: Cable) -> list[int]:
    """Numbers of the segments in a sheath, counted from 0 at the winch."""
    return np.flatnonzero(~cable.bare).tolist()


def sheaths(segments: Collection[int]) -> tuple[tuple[int, int], ...]:
    """Pairs of point indices for `Cable.sheathed`; segments in a row are one sheath."""
    pairs: list[tuple[int, int]] = []
    for segment in sorted(set(segments)):
        if pairs and pairs[-1][1] == segment:
            pairs[-1] = (pairs[-1][0], segment + 1)
        else:
            pairs.append((segment, segment + 1))
    return tuple(pairs)
