"""Flattening: bodies whose flat images are known, and the bound on those that have none."""

import numpy as np
import pytest
import shapely
from patch_bodies import cap, folded, half_cone, half_cylinder

from hydrostat.errors import InputError
from hydrostat.fabrication.patches.flatten import distortion, flatten, quantile
from hydrostat.fabrication.patches.patch import Patch

FINE = 1e-8


@pytest.mark.parametrize("make", [half_cylinder, half_cone, folded])
def test_developable_surfaces_lie_flat_without_distortion(make):
    patch = flatten(make(), settled=FINE)
    bent = distortion(patch)
    assert bent.gives.max() < 1e-3
    assert patch.outline.area == pytest.approx(patch.disc.areas.sum(), rel=1e-4)
    assert (patch.flat_areas > 0).all()


def test_a_half_cylinder_becomes_a_rectangle():
    """Closed form: its sides are the length and the girth of the polygon that it is."""
    patch = flatten(half_cylinder(radius=20.0, length=60.0, columns=13), settled=FINE)
    girth = 12 * 2 * 20.0 * np.sin(np.pi / 24)
    box = shapely.get_coordinates(patch.outline.minimum_rotated_rectangle)
    sides = np.linalg.norm(np.diff(box[:3], axis=0), axis=1)
    assert np.sort(sides) == pytest.approx([60.0, girth], rel=2e-3)


@pytest.mark.parametrize("angle", [0.6, 1.0, np.pi / 2])
def test_no_cap_of_a_sphere_lies_flatter_than_milnor_allows(angle):
    """The ratio of largest to least stretch of any map of a cap is at least angle / sin angle (Milnor 1969)."""
    bent = distortion(flatten(cap(angle)))
    assert bent.longest.max() / bent.shortest.min() > 0.97 * angle / np.sin(angle)
    assert bent.area_ratios.max() / bent.area_ratios.min() > 1.05


def test_a_flat_cap_hardly_distorts():
    """The bound itself tends to none: 0.7 % at 0.2 rad; the best map of least mean energy is not far from it."""
    bent = distortion(flatten(cap(0.2)))
    assert bent.give(0.95) < 0.01


def test_distortion_of_a_known_stretch():
    """A flat image that is 1.25 times as long and 0.8 times as wide as the surface."""
    disc = half_cylinder()
    exact = flatten(disc, settled=FINE)
    turned = exact.flat @ np.linalg.svd(exact.flat - exact.flat.mean(axis=0), full_matrices=False)[2].T
    bent = distortion(Patch(disc=disc, flat=turned * [1.25, 0.8]))
    assert bent.longest == pytest.approx(np.full(len(disc.triangles), 1.25), rel=2e-3)
    assert bent.shortest == pytest.approx(np.full(len(disc.triangles), 0.8), rel=2e-3)
    assert bent.give(0.95) == pytest.approx(0.25, rel=1e-2)


def test_a_patch_that_folds_onto_a_line_is_refused():
    """Such as that of gallery:spine, between the discs of which a skin would have to be all seams."""
    patch = flatten(cap(0.2))
    with pytest.raises(InputError, match="cannot be flattened into patches"):
        distortion(Patch(disc=patch.disc, flat=patch.flat * [1.0, 0.0]))


def test_quantiles_count_areas():
    assert quantile(np.array([3.0, 1.0, 2.0]), np.array([1.0, 8.0, 1.0]), 0.5) == 1.0
    assert quantile(np.array([3.0, 1.0, 2.0]), np.array([1.0, 8.0, 1.0]), 0.95) == 3.0
