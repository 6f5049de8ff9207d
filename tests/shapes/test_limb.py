"""Limbs: closed forms of straight ones, and places in bent ones."""

import numpy as np
import pytest
from bodies.field import round_cone
from bodies.limb import limb

from hydrostat.geometry import contour

STRAIGHT = [(0, 0, 0), (0, 0, 0.04), (0, 0, 0.1)]


def test_a_round_limb_is_a_capsule() -> None:
    """Oracle: the distance from a capsule."""
    radius = [0.02] * 3
    one = limb(STRAIGHT, side=(1, 0, 0), breadths=radius, backs=radius)
    places = np.random.default_rng(2).uniform(-0.05, 0.15, (500, 3))
    assert one.distance(places) == pytest.approx(round_cone((0, 0, 0), (0, 0, 0.1), 0.02, 0.02)(places), abs=1e-12)
    assert one.tip == pytest.approx([0, 0, 0.12])
    assert one.length == pytest.approx(0.1)


def test_sections_with_a_back_and_a_belly() -> None:
    """Oracle: half ellipses pi/2 a b L each, and quarters of ellipsoids at the ends."""
    broad, back, belly, cap = 0.03, 0.02, 0.01, 0.008
    sizes = {"breadths": [broad] * 3, "backs": [back] * 3, "bellies": [belly] * 3}
    one = limb(STRAIGHT, side=(1, 0, 0), **sizes, caps=(cap, cap))
    volume = np.pi / 2 * broad * (back + belly) * 0.1 + 2 / 3 * np.pi * broad * cap * (back + belly)
    surface = contour(one.distance, np.array([[-0.04, -0.03, -0.02], [0.04, 0.03, 0.12]]), 2e-3)
    assert surface.volume == pytest.approx(volume, rel=5e-3)
    assert one.at(0.5, across=1) == pytest.approx((broad, 0, 0.05))
    assert one.at(0.5, up=1) == pytest.approx((0, back, 0.05))  # back = way x side = z x x = y
    assert one.at(0.5, up=-1) == pytest.approx((0, -belly, 0.05))


def test_a_tapered_limb() -> None:
    """Oracle: pi/3 L (a1 b1 + a2 b2 + (a1 b2 + a2 b1) / 2), an elliptic frustum, without its ends."""
    one = limb(STRAIGHT[::2], side=(1, 0, 0), breadths=[0.03, 0.015], backs=[0.02, 0.01], caps=(1e-6, 1e-6))
    volume = np.pi / 3 * 0.1 * (0.03 * 0.02 + 0.015 * 0.01 + (0.03 * 0.01 + 0.015 * 0.02) / 2)
    surface = contour(one.distance, np.array([[-0.04, -0.03, -0.02], [0.04, 0.03, 0.12]]), 2e-3)
    assert surface.volume == pytest.approx(volume, rel=1e-2)


def test_a_bent_limb() -> None:
    """Oracle: a right angle; its joint, and places on the surface."""
    one = limb([(0, 0, 0), (0, 0, 0.06), (0, 0.06, 0.06)], side=(1, 0, 0), breadths=[0.01] * 3, backs=[0.008] * 3)
    assert one.share_of(1) == pytest.approx(0.5, abs=1e-3)
    assert one.at(1.0) == pytest.approx((0, 0.06, 0.06))
    shown = [one.at(share, across, up) for share in (0.2, 0.5, 0.8) for across, up in ((1, 0), (0, 1), (0, -1))]
    assert one.distance(np.array(shown)) == pytest.approx(np.zeros(len(shown)), abs=6e-4)  # 0 but for its corners
    inside = [one.at(share, 0.4, -0.5) for share in np.linspace(0, 1, 20)]
    assert one.distance(np.array(inside)).max() < -2e-3
