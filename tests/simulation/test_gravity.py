"""A robot under its own weight. Oracles: statics, and the hanging bar in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, box_robot, mesh_body, strip_mesh, strip_robot

from hydrostat.robot import Material, Pin, Robot
from hydrostat.simulation import Equilibrium, Simulation

GRAVITY = {2: (1.5, -9.81), 3: (1.5, -2.0, -9.81)}
ROBOTS = {"strip": strip_robot, "box": box_robot}


def reactions(simulation: Simulation, pose: Equilibrium) -> tuple[np.ndarray, np.ndarray]:
    """Points where the pins hold, and their forces on the body [N], from its springs (F = -k u) alone."""
    pins = simulation.assembly.energies[1]
    forces = -pins.gradient(pose.nodes, pose.contractions)
    return pose.nodes[pins.stencils].reshape(-1, pose.nodes.shape[1]), forces.reshape(-1, pose.nodes.shape[1])


def center(robot: Robot, nodes: np.ndarray) -> tuple[float, np.ndarray]:
    """Mass [kg] and its center [m], element by element from rest volumes and the deformed centroids."""
    body = robot.body
    masses = body.material.density * body.mesh.volumes * (body.thickness or 1.0)
    return float(masses.sum()), masses @ nodes[body.mesh.elements].mean(axis=1) / masses.sum()


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("pull", [-0.05, 0.01])
def test_the_pins_carry_the_weight(name: str, pull: float) -> None:
    """Sum of the reactions = -m g, their moment that of the weight at the center of mass; cables inside add nothing."""
    robot = ROBOTS[name]()
    dim = robot.body.mesh.dim
    simulation = Simulation(replace(robot, gravity=GRAVITY[dim]))
    pose = simulation.solve(np.array([pull, -0.05]))
    mass, middle = center(robot, pose.nodes)
    weight = mass * np.array(GRAVITY[dim])
    places, forces = reactions(simulation, pose)
    assert np.abs(pose.nodes - robot.body.mesh.nodes).max() > 1e-3 * robot.body.mesh.size
    assert bool(pose.tensions.any()) == (pull > 0)
    scale = max(float(np.linalg.norm(weight)), float(pose.tensions.max()))
    assert forces.sum(axis=0) == pytest.approx(-weight, abs=1e-8 * scale)
    assert pose.pin_forces.sum(axis=0) == pytest.approx(-weight, abs=1e-8 * scale)
    moments = np.einsum("pi,pj->ij", places, forces) + np.outer(middle, weight)
    assert np.abs(moments - moments.T).max() < 1e-8 * scale * robot.body.mesh.size


@pytest.mark.parametrize("dim", [2, 3])
def test_a_bar_hangs_as_long_as_its_weight_makes_it(dim: int) -> None:
    """Poisson's ratio 0: the stress at x is rho g (L - x), so the end goes down by rho g L^2 / (2 E), to first order.

    What is left, 0.04 % in the plane, is that nodes carry lumped weights and tetrahedra favor a diagonal.
    """
    length, young = 0.2, 30e3
    mesh = strip_mesh(10, 2, size=(length, 0.05)) if dim == 2 else box_mesh((10, 2, 2), size=(length, 0.05, 0.05))
    gravity = 1e-4
    robot = Robot(
        name="bar",
        body=mesh_body(mesh, material=Material(young=young, poisson=0.0, density=40)),
        pins=(Pin(box=((-0.001,) + (-1.0,) * (dim - 1), (0.001,) + (1.0,) * (dim - 1)), stiffness=1e9),),
        winches=(),
        cables=(),
        poses={},
        gravity=(gravity,) + (0.0,) * (dim - 1),
    )
    pose = Simulation(robot).solve({})
    end = np.abs(mesh.nodes[:, 0] - length) < 1e-9
    moved = (pose.nodes - mesh.nodes)[end]
    expected = 40 * gravity * length**2 / (2 * young)
    assert moved[:, 0].mean() == pytest.approx(expected, rel=1e-3)


def test_without_gravity_nothing_hangs() -> None:
    pose = Simulation(replace(strip_robot(), gravity=(0.0, 0.0))).solve({})
    assert pose.nodes == pytest.approx(strip_robot().body.mesh.nodes, abs=1e-15)
