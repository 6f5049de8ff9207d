"""Nearly incompressible bodies bend as they should when their volume is measured in patches, and not otherwise.

Oracles: finite flexure in one dimension (flexure.py) for a strip pulled by its cable; Saint-Venant's pure bending,
exact at any Poisson's ratio, for a bar in space.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import FOAM, box_mesh, box_robot, mesh_body, strip_mesh, strip_robot
from flexure import curvature
from scipy.sparse.linalg import splu

from hydrostat.geometry import Mesh
from hydrostat.mechanics import PATCH_SIZE, Assembly, Energy, NeoHookean, PatchDilatation, grow_patches
from hydrostat.robot import Cable, Pin, Robot, Volume, Winch
from hydrostat.robot.risks.body_risks import LOCKING
from hydrostat.simulation import BodyPhysics, Simulation

HEIGHT, LENGTH, OFFSET, THICKNESS = 0.02, 0.12, 0.005, 0.03
CONTRACTION = 0.015
CORNERS = np.s_[:-1, :-1], np.s_[:-1, 1:], np.s_[1:, 1:], np.s_[1:, :-1]


def beam(rows: int, poisson: float, volume: Volume) -> Robot:
    """A strip held at its left end, all diagonals alike, which locks most; a via point at every node of Y = -offset."""
    columns = round(LENGTH / HEIGHT * rows)
    points = tuple((float(x), -OFFSET) for x in np.linspace(0, LENGTH, columns + 1))
    nodes = strip_mesh(columns, rows, size=(LENGTH, HEIGHT)).nodes
    index = np.arange(len(nodes)).reshape(rows + 1, columns + 1)
    a, b, c, d = (index[part].ravel() for part in CORNERS)
    mesh = Mesh(nodes, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))
    body = mesh_body(mesh, thickness=THICKNESS, material=replace(FOAM, poisson=poisson))
    return Robot(
        name="beam",
        body=replace(body, volume=volume),
        pins=(Pin(at=(0.0, 0.0)), Pin(at=(0.0, HEIGHT / 4))),
        winches=(Winch(name="only", at=points[0]),),
        cables=(Cable(winch="only", points=points),),
        poses={},
    )


@cache
def bent(rows: int, poisson: float, volume: Volume) -> float:
    """Curvature of the middle half over that of finite flexure at the same tension, less 1."""
    robot = beam(rows, poisson, volume)
    pose = Simulation(robot).solve(np.array([CONTRACTION]))
    shape = (rows + 1, -1, 2)
    rest = robot.body.mesh.nodes.reshape(shape)
    slopes = np.einsum("r,rcd->cd", rest[:, 0, 1], pose.nodes.reshape(shape))
    turns = np.unwrap(np.arctan2(slopes[:, 0], slopes[:, 1]))
    middle = np.abs(rest[0, :, 0] - LENGTH / 2) <= LENGTH / 4 + 1e-9
    found = float(np.polyfit(rest[0, middle, 0], turns[middle], 1)[0])
    mu, lame = robot.body.material.lame
    tension = float(pose.tensions[0])
    return found / curvature(tension, height=HEIGHT, offset=OFFSET, thickness=THICKNESS, mu=mu, lame=lame) - 1


@pytest.mark.parametrize(("poisson", "locked"), [(0.45, 0.11), (0.49, 0.33)])
@pytest.mark.slow
def test_a_strip_follows_finite_flexure(poisson: float, locked: float) -> None:
    """At second order, and at once: with 8 elements across 0.4 % off, where it bends 12 or 35 % less by elements."""
    errors = np.array([bent(rows, poisson, Volume.PATCH) for rows in (8, 16)])
    assert np.abs(errors[0]) < 0.005
    assert np.log2(errors[0] / errors[1]) > 1.6
    assert bent(8, poisson, Volume.ELEMENT) < -locked


@pytest.mark.slow
def test_a_bar_in_space_is_no_stiffer_when_incompressible() -> None:
    """What linear elements cannot bend at Poisson's ratio 0 they cannot at 0.49 either, but it becomes no worse."""
    shear = [bar(rows, 0.0, Volume.ELEMENT) for rows in (2, 4)]
    for poisson in (0.3, 0.45, 0.49):
        patched = [bar(rows, poisson, Volume.PATCH) for rows in (2, 4)]
        assert np.less(patched, shear).all()
        assert np.log2(patched[0] / patched[1]) > 1.9
    assert bar(4, 0.49, Volume.ELEMENT) > 10 * shear[1]


