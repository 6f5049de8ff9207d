"""Robots that no pin holds lie on the ground. Oracles: their weight, Coulomb's slope, Newton's second law."""

from dataclasses import replace

import numpy as np
import pytest
from builders import FOAM, box_mesh, mesh_body, strip_mesh

import hydrostat as hs
from hydrostat.errors import InputError
from hydrostat.mechanics import ObstacleEnergy
from hydrostat.robot import Contact, Obstacle, Robot
from hydrostat.simulation import Motion, StepOptions

FRICTION, G = 0.4, 9.81

pytestmark = pytest.mark.usefixtures("unchecked")


def slab(*, lean: float = 0.0, dim: int = 2) -> Robot:
    """A slab of foam just above the ground; gravity leans by an angle [rad]."""
    flat = dim == 2
    mesh = strip_mesh(8, 2, size=(0.16, 0.04)) if flat else box_mesh((4, 3, 2), size=(0.08, 0.06, 0.04))
    up = np.eye(dim)[-1]
    at = (mesh.nodes[:, -1].min() - 0.5e-3) * up
    ground = Obstacle(name="ground", shape="plane", at=tuple(at), normal=tuple(up), friction=FRICTION)
    return Robot(
        name="slab",
        body=mesh_body(mesh, material=replace(FOAM, viscosity=400.0)),
        pins=(),
        poses={},
        contact=Contact(distance=1e-3),
        obstacles=(ground,),
        gravity=tuple(G * (np.sin(lean) * np.eye(dim)[0] - np.cos(lean) * up)),
    )


def moved(simulation: hs.Simulation, seconds: float, dt: float = 5e-3) -> Motion:
    """Where it is after some time."""
    motion = simulation.motion_at_rest()
    for _ in range(round(seconds / dt)):
        motion = simulation.step(motion, {}, dt, options=StepOptions(scheme="euler"))
    return motion


@pytest.mark.parametrize("dim", [2, 3])
def test_the_ground_carries_its_weight_and_friction_holds_it_on_a_slope(dim: int) -> None:
    simulation = hs.Simulation(slab(lean=0.3, dim=dim))  # tan(0.3) = 0.31 < 0.4
    motion = moved(simulation, 0.5)
    ground = simulation.path.with_history(motion.pose).energies[simulation.body.obstacles[0]]
    assert isinstance(ground, ObstacleEnergy)
    push = ground.push(motion.nodes)
    weight = simulation.body.masses.sum() * np.array(simulation.robot.gravity)
    assert push == pytest.approx(weight, rel=1e-3, abs=1e-6)
    later = simulation.step(motion, {}, 5e-3, options=StepOptions(scheme="euler"))
    assert np.abs(later.nodes - motion.nodes).max() < 1e-7


def test_on_a_steeper_slope_it_slides_as_newton_says() -> None:
    simulation = hs.Simulation(slab(lean=0.6))
    masses = simulation.body.masses
    first = moved(simulation, 0.2)
    last, seconds = first, 0.2
    for _ in range(round(seconds / 5e-3)):
        last = simulation.step(last, {}, 5e-3, options=StepOptions(scheme="euler"))
    gained = masses @ (last.velocities - first.velocities)[:, 0] / masses.sum()
    assert gained == pytest.approx(seconds * G * (np.sin(0.6) - FRICTION * np.cos(0.6)), rel=0.01)


def test_what_needs_a_hold_says_so() -> None:
    robot = slab()
    with pytest.raises(InputError, match=r"no pin holds the robot: .* so let it move"):
        hs.Simulation(robot).solve({})
    with pytest.raises(InputError, match="no pin holds the robot"):
        hs.Simulation(robot).solve_batch([{}])
    for other in ({"gravity": None}, {"gravity": "+y"}, {"obstacles": ()}):
        with pytest.raises(InputError, match="or gravity and a ground plane"):
            replace(robot, **other)
