"""The shapes of the gallery: closed, in one part, without handles, and as large as they say."""

from collections.abc import Callable

import numpy as np
import pytest
from bodies.gripper_shape import caging_gripper
from bodies.hand_shape import cupping_hand, extended_hand
from bodies.hydrostat_shapes import fish_tail, octopus_arm, tongue, trunk
from bodies.limb import Shape

from hydrostat.geometry import Surface, contour

SHAPES = [cupping_hand, extended_hand, caging_gripper, trunk, octopus_arm, tongue, fish_tail]


def edges_met_once(surface: Surface) -> int:
    """How many directed edges have no opposite, or more than one."""
    ways = np.concatenate([surface.triangles[:, [one, (one + 1) % 3]] for one in range(3)])
    keys = {tuple(way) for way in ways.tolist()}
    return len(ways) - sum((end, start) in keys for start, end in keys)


def characteristic(surface: Surface) -> int:
    """Euler's vertices - edges + triangles of a closed surface: 2 for each part, less 2 for each handle."""
    return len(np.unique(surface.triangles)) - 3 * len(surface.triangles) // 2 + len(surface.triangles)


@pytest.mark.slow
@pytest.mark.parametrize("make", SHAPES)
def test_closed_and_in_one_part(make: Callable[[], Shape]) -> None:
    """Oracle: every edge twice, once each way; Euler's number of a ball, so no two fingers are fused."""
    shape = make()
    surface = shape.surface(5e-3)
    assert edges_met_once(surface) == 0
    assert characteristic(surface) == 2
    assert surface.volume > 1e-4
    assert (surface.box[0] > shape.box[0] - 1e-9).all()
    assert (surface.box[1] < shape.box[1] + 1e-9).all()


@pytest.mark.slow
@pytest.mark.parametrize("make", [extended_hand, tongue])
def test_nothing_is_missed_for_speed(make: Callable[[], Shape]) -> None:
    """Oracle: the field at all points of the grid, where `surface` computes those near its zero alone."""
    shape = make()
    full = contour(shape.field, shape.box, 6e-3)
    assert np.array_equal(shape.surface(6e-3).triangles, full.triangles)


@pytest.mark.parametrize("make", SHAPES)
def test_limbs_lie_inside(make: Callable[[], Shape]) -> None:
    """Oracle: the field along the spines, but for what was cut off where the body is held."""
    shape = make()
    for limb in shape.limbs.values():
        inner = limb.spine[((limb.spine > shape.box[0]) & (limb.spine < shape.box[1])).all(axis=1)][2:]
        assert shape.field(inner).max() < -3e-3


def test_a_tennis_ball_has_room_in_the_cage() -> None:
    """Oracle: a ball of 67 mm (N4) above the palm, its surface outside the gripper; the palm is not far below it."""
    gripper = caging_gripper()
    ways = np.random.default_rng(3).normal(size=(2000, 3))
    ball = 33.5e-3 * ways / np.linalg.norm(ways, axis=1, keepdims=True) + (0, 0, 58e-3)
    assert 0 < gripper.field(ball).min() < 12e-3


def test_the_counts_can_fail() -> None:
    """Oracle: a tetrahedron is closed and a ball; without one side it is open; two of them have Euler's number 4."""
    corners = np.concatenate([np.zeros((1, 3)), np.eye(3)])
    sides = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    whole = Surface(corners, sides)
    assert (edges_met_once(whole), characteristic(whole)) == (0, 2)
    assert edges_met_once(Surface(corners, sides[:3])) == 3
    assert characteristic(Surface(np.concatenate([corners, corners + 2]), np.concatenate([sides, sides + 4]))) == 4
