"""Friction springs on an obstacle. Oracles: differences, elimination."""

from dataclasses import replace

import numpy as np
import pytest

from hydrostat.mechanics.obstacle_friction import ObstacleFriction


def springs(dim: int, random: np.random.Generator) -> tuple[ObstacleFriction, np.ndarray]:
    """Return six samples, every other one slipping, and their places."""
    anchors, normals = random.normal(size=(2, 6, dim))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    grip = replace(ObstacleFriction.at_rest(0.5, np.full(6, 1e3), anchors), normals=normals)
    places = anchors + 1e-3 * random.normal(size=(6, dim))
    lengths = grip.slips(places)[1]
    return replace(grip, limits=1e3 * lengths * np.where(np.arange(6) % 2, 0.5, 2.0)), places


@pytest.mark.parametrize("dim", [2, 3])
def test_forces_change_as_limits_and_normals_do(dim: int) -> None:
    """Oracle: central differences of the forces."""
    random = np.random.default_rng(dim)
    grip, places = springs(dim, random)
    limits, normals = random.normal(size=6), random.normal(size=(6, dim))
    step = 1e-6
    ends = [
        replace(grip, limits=grip.limits + way * limits, normals=grip.normals + way * normals).forces(places)
        for way in (step, -step)
    ]
    expected = (ends[0] - ends[1]) / (2 * step)
    found = grip.force_changes(places, limits, normals)
    assert found == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


def test_limits_and_normals_that_answer_each_other_are_found_together() -> None:
    """Oracle: the fixed point of linear answers, by elimination."""
    random = np.random.default_rng(0)
    grip, _ = springs(3, random)
    size = 6 + 18
    answers, goal = 0.3 * random.normal(size=(size, size)) / size**0.5, 1e-3 * random.normal(size=size)
    start = np.append(grip.limits, grip.normals.ravel())

    def respond(limits: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        change = answers @ np.append(limits, normals.ravel())
        return change[:6] / grip.friction, change[6:].reshape(6, 3)

    wanted = start + goal
    found = grip.with_joint_step(wanted[:6] / grip.friction, wanted[6:].reshape(6, 3), respond)
    expected = start + np.linalg.solve(np.eye(size) - answers, goal)
    normals = expected[6:].reshape(6, 3)
    assert found.limits == pytest.approx(expected[:6], rel=1e-5)
    assert found.normals == pytest.approx(normals / np.linalg.norm(normals, axis=1, keepdims=True), abs=1e-6)
