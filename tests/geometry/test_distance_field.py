"""Distances from rigid shapes. Oracles: differences, and shapes filled with points."""

from collections.abc import Callable

import numpy as np
import pytest

from hydrostat.geometry.distance_field import DistanceField

A, B = np.array([0.1, -0.2, 0.3]), np.array([0.6, 0.5, -0.1])
FIELDS: dict[str, Callable[[int], DistanceField]] = {
    "plane": lambda dim: DistanceField.plane(A[:dim], B[:dim]),
    "sphere": lambda dim: DistanceField.sphere(A[:dim], 0.3),
    "capsule": lambda dim: DistanceField.capsule(A[:dim], B[:dim], 0.2),
    "cylinder": lambda dim: DistanceField.cylinder(A[:dim], B[:dim], 0.2),
    "box": lambda dim: DistanceField.box(A[:dim], B[:dim]),
}
INSIDE: dict[str, Callable[[np.ndarray, int], np.ndarray]] = {
    "plane": lambda x, d: (x - A[:d]) @ B[:d] < 0,
    "sphere": lambda x, d: np.linalg.norm(x - A[:d], axis=1) < 0.3,
    "capsule": lambda x, d: along(x, d)[1] < 0.2,
    "cylinder": lambda x, d: (along(x, d)[2] < 0.2) & (np.abs(along(x, d)[0] - 0.5) < 0.5),
    "box": lambda x, d: ((x > np.minimum(A, B)[:d]) & (x < np.maximum(A, B)[:d])).all(axis=1),
}
CASES = [(name, dim) for name in FIELDS for dim in (2, 3) if (name, dim) != ("cylinder", 2)]


def along(x: np.ndarray, dim: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Share of the way from A to B, distance from the way, distance from its line."""
    way = (B - A)[:dim]
    share = (x - A[:dim]) @ way / (way @ way)
    ends = A[:dim] + np.clip(share, 0, 1)[:, None] * way
    return share, np.linalg.norm(x - ends, axis=1), np.linalg.norm(x - A[:dim] - share[:, None] * way, axis=1)


def outside(name: str, dim: int) -> np.ndarray:
    points = np.random.default_rng(3).uniform(-1, 1.5, (400, dim))
    return points[FIELDS[name](dim)(points).values > 0.02]


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_derivatives(name: str, dim: int) -> None:
    field, points, step = FIELDS[name](dim), outside(name, dim), 1e-6
    found = field(points)
    for axis in range(dim):
        move = step * np.eye(dim)[axis]
        ahead, behind = field(points + move), field(points - move)
        slope = (ahead.values - behind.values) / (2 * step)
        curve = (ahead.normals - behind.normals) / (2 * step)
        smooth = np.abs(curve - found.curvatures[:, axis]).max(axis=1) < 1e-5  # but where a step crosses an edge
        np.testing.assert_allclose(slope, found.normals[:, axis], atol=1e-7)
        assert smooth.mean() > 0.99


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_values_are_distances_from_what_is_inside(name: str, dim: int) -> None:
    count = {2: 400, 3: 90}[dim]
    axis = np.linspace(-1.5, 1.5, count) if name != "plane" else np.linspace(-3, 3, count)
    grid = np.stack(np.meshgrid(*[axis] * dim), axis=-1).reshape(-1, dim)
    filled, points = grid[INSIDE[name](grid, dim)], outside(name, dim)[:40]
    nearest = np.array([np.linalg.norm(filled - point, axis=1).min() for point in points])
    found = FIELDS[name](dim)(points).values
    assert np.all(found <= nearest + 1e-12)
    assert np.all(found >= nearest - 1.5 * dim**0.5 * (axis[1] - axis[0]))
    np.testing.assert_array_equal(FIELDS[name](dim)(grid).values < 0, INSIDE[name](grid, dim))
    some = np.concatenate([points, grid[::7]])
    np.testing.assert_allclose(FIELDS[name](dim).values(some), FIELDS[name](dim)(some).values, atol=1e-15)
