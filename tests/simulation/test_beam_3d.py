"""Cables bend a beam of tetrahedra as finite elasticity says. Oracle: finite flexure in one dimension (flexure.py).

With Poisson's ratio 0 the stress across the width is mu (t - 1/t), whatever the other stretches are: free sides do not
move, so the solution in plane strain is that in space. The cables lie side by side over the whole width, those at the
two sides half as stiff, which is the sheet of cable of the reference. Linear tetrahedra must approach it at second
order.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from builders import box_mesh, mesh_body
from flexure import curvature

from hydrostat.robot import Cable, Material, Pin, Robot, Winch
from hydrostat.simulation import Simulation

HEIGHT, LENGTH, WIDTH, OFFSET = 0.02, 0.12, 0.005, 0.005
MATERIAL = Material(young=30e3, poisson=0.0, density=40)
CONTRACTION, STIFFNESS = 0.02, 4e3
ROWS = (4, 8, 16)


@dataclass(frozen=True)
class Bent:
    """Sum of the tensions [N], curvature [1/m] of the middle half, and how far its sections turn out of the plane."""

    tension: float
    curvature: float
    twist: float


@cache
def bend(rows: int) -> Bent:
    """A beam `rows` elements high, with a via point at every node of the plane Y = -offset."""
    columns, layers = round(LENGTH / HEIGHT * rows), round(WIDTH / HEIGHT * rows)
    along, across = np.linspace(0, LENGTH, columns + 1), np.linspace(0, WIDTH, layers + 1)
    shares = np.full(layers + 1, 1 / layers)
    shares[[0, -1]] *= 0.5
    routes = [tuple((float(x), HEIGHT / 2 - OFFSET, float(z)) for x in along) for z in across]
    mesh = box_mesh((columns, rows, layers), size=(LENGTH, HEIGHT, WIDTH))
    robot = Robot(
        name="beam",
        body=mesh_body(mesh, material=MATERIAL),
        pins=tuple(Pin(at=(0.0, y, z)) for y, z in ((HEIGHT / 2, 0.0), (0.75 * HEIGHT, 0.0), (HEIGHT / 2, WIDTH))),
        winches=tuple(Winch(name=f"winch {index}", at=route[0]) for index, route in enumerate(routes)),
        cables=tuple(
            Cable(winch=f"winch {index}", points=route, stiffness=STIFFNESS * float(share))
            for index, (route, share) in enumerate(zip(routes, shares, strict=True))
        ),
        poses={},
    )
    pose = Simulation(robot).solve(np.full(len(routes), CONTRACTION))
    assert pose.result.stable
    nodes = pose.nodes.reshape(columns + 1, rows + 1, layers + 1, 3)
    slopes = np.einsum("r,crld->cd", np.linspace(-HEIGHT / 2, HEIGHT / 2, rows + 1), nodes)
    middle = np.abs(along - LENGTH / 2) <= LENGTH / 4 + 1e-9
    turns = np.unwrap(np.arctan2(slopes[:, 0], slopes[:, 1]))
    return Bent(
        tension=float(pose.tensions.sum()),
        curvature=float(np.polyfit(along[middle], turns[middle], 1)[0]),
        twist=float(np.abs(slopes[:, 2]).max() / np.abs(slopes).max()),
    )


def reference(tension: float, *, offset: float = OFFSET) -> float:
    mu, lame = MATERIAL.lame
    return curvature(tension, height=HEIGHT, offset=offset, thickness=WIDTH, mu=mu, lame=lame)


@pytest.mark.slow
def test_the_curvature_converges_to_finite_flexure_at_second_order() -> None:
    """16.9, 4.9 and 1.3 % too stiff: orders of 1.78 and 1.94; with the leading error removed 0.08 % is left."""
    found = np.array([bend(rows).curvature / reference(bend(rows).tension) - 1 for rows in ROWS])
    orders = np.log2(found[:-1] / found[1:])
    limits = (4 * found[1:] - found[:-1]) / 3
    assert (orders > 1.7).all()
    assert orders[-1] == pytest.approx(2.0, abs=0.1)
    assert abs(limits[-1]) < abs(limits[-1] - limits[-2])
    assert abs(limits[-1]) < 2e-3


@pytest.mark.slow
def test_a_misplaced_cable_is_told_apart() -> None:
    """The check can fail: a cable 2 % of the height away is 5 % off."""
    finest = bend(ROWS[-1])
    misplaced = reference(finest.tension, offset=OFFSET + 0.02 * HEIGHT)
    assert abs(finest.curvature / misplaced - 1) > 0.04


@pytest.mark.slow
def test_the_sections_turn_out_of_the_plane_by_what_the_mesh_is_askew() -> None:
    """The diagonals of the tetrahedra favor one side; what comes of that falls with the mesh."""
    twists = [bend(rows).twist for rows in ROWS]
    assert twists[0] > twists[1] > twists[2]
    assert twists[2] < 0.03