@pytest.mark.slow
def test_the_warning_tells_what_a_bar_loses() -> None:
    """Oracle: this bar, with 4 elements across; and it is a share of what is left with patches."""
    for poisson, added in LOCKING[3].items():
        ratio = (1 + bar(4, poisson, Volume.ELEMENT)) / (1 + bar(4, poisson, Volume.PATCH)) - 1
        assert ratio == pytest.approx(added, rel=0.05)


@pytest.mark.parametrize("make", [strip_robot, box_robot])
def test_the_jacobian_is_the_derivative(make: Callable[[], Robot]) -> None:
    """Oracle: central differences of whole solves."""
    robot = make()
    body = replace(robot.body, material=replace(FOAM, poisson=0.49), volume=Volume.PATCH)
    simulation = Simulation(replace(robot, body=body))
    goal, step = np.array([0.01, 0.002]), 1e-6
    jacobian = simulation.jacobian(simulation.solve(goal))
    for winch in range(2):
        ahead, behind = (simulation.solve(goal + sign * step * np.eye(2)[winch]).nodes for sign in (1, -1))
        found = (ahead - behind) / (2 * step)
        assert np.abs(jacobian[:, :, winch] - found).max() < 1e-5 * np.abs(found).max()


@pytest.mark.parametrize("make", [strip_robot, box_robot])
def test_only_the_volume_is_in_patches(make: Callable[[], Robot]) -> None:
    """Oracle: the energy by elements, which is that by patches wherever the deformation is homogeneous."""
    robot = make()
    nodes = robot.body.mesh.nodes * np.linspace(0.8, 1.1, robot.body.mesh.dim)
    values = []
    for volume in Volume:
        energies = BodyPhysics(replace(robot, body=replace(robot.body, volume=volume))).assembly.energies
        values.append(sum(energy.value(nodes, np.zeros(2)) for energy in energies))
    assert values[0] == pytest.approx(values[1], rel=1e-12)
    assert values[0] > 0


@cache
def bar(rows: int, poisson: float, volume: Volume) -> float:
    """Energy of a bar in pure bending, held so at both ends, over E I kappa^2 / 2 a length, less 1."""
    mesh = box_mesh((4 * rows, rows, rows), size=(4 * HEIGHT, HEIGHT, HEIGHT))
    mu, lame = replace(FOAM, poisson=poisson).lame
    patches = volume is Volume.PATCH
    energies: list[Energy] = [NeoHookean(mesh.nodes, mesh.elements, mu=mu, lame=0.0 if patches else lame)]
    if patches:
        energies.append(
            PatchDilatation(mesh.nodes, mesh.elements, grow_patches(mesh.elements, PATCH_SIZE[3]), lame=lame)
        )
    hessian = Assembly(energies, rest=mesh.nodes, control_count=0).hessian(mesh.nodes, np.zeros(0))
    x, y, z = (mesh.nodes - [0.0, HEIGHT / 2, HEIGHT / 2]).T
    exact = np.column_stack([-x * y, (x**2 + poisson * (y**2 - z**2)) / 2, poisson * y * z]).ravel()
    held = np.repeat((x < 1e-9) | (x > 4 * HEIGHT - 1e-9), 3)
    moved = np.where(held, exact, 0.0)
    moved[~held] = splu(hessian[~held][:, ~held].tocsc()).solve(-(hessian @ moved)[~held])
    return float(moved @ (hessian @ moved)) / (FOAM.young * HEIGHT**4 / 12 * 4 * HEIGHT) - 1
