"""Where poses touch, and how hard. Oracles: weight, pins, and the forces at the nodes themselves."""

from dataclasses import replace

import numpy as np
import pytest
from builders import box_mesh, mesh_body, strip_mesh
from touching import fork_robot

from hydrostat.mechanics import SelfContactEnergy
from hydrostat.robot import Contact, Obstacle, Pin, Robot
from hydrostat.simulation import ContactPatch, Simulation, find_contacts, obstacle_forces

CLOSED = {"up": 0.012, "down": 0.01}


@pytest.mark.parametrize("dim", [2, 3])
def test_prongs_press_each_other(dim: int) -> None:
    """One patch in the plane; forces are what all nodes of one prong feel, and the place is in the slot."""
    simulation = Simulation(fork_robot(dim))
    pose = simulation.solve(CLOSED)
    found = find_contacts(simulation, pose)
    assert found
    contact = next(
        each for each in simulation.assembly.energies if isinstance(each, SelfContactEnergy)
    ).with_active_terms(pose.nodes)
    forces = np.zeros_like(pose.nodes)
    contact.add_gradient(pose.nodes, np.zeros(0), forces)
    upper = simulation.robot.body.mesh.nodes[:, 1] > 0
    total = sum(np.sign(touch.force[1]) * touch.force for touch in found)
    np.testing.assert_allclose(total, -forces[upper].sum(axis=0), rtol=1e-9, atol=1e-12)
    assert all(touch.obstacle is None and touch.place[0] > 0.03 for touch in found)
    assert [touch.strength for touch in found] == sorted((touch.strength for touch in found), reverse=True)
    ends = pose.nodes[upper, 1].max(), pose.nodes[~upper, 1].min()
    assert all(ends[1] < touch.place[1] < ends[0] for touch in found)
    assert ContactPatch.describe_all(found).startswith("the body touches itself in ")


@pytest.mark.parametrize("dim", [2, 3])
def test_a_wall_bears_what_the_pins_do_not(dim: int) -> None:
    """Cables that end in the body pull nothing out of it: what presses on the wall is what the pins hold."""
    wall = Obstacle(name="wall", shape="plane", at=(0.0, -0.03, 0.0)[:dim], normal=(0.0, 1.0, 0.0)[:dim])
    simulation = Simulation(replace(fork_robot(dim), obstacles=(wall,)))
    pose = simulation.solve({"up": 0.02})
    met = [touch for touch in find_contacts(simulation, pose) if touch.obstacle == "wall"]
    pins = np.zeros_like(pose.nodes)
    simulation.body.pins.add_gradient(pose.nodes, np.zeros(0), pins)
    total = np.sum([touch.force for touch in met], axis=0)
    assert total[1] > 0.01
    np.testing.assert_allclose(total, pins.sum(axis=0), atol=1e-6)
    np.testing.assert_allclose(total, -obstacle_forces(simulation, pose)[0], rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_block_lies_on_a_plane(dim: int, friction: float) -> None:
    """All of its weight, less what a soft spring holds, in one patch below its middle."""
    mesh = strip_mesh(6, 4, size=(0.06, 0.04)) if dim == 2 else box_mesh((4, 3, 3), size=(0.06, 0.04, 0.04))
    body = mesh_body(mesh, thickness=0.04 if dim == 2 else None)
    low = mesh.nodes.min(axis=0)
    floor = Obstacle(
        name="floor", shape="plane", at=(0.0, low[1] - 3e-4, 0.0)[:dim], normal=(0.0, 1.0, 0.0)[:dim], friction=friction
    )
    box = tuple((low - 1).tolist()), tuple((low + 1).tolist())
    robot = Robot(
        name="block", body=body, pins=(Pin(box=box, stiffness=1.0),), winches=(), cables=(), markers=(), poses={},
        gravity=(0.0, -9.81, 0.0)[:dim], contact=Contact(distance=1e-3), obstacles=(floor,),
    )  # fmt: skip
    simulation = Simulation(robot)
    pose = simulation.solve({})
    (touch,) = find_contacts(simulation, pose)
    pins = np.zeros_like(pose.nodes)
    simulation.body.pins.add_gradient(pose.nodes, np.zeros(0), pins)
    weight = 9.81 * simulation.body.masses.sum()
    np.testing.assert_allclose(touch.force, weight * np.eye(dim)[1] + pins.sum(axis=0), atol=1e-6 * weight)
    assert touch.force[1] > 0.5 * weight
    middle = 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
    away = np.abs(np.delete(touch.place - middle, 1)).max()
    assert away < 2e-3  # the mesh of a block in space is not the same to both sides
    assert ContactPatch.describe_all([touch]) == f"the body touches 'floor' with {touch.strength:.2g} N"


def test_nothing_touches_at_rest() -> None:
    simulation = Simulation(fork_robot(2))
    assert find_contacts(simulation, simulation.rest) == ()
    assert ContactPatch.describe_all(()) == ""
    free = Simulation(fork_robot(2, contact=False))
    assert find_contacts(free, free.solve(CLOSED)) == ()
