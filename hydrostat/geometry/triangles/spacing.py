"""How far apart nodes should be: along the outline from its bends and widths, inside from the outline."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree
from shapely import Polygon, contains_xy

from hydrostat.arrays import Vector
from hydrostat.geometry.curve import Curve, Stations

GROWTH = 0.3
"""How much the spacing may grow for each unit of distance."""

_STEP = 1 / 12
_BEND_REACH = 1 / 6
_BEND = 0.7  # a chord of length s leaves a circle of radius r by s^2 / 8r: less than 0.09
_LEAST_BEND = 0.35


@dataclass(frozen=True, eq=False)
class Spacing:
    """Wanted distance of nodes at any place, in units of the element size; 1 far from what is fine.

    Attributes:
        places: where a finer spacing is known.
        values: the spacing there.
    """

    places: Float[np.ndarray, "places 2"]
    values: Float[np.ndarray, " places"]

    def __call__(self, points: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, " points"]:
        """Wanted distance of neighbours at some points."""
        fine = np.flatnonzero(self.values < 0.999)
        wanted = np.ones(len(points))
        for part in np.array_split(np.arange(len(points)), 1 + len(points) * len(fine) // 2_000_000):
            if fine.size and part.size:
                reach = np.linalg.norm(points[part, None] - self.places[fine], axis=2)
                wanted[part] = np.minimum(1.0, (self.values[fine] + GROWTH * reach).min(axis=1))
        return wanted


@dataclass(frozen=True, eq=False)
class Samples:
    """The rings of an outline, finely and evenly sampled, in units of the element size.

    Attributes:
        places: (samples, 2).
        inward: unit normals into the body, (samples, 2).
        rings: ring of each sample.
        stations: arc length of each sample on its ring.
        bends: spacing that the bend of the ring allows.
    """

    places: Float[np.ndarray, "samples 2"]
    inward: Float[np.ndarray, "samples 2"]
    rings: Float[np.ndarray, " samples"]
    stations: Float[np.ndarray, " samples"]
    bends: Float[np.ndarray, " samples"]


def sample(curves: tuple[Curve, ...], corners: tuple[Stations, ...]) -> Samples:
    """Sample rings; `corners` are the stations of the true corners, whose bend does not count."""
    parts = []
    for ring, (curve, sharp) in enumerate(zip(curves, corners, strict=True)):
        count = max(16, int(np.ceil(curve.length / _STEP)))
        stations = np.arange(count) * (curve.length / count)
        tangents = curve.tangents(stations, min(_STEP, curve.length / 16))
        reach = min(_BEND_REACH, curve.length / 12)
        bend = np.abs(curve.turned(stations, reach)) / (2 * reach)
        if sharp.size:
            gaps = np.abs(stations[:, None] - sharp)
            bend[np.minimum(gaps, curve.length - gaps).min(axis=1) <= 1.2 * reach] = 0.0
        bends = np.clip(np.sqrt(_BEND / np.maximum(bend, 1e-9)), _LEAST_BEND, 1.0)
        inward = np.column_stack([-tangents[:, 1], tangents[:, 0]])
        parts.append((curve.at(stations), inward, np.full(count, float(ring)), stations, bends))
    return Samples(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def widths(samples: Samples, curves: tuple[Curve, ...], polygon: Polygon) -> tuple[Vector, Vector]:
    """How wide the body is at each sample, at most 1, and the same without pointed tips.

    Two samples span a width if they face each other through the body and the way between them along the outline is
    long compared with it, which it is not across a tip or a corner.
    """
    width, neck = np.ones(len(samples.places)), np.ones(len(samples.places))
    pairs = KDTree(samples.places).query_pairs(1.0, output_type="ndarray")
    first, second = pairs[:, 0], pairs[:, 1]
    across = samples.places[second] - samples.places[first]
    distance = np.linalg.norm(across, axis=1)
    facing = np.einsum("ij,ij->i", across, samples.inward[first]) > 0.7 * distance
    facing &= np.einsum("ij,ij->i", across, samples.inward[second]) < -0.7 * distance
    first, second, distance = first[facing], second[facing], distance[facing]
    middle = 0.5 * (samples.places[first] + samples.places[second])
    inside = contains_xy(polygon, middle[:, 0], middle[:, 1])
    first, second, distance = first[inside], second[inside], distance[inside]
    lengths = np.array([curve.length for curve in curves])[samples.rings[first].astype(int)]
    way = np.abs(samples.stations[first] - samples.stations[second])
    way = np.where(samples.rings[first] == samples.rings[second], np.minimum(way, lengths - way), np.inf)
    for least, result in ((np.maximum(4.0 * distance, 1.0), width), (2.0, neck)):
        real = way > least
        np.minimum.at(result, first[real], distance[real])
        np.minimum.at(result, second[real], distance[real])
    return width, neck
