"""Colors of strain and stress. Oracles: closed forms of homogeneous stretch and shear, differences of the energy."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_robot, strip_robot

from hydrostat.robot import Robot
from hydrostat.simulation import BodyPhysics
from hydrostat.studio.posing.movers import MuscleMover
from hydrostat.studio.posing.pose_state import HeldPoint
from hydrostat.studio.view.coloring import Coloring, node_strains, node_stresses, node_values, scale
from hydrostat.studio.view.scene_items import rest_shape

ROBOTS = {2: strip_robot(columns=6, rows=2), 3: box_robot()}


def moved(robot: Robot, gradient: np.ndarray) -> np.ndarray:
    """The body in a homogeneous deformation."""
    return robot.body.mesh.nodes @ gradient.T


@pytest.mark.parametrize("dim", [2, 3])
def test_uniaxial_stretch(dim: int) -> None:
    robot, stretch = ROBOTS[dim], 1.3
    gradient = np.eye(dim)
    gradient[0, 0] = stretch
    nodes = moved(robot, gradient)
    mu, _ = robot.body.material.lame
    assert node_strains(robot, nodes) == pytest.approx(stretch - 1, abs=1e-12)
    # sigma = mu/J (B - I) + p I with B = diag(stretch^2, 1, 1): only one difference is left
    assert node_stresses(robot, nodes) == pytest.approx(mu / stretch * (stretch**2 - 1), rel=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_simple_shear(dim: int) -> None:
    robot, shear = ROBOTS[dim], 0.7
    gradient = np.eye(dim)
    gradient[0, 1] = shear
    nodes = moved(robot, gradient)
    mu, _ = robot.body.material.lame
    longest = 0.5 * shear + np.sqrt(1 + 0.25 * shear**2)
    assert node_strains(robot, nodes) == pytest.approx(longest - 1, rel=1e-9)
    # B = [[1 + g^2, g], [g, 1]]: von Mises is mu sqrt(g^4 + 3 g^2)
    assert node_stresses(robot, nodes) == pytest.approx(mu * np.sqrt(shear**4 + 3 * shear**2), rel=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_stress_is_the_slope_of_the_energy(dim: int) -> None:
    robot = ROBOTS[dim]
    rng = np.random.default_rng(3)
    gradient = np.eye(dim) + 0.2 * rng.standard_normal((dim, dim))
    energy, h = BodyPhysics(robot).elastic, 1e-6
    volume = float(energy.volumes.sum())
    slope = np.zeros((dim, dim))
    for i in range(dim):
        for j in range(dim):
            change = np.zeros((dim, dim))
            change[i, j] = h
            up, down = (
                energy.value(moved(robot, gradient + sign * change), np.zeros(0)) / volume for sign in (1.0, -1.0)
            )
            slope[i, j] = (up - down) / (2 * h)
    volume_change = np.linalg.det(gradient)
    cauchy = np.zeros((3, 3))
    cauchy[:dim, :dim] = slope @ gradient.T / volume_change
    if dim == 2:  # plane strain: lambda ln J / J across the plane
        cauchy[2, 2] = robot.body.material.lame[1] * np.log(volume_change) / volume_change
    deviator = cauchy - np.trace(cauchy) / 3 * np.eye(3)
    mises = np.sqrt(1.5 * (deviator**2).sum())
    assert node_stresses(robot, moved(robot, gradient)) == pytest.approx(mises, rel=1e-6)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_random_stretch_is_that_of_the_singular_values(dim: int) -> None:
    robot = ROBOTS[dim]
    gradient = np.eye(dim) + 0.3 * np.random.default_rng(5).standard_normal((dim, dim))
    largest = max(float(np.linalg.svd(gradient, compute_uv=False)[0]), 1.0 if dim == 2 else 0.0)
    assert node_strains(robot, moved(robot, gradient)) == pytest.approx(largest - 1, rel=1e-9)


def test_turning_a_body_strains_nothing() -> None:
    robot = ROBOTS[3]
    turn = np.linalg.qr(np.random.default_rng(1).standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    assert node_strains(robot, moved(robot, turn)) == pytest.approx(0.0, abs=1e-7)
    assert node_stresses(robot, moved(robot, turn)) == pytest.approx(0.0, abs=1e-6 * robot.body.material.young)


def test_colors_are_shares_of_a_steady_scale() -> None:
    robot = ROBOTS[2]
    nodes = moved(robot, np.diag([1.2, 1.0]))
    legend = scale(robot, Coloring.STRAIN)
    assert legend is not None
    values = node_values(robot, replace(rest_shape(robot), nodes=nodes), Coloring.STRAIN)
    assert values == pytest.approx(0.2 / legend.most)
    assert legend.high == f"{100 * legend.most:.3g} %"
    wide = replace(rest_shape(robot), nodes=moved(robot, np.diag([9.0, 1.0])))
    far = node_values(robot, wide, Coloring.STRESS)
    assert far is not None
    assert far.max() == 1.0
    assert node_values(robot, rest_shape(robot), Coloring.FELT) is None
    assert scale(robot, Coloring.FELT) is None


@pytest.mark.parametrize("dim", [2, 3])
def test_muscles_are_colored_as_hard_as_they_pull(dim: int) -> None:
    """The mean over the edges of each node, counted one by one; nothing where no muscle moves the body."""
    robot = ROBOTS[dim]
    mover, marker = MuscleMover(robot), robot.markers[0]
    goal = np.array(marker.at)
    goal[1] += 0.01
    held = {marker.name: HeldPoint(at=marker.at, target=tuple(goal.tolist()), marker=True)}
    for _ in range(20):
        shape, _ = mover.update(held)
    values = node_values(robot, shape, Coloring.MUSCLES)
    assert values is not None
    tensions, edges = mover.pulls[1], robot.body.mesh.edges
    means = np.array([tensions[(edges == node).any(axis=1)].mean() for node in range(len(values))])
    assert values == pytest.approx(means / means.max(), abs=1e-12)
    assert node_values(robot, mover.rest(), Coloring.MUSCLES) == pytest.approx(0.0)
    assert node_values(robot, rest_shape(robot), Coloring.MUSCLES) is None
