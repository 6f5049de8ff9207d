"""Undercuts and the search for a pull: oracles are areas in closed form and rays cast by manifold3d."""

import math

import numpy as np
import pytest
from manifold3d import Manifold

from hydrostat.fabrication.moulds.pull import best_height, find_pull, half_sphere
from hydrostat.fabrication.moulds.release import fine_surface, release

Z = np.array([0.0, 0.0, 1.0])


def spool() -> Manifold:
    """Two flanges of radius 30 and thickness 10 on a stem of radius 12 and length 40, along z."""
    flange = Manifold.cylinder(10, 30, 30, 128)
    return flange + Manifold.cylinder(60, 12, 12, 128) + flange.translate((0, 0, 50))


def mushroom() -> Manifold:
    """A cap on a stem, along z."""
    return Manifold.cylinder(40, 12, 12, 96) + Manifold.cylinder(10, 30, 30, 96).translate((0, 0, 40))


def share_along(solid: Manifold, direction: np.ndarray) -> float:
    skin = fine_surface(solid)
    return best_height(skin, release(skin, direction))[1]


@pytest.mark.slow
def test_sphere_and_box_come_out() -> None:
    assert find_pull(Manifold.sphere(40, 64), count=20).share == 0
    box = find_pull(Manifold.cube((30, 60, 90)).rotate((20, 35, 50)), count=40)
    assert box.share == 0
    turned = Manifold.cube((1, 0.01, 0.01)).rotate((20, 35, 50)).bounding_box()
    along = np.array([turned[3] + turned[0], turned[4] + turned[1], turned[5] + turned[2]])
    assert abs(box.direction @ along) / np.linalg.norm(along) == pytest.approx(1, abs=1e-3)  # thinnest way


def test_box_across_a_corner_does_not() -> None:
    assert share_along(Manifold.cube((30, 30, 30)), np.ones(3) / math.sqrt(3)) > 0.1


def test_spool_along_its_axis_has_the_undercut_of_the_closed_form() -> None:
    ring, stem = math.pi * (30**2 - 12**2), 2 * math.pi * 12 * 40
    whole = 2 * math.pi * 30**2 + 2 * ring + stem + 2 * 2 * math.pi * 30 * 10
    assert share_along(spool(), Z) == pytest.approx((2 * ring + stem) / whole, rel=0.01)


@pytest.mark.slow
def test_spool_across_its_axis_and_mushroom_under_its_cap_come_out() -> None:
    found = find_pull(spool(), count=60)
    assert found.share < 0.005
    assert abs(found.direction @ Z) < 0.01
    skin = fine_surface(mushroom())
    height, share = best_height(skin, release(skin, Z))
    assert share < 0.005
    assert 39.9 < height < 50.1  # in the cap: its underside leaves with the stem


def test_sealed_room_never_comes_out() -> None:
    hollow = Manifold.cube((60, 60, 60), True) - Manifold.cube((20, 20, 20), True)
    assert share_along(hollow, Z) == pytest.approx(6 * 20**2 / (6 * 60**2 + 6 * 20**2), rel=1e-6)


def test_release_agrees_with_rays() -> None:
    solid = Manifold.sphere(20, 24) + Manifold.sphere(14, 24).translate((9, 4, 22)) + Manifold.cube((50, 9, 9))
    skin = fine_surface(solid)
    freed = release(skin, Z)
    facing = skin.normals[:, 2]
    asked = skin.middles + 5e-4 * skin.size * skin.normals
    chosen = np.flatnonzero(np.abs(facing) > 0.05)[::17]
    for number in chosen:
        x, y, z = asked[number]
        hits = solid.ray_cast((x, y, z), (x, y, 1e3))
        assert bool(freed.upward[number]) == (facing[number] > 0 and not hits)


@pytest.mark.slow
def test_pull_turns_with_the_body() -> None:
    body = Manifold.cube((90, 50, 24), True) + Manifold.cylinder(40, 8, 8, 48).rotate((60, 10, 0))
    turn = (25.0, -40.0, 70.0)
    first, second = find_pull(body, count=40), find_pull(body.rotate(turn), count=40)
    assert second.share == pytest.approx(first.share, abs=0.01)
    arrow = Manifold.cube((1e-3, 1e-3, 1e-3), True).translate(tuple((100 * first.direction).tolist())).rotate(turn)
    turned = np.reshape(arrow.bounding_box(), (2, 3)).mean(axis=0) / 100
    assert abs(turned @ second.direction) > math.cos(math.radians(3))


def test_directions_are_spread_evenly() -> None:
    directions = half_sphere(150)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1)
    near = np.sort(np.abs(directions @ directions.T), axis=1)[:, -2]
    assert np.degrees(np.arccos(near)).min() > 5
    assert np.degrees(np.arccos(near)).max() < 14


@pytest.mark.slow
def test_reported_shares_are_those_of_the_directions() -> None:
    found = find_pull(mushroom(), count=30)
    for number in (0, 20, len(found.shares) - 1):
        assert found.shares[number] == best_height(found.surface, release(found.surface, found.directions[number]))[1]
    areas = found.surface.areas
    assert areas[found.undercut].sum() / areas.sum() == pytest.approx(found.share, abs=1e-12)
