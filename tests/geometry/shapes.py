"""Outlines to mesh, made in code; lengths in millimeters here, meters in the outlines."""

import numpy as np
from shapely import LineString, Point, Polygon, box
from shapely.affinity import rotate

from hydrostat.geometry import Outline


def outline(polygon: Polygon) -> Outline:
    """The outline [m] of a polygon [mm]."""
    rings = [1e-3 * np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
    return Outline(rings[0], tuple(rings[1:]))


def disc(radius: float, x: float = 0.0, y: float = 0.0) -> Polygon:
    """A disc as a polygon of 256 corners."""
    return Point(x, y).buffer(radius, quad_segs=64)


def _star() -> Polygon:
    arm = LineString([(0, 0), (0, 90)]).buffer(11, quad_segs=32)
    arms = arm
    for number in range(1, 5):
        arms = arms.union(rotate(arm, 72 * number, origin=(0, 0)))
    return arms.buffer(6).buffer(-12).buffer(6)


def _letter_s() -> Polygon:
    way = np.linspace(0, 1, 200)
    return LineString(np.column_stack([40 * np.sin(2 * np.pi * way), 120 * way])).buffer(12, quad_segs=32)


def _letter_e() -> Polygon:
    bars = [box(0, 0, 90, 25), box(0, 57, 80, 82), box(0, 115, 90, 140)]
    return box(0, 0, 25, 140).union(bars[0]).union(bars[1]).union(bars[2])


SHAPES = {
    "star": (_star(), 12),
    "letter e": (_letter_e(), 10),
    "letter s": (_letter_s(), 8),
    "annulus": (disc(50).difference(disc(25)), 10),
    "l": (box(0, 0, 100, 30).union(box(0, 0, 30, 100)), 10),
    "dumbbell": (disc(30, -50).union(disc(30, 50)).union(box(-50, -2.5, 50, 2.5)), 10),
    "hole near edge": (disc(60).difference(disc(4, 52)), 10),
    "triangle": (Polygon([(0, 0), (100, 0), (50, 86.6)]), 9),
    "slot": (box(0, 0, 100, 60).difference(box(48, 20, 49, 61)), 10),
    "two holes": (box(0, 0, 120, 50).difference(disc(12, 30, 25)).difference(disc(2, 90, 25)), 8),
}
"""Name: polygon [mm], element size [mm]."""


def crossing_bars(seed: int) -> tuple[Polygon, float]:
    """Bars of random width through one disc [mm], which cross at awkward angles, and an element size [mm]."""
    random = np.random.default_rng(seed)
    shape = disc(30)
    for _ in range(random.integers(2, 7)):
        width, length, angle = random.uniform(6, 30), random.uniform(30, 100), random.uniform(0, 360)
        shape = shape.union(rotate(box(0, -width / 2, length, width / 2), angle, origin=(0, 0)))
    return shape, random.uniform(5, 15)


def blob(seed: int) -> tuple[Polygon, float]:
    """A random smooth blob [mm] and an element size [mm] for it."""
    random = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radius = np.full(400, 80.0)
    for wave in range(2, 9):
        radius += random.normal() * 15 / wave**0.8 * np.cos(wave * angle + random.uniform(0, 2 * np.pi))
    radius = np.maximum(radius, 20.0)
    return Polygon(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])), random.uniform(7, 14)
