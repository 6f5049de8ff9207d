"""`pinned_points`: what pins hold of a body, as points on its skin, where a ring would not show it."""

from functools import lru_cache
from itertools import product

import numpy as np

from hydrostat.arrays import Points
from hydrostat.geometry import Mesh
from hydrostat.robot import Pin, Robot

PARTS = 4  # a triangle is dotted with so many points along each side


def pinned_points(robot: Robot) -> Points:
    """Points on all that pins hold [m]: on the skin of a body in space; on a flat one, in the boxes of pins."""
    flat = robot.body.mesh.dim == 2
    return _points(robot.body.mesh, tuple(pin for pin in robot.pins if not flat or pin.box is not None))


@lru_cache(maxsize=8)
def _points(mesh: Mesh, pins: tuple[Pin, ...]) -> Points:
    held = np.zeros(len(mesh.nodes), dtype=bool)
    for pin in pins:
        held |= pin.holds(mesh)
    faces = mesh.elements if mesh.dim == 2 else mesh.boundary
    corners = mesh.nodes[faces[held[faces].all(axis=1)]]
    steps = [(i, j, PARTS - i - j) for i, j in product(range(PARTS + 1), repeat=2) if i + j <= PARTS]
    dots = np.einsum("sc,fcd->fsd", np.array(steps) / PARTS, corners).reshape(-1, mesh.dim)
    return np.unique(np.concatenate([dots, mesh.nodes[held]]).round(7), axis=0)
