"""Pressure in a cavity. Oracles: Lamé's thick ring, the volume of a void."""

import numpy as np
import pytest
from builders import box_mesh, mesh_body

from hydrostat.geometry import Mesh
from hydrostat.robot import Load, Material, Pin, Robot
from hydrostat.simulation import Simulation

INNER, OUTER, YOUNG, POISSON, PRESSURE = 0.02, 0.04, 1e5, 0.3, 100.0


def ring_mesh(rows: int, columns: int) -> Mesh:
    """Triangles between two circles."""
    radii = np.linspace(INNER, OUTER, rows + 1)
    turns = np.linspace(0, 2 * np.pi, columns, endpoint=False)
    nodes = np.stack([np.outer(radii, np.cos(turns)), np.outer(radii, np.sin(turns))], axis=-1).reshape(-1, 2)
    index = np.arange((rows + 1) * columns).reshape(rows + 1, columns)
    low, high = index[:-1], index[1:]
    low_next, high_next = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    triangles = [np.stack(one, -1).reshape(-1, 3) for one in ((low, high, high_next), (low, high_next, low_next))]
    return Mesh(nodes, np.concatenate(triangles))


def blown_ring(pressure: float, rows: int = 4) -> Robot:
    """A ring with a pressure in it, held by springs so soft that they do not count."""
    material = Material(young=YOUNG, poisson=POISSON, density=1000.0)
    body = mesh_body(ring_mesh(rows, 12 * rows), material=material).with_elements("quadratic")
    return Robot(
        name="ring",
        body=body,
        pins=(Pin(box=((-1.0, -1.0), (1.0, 1.0)), stiffness=1e-3),),
        loads=(Load(name="air", at=(0.0, 0.0), pressure=pressure),),
        poses={},
    )


@pytest.mark.parametrize("pressure", [PRESSURE, -PRESSURE])
def test_a_thick_ring_widens_as_lame_says(pressure: float) -> None:
    """Plane strain: u = (1 + nu) / E p a^2 / (b^2 - a^2) ((1 - 2 nu) r + b^2 / r)."""
    robot = blown_ring(pressure)
    moved = Simulation(robot).solve([]).nodes
    before, after = (np.linalg.norm(nodes, axis=1) for nodes in (robot.body.mesh.nodes, moved))
    share = (1 + POISSON) / YOUNG * pressure * INNER**2 / (OUTER**2 - INNER**2)
    widened = share * ((1 - 2 * POISSON) * before + OUTER**2 / before)
    assert after - before == pytest.approx(widened, rel=0.02)


def test_the_cavity_of_a_body_is_the_one_around_the_point() -> None:
    """A box of 5 x 5 x 5 cells without its middle one, and a ring: volumes with their signs, and points in none."""
    whole = box_mesh((5, 5, 5), size=(0.05, 0.05, 0.05))
    middles = whole.nodes[whole.elements].mean(axis=1)
    center = (whole.nodes.max(axis=0) + whole.nodes.min(axis=0)) / 2
    hollow = Mesh(whole.nodes, whole.elements[np.abs(middles - center).max(axis=1) > 0.005])
    facets = hollow.cavity(center)
    assert -np.linalg.det(hollow.nodes[facets]).sum() / 6 == pytest.approx(0.01**3)
    assert not len(hollow.cavity(center + 0.015))
    assert not len(hollow.cavity(center + 1.0))
    ring = ring_mesh(2, 60)
    assert len(ring.cavity(np.array([0.0, 0.015]))) == 60
    assert not len(ring.cavity(np.array([0.03, 0.0])))
