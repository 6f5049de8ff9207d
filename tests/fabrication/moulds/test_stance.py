"""High points: oracles are shapes whose tops are known."""

import numpy as np
from manifold3d import Manifold

from hydrostat.fabrication.moulds.stance import high_points
from hydrostat.fabrication.solids.printed import triangles_of

UP = np.array([0.0, 1.0, 0.0])


def tops(solid: Manifold, rise: float = 1.0) -> np.ndarray:
    vertices, triangles = triangles_of(solid)
    return vertices[high_points(vertices, triangles, UP, rise=rise)]


def fingers(*heights: float) -> Manifold:
    hand = Manifold.cube((20 * len(heights), 30, 16)).translate((0, 0, -8))
    for place, height in enumerate(heights):
        tip = Manifold.sphere(7, 48)
        finger = Manifold.batch_hull([tip, tip.translate((0, height, 0))])
        hand = hand + finger.translate((20 * place + 10, 30, 0))
    return hand


def test_each_finger_is_a_high_point_the_highest_first() -> None:
    found = tops(fingers(40, 60, 50))
    assert np.allclose(found, [[30, 97, 0], [50, 87, 0], [10, 77, 0]], atol=0.5)


def test_a_bump_lower_than_a_bubble_is_none() -> None:
    bump = Manifold.cube((40, 20, 20)) + Manifold.cube((4, 1, 4)).translate((3, 19.6, 3))
    assert len(tops(bump, rise=1.0)) == 1
    assert len(tops(bump + Manifold.cube((4, 3, 4)).translate((30, 19, 3)), rise=1.0)) == 1
    two = Manifold.cube((40, 20, 20)) + Manifold.cube((4, 5, 4)).translate((3, 19, 3))
    assert len(tops(two + Manifold.cube((4, 3, 4)).translate((30, 19, 3)), rise=1.0)) == 2


def test_a_dimple_from_below_holds_no_air() -> None:
    dimpled = Manifold.cube((40, 40, 40), True) - Manifold.sphere(10, 32).translate((0, -20, 0))
    assert len(tops(dimpled)) == 1


def test_a_room_with_two_domes_has_two() -> None:
    domes = Manifold.sphere(10, 32) + Manifold.sphere(10, 32).translate((15, 0, 0))
    assert len(tops(domes)) == 2
