"""A disc pulled from between two pads. Oracle: Coulomb's closed form, twice mu times the force that presses them."""

from dataclasses import replace

import numpy as np
import pytest
from builders import FOAM, mesh_body, strip_mesh

from hydrostat.geometry import Mesh
from hydrostat.mechanics import GuideEnergy, PinEnergy
from hydrostat.robot import Contact, Obstacle, Pin, Robot
from hydrostat.simulation import BodyPhysics, Simulation, with_replaced

FRICTION, RADIUS, DISTANCE = 0.4, 0.02, 5e-4

pytestmark = pytest.mark.usefixtures("unchecked")


def pads() -> Robot:
    """Two pads of 120 x 20 mm above one another, a disc between them; the upper one hangs on next to nothing."""
    one = strip_mesh(60, 6, size=(0.12, 0.02))
    apart = np.array([0.0, 0.01 + RADIUS + 0.6 * DISTANCE])
    mesh = Mesh(
        np.concatenate([one.nodes - apart, one.nodes + apart]),
        np.concatenate([one.elements, one.elements + len(one.nodes)]),
    )
    low, high = mesh.nodes.min(axis=0) - 1e-3, mesh.nodes.max(axis=0) + 1e-3
    disc = Obstacle(name="disc", shape="sphere", at=(0.06, 0.0), radius=RADIUS, mass=0.05, friction=FRICTION)
    return Robot(
        name="pads",
        body=mesh_body(mesh, material=replace(FOAM, young=3e5)),
        pins=(
            Pin(box=(tuple(low), (high[0], low[1] + 2e-3)), stiffness=1e5),
            Pin(box=((low[0], high[1] - 2e-3), tuple(high)), stiffness=1.0),
        ),
        winches=(),
        cables=(),
        markers=(),
        poses={},
        contact=Contact(distance=DISTANCE),
        obstacles=(disc,),
    )


def test_the_pull_is_twice_friction_times_the_press() -> None:
    robot = pads()
    nodes, body = robot.body.mesh.nodes, BodyPhysics(robot)
    top = np.flatnonzero(nodes[:, 1] > nodes[:, 1].max() - 1e-6)

    def lid(way: float) -> PinEnergy:
        stiffness, weights = np.full(len(top), 1e6 / len(top)), np.ones((len(top), 1))
        return PinEnergy(stencils=top[:, None], weights=weights, targets=nodes[top] - (0.0, way), stiffness=stiffness)

    (place, axes), press = robot.obstacles[0].frame(), lid(0.0)
    guide = GuideEnergy(body.rigid_dofs[0], place=place, axes=axes, along=np.diag([1e4, 100.0]), turning=1e3)
    simulation, pose = Simulation(robot, body=body, energies=[press, guide]), None
    for way in np.linspace(1.25e-4, 1e-3, 8):
        lower = lid(way)
        simulation, press = with_replaced(simulation, press, lower), lower
        pose = simulation.solve({}, start=pose)
    shares = []
    for way in np.arange(1, 9) * 4e-4:
        further = guide.with_target(place + way * axes[0], axes)
        pose = with_replaced(simulation, guide, further).solve({}, start=pose)
        pressed = float(press.gradient(pose.unknowns, np.zeros(0))[:, 0, 1].sum())
        shares.append(further.pull(pose.unknowns)[0] / (2 * FRICTION * pressed))
    assert shares[0] < 0.9  # it sticks at first
    assert max(shares) == pytest.approx(1.0, abs=0.03)
    assert shares[2:] == pytest.approx(np.ones(6), abs=0.03)
