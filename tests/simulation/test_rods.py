"""Elastic rods in a body. Oracles: the elastica (SciPy's boundary value solver), a spring of EA / L."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, mesh_body
from scipy.integrate import solve_bvp

from hydrostat.mechanics import RodTwistEnergy
from hydrostat.robot import BodyPart, Load, Marker, Material, Pin, Robot, Rod
from hydrostat.simulation import Simulation

LENGTH, EI = 0.2, 2.5e-3
SOFT = Material(young=1e3, poisson=0.0, density=1.0)
MIDDLE = (0.005, 0.005)


def cantilever(count: int, *loads: Load) -> Robot:
    """A rod in a body without strength, clamped along its first segment."""
    rod = Rod(name="r", points=((0.0, *MIDDLE), (LENGTH, *MIDDLE)), axial_stiffness=1e4, bending_stiffness=EI)
    return Robot(
        name="cantilever",
        body=mesh_body(box_mesh((count, 2, 2), size=(LENGTH, 0.01, 0.01)), material=SOFT),
        pins=(Pin(box=((-1e-3, -1.0, -1.0), (1.01 * LENGTH / count, 1.0, 1.0)), stiffness=1e9),),
        rods=(rod,),
        markers=(Marker(name="tip", at=(LENGTH, *MIDDLE)),),
        poses={},
        loads=loads,
    )


def elastica(length: float, force: float) -> np.ndarray:
    """Tip of a clamped inextensible rod under a dead force across it [m]: EI t'' + P cos t = 0."""

    def slopes(_: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -force / EI * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(first: np.ndarray, last: np.ndarray) -> np.ndarray:
        return np.array([first[0], last[1], first[2], first[3]])

    found = solve_bvp(slopes, ends, np.linspace(0, length, 50), np.zeros((4, 50)), tol=1e-8)
    return np.array([found.y[2, -1], -found.y[3, -1]]) * [1.0, -1.0]


@pytest.mark.parametrize("force", [0.02, 0.2])
def test_a_rod_bends_as_the_elastica(force: float) -> None:
    """A clamp on a segment acts at its middle; the error falls faster than the spacing."""
    errors = []
    for count in (10, 20, 40):
        pose = Simulation(cantilever(count, Load(name="p", marker="tip", force=(0.0, 0.0, -force)))).solve([])
        free = LENGTH * (1 - 0.5 / count)
        along, across = elastica(free, force)
        errors.append(np.linalg.norm(pose.markers["tip"][[0, 2]] - [along + LENGTH - free, 0.005 - across]))
    assert errors[2] < 0.005 * LENGTH
    assert errors[1] < 0.6 * errors[0]


def test_a_rod_is_stretched_as_a_spring() -> None:
    pose = Simulation(cantilever(40, Load(name="p", marker="tip", force=(5.0, 0.0, 0.0)))).solve([])
    assert pose.markers["tip"][0] - LENGTH == pytest.approx(5.0 / 1e4 * LENGTH * (1 - 1 / 40), rel=0.01)


def test_a_rod_that_is_bent_at_rest_has_no_force() -> None:
    robot = cantilever(10)
    points = ((0.01, 0.002, 0.005), (0.1, 0.008, 0.006), (0.19, 0.003, 0.004))
    bent = replace(robot, rods=(Rod(name="r", points=points, diameter=1e-3, young=2e11),))
    pose = Simulation(bent).solve([])
    assert pose.nodes == pytest.approx(robot.body.mesh.nodes, abs=1e-9)
    assert bent.rods[0].stiffnesses == pytest.approx((2e11 * np.pi * 1e-6 / 4, 2e11 * np.pi * 1e-12 / 64))


@pytest.mark.parametrize(("count", "free"), [(10, 0.8), (20, 0.85)])
def test_a_rod_is_twisted_by_a_moment_about_it(count: int, free: float) -> None:
    """Oracle: the angle M L / GJ over the share of the length between the clamp and a rigid end."""
    stiffness, moment = 4e-3, 0.01
    robot = cantilever(count)
    rod = replace(robot.rods[0], torsional_stiffness=stiffness)
    end = BodyPart(name="end", shape="box", at=(0.899 * LENGTH, -1, -1), to=(1.1 * LENGTH, 1, 1), density=1.0)
    load = Load(name="p", at=(0.95 * LENGTH, *MIDDLE), moment=(moment, 0.0, 0.0))
    body = replace(robot.body, parts=(end,))
    pose = Simulation(replace(robot, body=body, rods=(rod,), loads=(load,))).solve([])
    last = np.flatnonzero(robot.body.mesh.nodes[:, 0] > LENGTH - 1e-9)
    rest, now = ((nodes[last] - nodes[last].mean(axis=0))[:, 1:] for nodes in (robot.body.mesh.nodes, pose.nodes))
    angle = np.arctan2((rest[:, 0] * now[:, 1] - rest[:, 1] * now[:, 0]).sum(), (rest * now).sum())
    assert angle == pytest.approx(moment * free * LENGTH / stiffness, rel=0.02)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_shear_of_the_section_is_no_twist(axis: int) -> None:
    """Oracles: 0 for a shear that grows along the rod, of either direction; GJ a^2 / (2 L) for a rotation by a."""
    mesh, stiffness, angle = box_mesh((10, 4, 4), size=(LENGTH, 0.04, 0.04)), 4e-3, 0.1
    points = np.linspace((0.0, 0.02, 0.02), (LENGTH, 0.02, 0.02), 11)
    energy = RodTwistEnergy(mesh.nodes, mesh, points, torsional_stiffness=stiffness)
    across, grown = mesh.nodes[:, 1:] - 0.02, angle * mesh.nodes[:, :1] / LENGTH
    shears = np.array([[[0.0, 1.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, -1.0]]])
    sheared, turned = mesh.nodes.copy(), mesh.nodes.copy()
    sheared[:, 1:] += grown * (across @ shears[axis])
    turned[:, 1:] += np.sin(grown) * across @ [[0.0, 1.0], [-1.0, 0.0]] + (np.cos(grown) - 1.0) * across
    twist = stiffness * angle**2 / (2 * LENGTH)
    assert energy.value(sheared, np.zeros(0)) < 1e-3 * twist
    assert energy.value(turned, np.zeros(0)) == pytest.approx(twist, rel=2e-2)
