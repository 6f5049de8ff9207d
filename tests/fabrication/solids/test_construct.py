"""Constructions against closed forms."""

import math

import numpy as np
import pytest

from hydrostat.fabrication.solids.construct import Box, Construction, Cylinder, Prism, Revolve, segments, solid_of
from hydrostat.fabrication.solids.printed import triangles_of

ROUND_ERROR = 2 * 0.02
"""A polygon that is nowhere more than 0.02 mm from its circle has an area too small by less than 2 x 0.02 / radius."""

LETTER = ((0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0))
RING = ((5.0, 0.0), (8.0, 0.0), (8.0, 2.0), (5.0, 2.0))

FLAT = [
    (Box((2, 3, 4)), 24.0),
    (Prism(LETTER, 2), 12.0),
    (Box((4, 4, 4)) - Box((2, 2, 9)).move(1, 1, -1), 48.0),
    (Box((4, 4, 4)) + Box((4, 4, 4)).move(2, 0, 0), 96.0),
    (Box((4, 4, 4)) & Box((4, 4, 4)).move(3, 3, 3), 1.0),
]

ROUND = [
    (Cylinder(5, 2), math.pi * 4 * 5, 2.0),
    (Cylinder(6, 3, 1), math.pi * 6 * (9 + 3 + 1) / 3, 3.0),
    (Cylinder(6, 3, 0), math.pi * 6 * 9 / 3, 3.0),
    (Revolve(RING), 2 * math.pi * 6.5 * 6.0, 5.0),
    (Box((20, 20, 3)) - Cylinder(9, 4).move(10, 10, -1), 1200 - math.pi * 16 * 3, 4.0),
]


@pytest.mark.parametrize(("construction", "volume"), FLAT)
def test_volumes_of_what_is_flat(construction: Construction, volume: float):
    """Oracle: closed forms, to the grid on which profiles are kept."""
    assert solid_of(construction).volume() == pytest.approx(volume, rel=1e-8)


@pytest.mark.parametrize(("construction", "volume", "radius"), ROUND)
def test_volumes_of_what_is_round(construction: Construction, volume: float, radius: float):
    """Oracle: closed forms, of the turning by Pappus; polygons lie within their circles."""
    measured = solid_of(construction).volume()
    assert measured != volume
    assert measured == pytest.approx(volume, rel=ROUND_ERROR / radius)


@pytest.mark.parametrize("radius", [0.2, 0.85, 2.0, 30.0, 400.0])
def test_round_sides_stay_near_their_circle(radius: float):
    """Oracle: the sagitta of a chord."""
    count = segments(radius)
    assert count % 8 == 0
    assert radius * (1 - math.cos(math.pi / count)) <= 0.02
    vertices, _ = triangles_of(solid_of(Cylinder(1, radius)))
    radii = np.linalg.norm(vertices[:, :2], axis=1)
    np.testing.assert_allclose(radii[radii > 0.1 * radius], radius, rtol=1e-6)


def box_of(construction: Construction) -> np.ndarray:
    return np.array(solid_of(construction).bounding_box()).reshape(2, 3)


def test_turning_and_moving_are_about_the_axes_of_space():
    """Oracle: a quarter turn about x takes y to z, then one about z takes x to y; both on paper."""
    shape = Box((1, 2, 3))
    np.testing.assert_allclose(box_of(shape.rotate(x=90)), [[0, -3, 0], [1, 0, 2]], atol=1e-12)
    np.testing.assert_allclose(box_of(shape.rotate(x=90, z=90)), [[0, 0, 0], [3, 1, 2]], atol=1e-12)
    np.testing.assert_allclose(box_of(shape.move(5, 0, -1).rotate(z=90)), [[-2, 5, -1], [0, 6, 2]], atol=1e-12)
    np.testing.assert_allclose(box_of(shape.rotate(z=90).move(5, 0, -1)), [[3, 0, -1], [5, 1, 2]], atol=1e-12)


@pytest.mark.parametrize("make", [lambda profile: Prism(profile, 1.0), Revolve])
@pytest.mark.parametrize("profile", [LETTER[::-1], ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0))])
def test_a_profile_that_turns_clockwise_or_is_flat_is_refused(make, profile):
    """As triangles it would be empty, as STEP a body."""
    with pytest.raises(ValueError, match="counter-clockwise"):
        make(profile)


def test_a_turning_does_not_cross_its_axis():
    with pytest.raises(ValueError, match="beyond its axis"):
        Revolve(((-1.0, 0.0), (1.0, 0.0), (1.0, 1.0)))
