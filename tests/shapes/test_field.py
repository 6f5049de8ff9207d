"""Signed distances: closed forms, brute force, and how fast they may change."""

import numpy as np
import pytest
from bodies.field import (
    chain,
    ellipsoid,
    half_space,
    intersection,
    place_field,
    round_cone,
    rounded_box,
    turn_about,
    union,
)

from hydrostat.errors import InputError
from hydrostat.geometry import contour

BOX = np.array([[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]])


def points(count: int = 2000) -> np.ndarray:
    return np.random.default_rng(1).uniform(*BOX, (count, 3))


def slopes(field, places: np.ndarray) -> np.ndarray:
    """Length of the gradient by central differences."""
    steps = 1e-6 * np.eye(3)
    return np.linalg.norm([(field(places + step) - field(places - step)) / 2e-6 for step in steps], axis=0)


@pytest.mark.parametrize(("start_radius", "end_radius"), [(0.02, 0.02), (0.03, 0.01), (0.0, 0.025)])
def test_round_cone(start_radius: float, end_radius: float) -> None:
    """Oracle: the nearest of many balls along the axis, whose hull it is."""
    start, end = np.array([-0.03, 0.01, 0.0]), np.array([0.04, -0.02, 0.05])
    places = points(300)
    shares = np.linspace(0, 1, 4001)[:, None]
    middles = start + shares * (end - start)
    radii = start_radius + shares[:, 0] * (end_radius - start_radius)
    balls = np.linalg.norm(places[:, None] - middles, axis=2) - radii
    field = round_cone(start, end, start_radius, end_radius)
    assert field(places) == pytest.approx(balls.min(axis=1), abs=1e-7)


def test_capsule_volume() -> None:
    """Oracle: pi r^2 L + 4/3 pi r^3."""
    radius, length = 0.02, 0.08
    surface = contour(round_cone((-0.04, 0, 0), (0.04, 0, 0), radius, radius), BOX, 2e-3)
    assert surface.volume == pytest.approx(np.pi * radius**2 * (length + 4 / 3 * radius), rel=5e-3)


def test_balls_within_one_another_are_no_cone() -> None:
    """Oracle: the smaller ball begins inside the larger one."""
    with pytest.raises(InputError, match="none lies within the other"):
        round_cone((0, 0, 0), (0.01, 0, 0), 0.03, 0.01)


def test_rounded_box() -> None:
    """Oracle: the distance from the inner box by clipping, less the corner; below 0 inside; its volume."""
    half, corner = np.array([0.05, 0.04, 0.03]), 0.01
    field = rounded_box((0.01, 0, 0), half, corner)
    places = points()
    local = places - (0.01, 0, 0)
    outside = np.linalg.norm(local - np.clip(local, corner - half, half - corner), axis=1) - corner
    assert field(places)[outside > 0] == pytest.approx(outside[outside > 0], abs=1e-12)
    assert (field(places)[(np.abs(local) < half - corner).all(axis=1)] < 0).all()
    sides = 2 * (half - corner)
    faces = 2 * (sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0])
    volume = sides.prod() + faces * corner + np.pi * corner**2 * sides.sum() + 4 / 3 * np.pi * corner**3
    assert contour(field, BOX, 3e-3).volume == pytest.approx(volume, rel=5e-3)
    with pytest.raises(InputError, match="corners"):
        rounded_box((0, 0, 0), half, 0.031)


def test_ellipsoid() -> None:
    """Oracle: a ball is exact; an ellipsoid is 0 on its surface, where it changes by the way; 4/3 pi a b c."""
    ball = ellipsoid((0.01, 0, 0), (0.03, 0.03, 0.03))
    places = points()
    assert ball(places) == pytest.approx(np.linalg.norm(places - (0.01, 0, 0), axis=1) - 0.03, abs=1e-12)
    assert ball(np.array([[0.01, 0, 0]])) == pytest.approx([-0.03])
    axes = np.array([0.08, 0.05, 0.02])
    field = ellipsoid((0, 0, 0), axes)
    on = axes * places[:200] / np.linalg.norm(places[:200], axis=1, keepdims=True)
    assert field(on) == pytest.approx(np.zeros(200), abs=1e-12)
    assert slopes(field, on) == pytest.approx(np.ones(200), abs=1e-4)
    assert contour(field, BOX, 3e-3).volume == pytest.approx(4 / 3 * np.pi * axes.prod(), rel=5e-3)


def test_union_and_intersection() -> None:
    """Oracle: without blend the lower and the higher one; with it lower by a quarter of it where both are equal."""
    one, two = round_cone((-0.05, 0, 0), (0.05, 0, 0), 0.02, 0.02), half_space((0, 0, 0), (0, 0, 2))
    places = points()
    values = np.array([one(places), two(places)])
    assert union(one, two)(places) == pytest.approx(values.min(axis=0))
    assert intersection(one, two)(places) == pytest.approx(values.max(axis=0))
    assert union(one, one, blend=0.01)(places) == pytest.approx(one(places) - 0.0025)
    assert intersection(one, one, blend=0.01)(places) == pytest.approx(one(places) + 0.0025)
    blended = union(one, two, blend=0.01)(places)
    far = np.abs(values[0] - values[1]) > 0.01
    assert blended[far] == pytest.approx(values.min(axis=0)[far])
    assert (blended[~far] < values.min(axis=0)[~far]).all()


def test_distances_change_by_at_most_the_way() -> None:
    """Oracle: the triangle inequality, for exact parts however they are blended, cut and placed."""
    parts = [
        chain([(-0.05, 0, 0), (0, 0.02, 0), (0.05, 0, 0.03)], [0.02, 0.01, 0.015], blend=0.01),
        rounded_box((0, 0, -0.02), (0.04, 0.03, 0.02), 0.01),
    ]
    whole = intersection(union(*parts, blend=0.02), half_space((0, 0, -0.03), (0, 0, -1)), blend=0.005)
    turned = place_field(whole, turn=turn_about((1, 1, 0), 30), shift=(0.01, 0, 0))
    assert slopes(turned, points()).max() <= 1 + 1e-6


def test_placed() -> None:
    """Oracle: a quarter turn about z brings x to y; then the shift."""
    field = round_cone((0, 0, 0), (0.05, 0, 0), 0.01, 0.01)
    moved = place_field(field, turn=turn_about((0, 0, 1), 90), shift=(0, 0, 0.02))
    places = np.array([[0, 0.025, 0.02], [0, 0.06, 0.02], [0.03, 0, 0.02]])
    assert moved(places) == pytest.approx([-0.01, 0.0, 0.02], abs=1e-12)
