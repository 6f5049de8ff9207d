"""A slender rod with nine cables, three to each third of it: the shape of OpenCR's tendon-driven continuum robot.

186.5 mm long, 5 mm in radius, 722 nodes; cables of 100 N/mm through 12, 24 or 37 via points on a circle of 4.5 mm.
"""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.geometry import Mesh
from hydrostat.robot import Body, Cable, Marker, Material, Pin, Robot, Source, Winch

LENGTH, RADIUS, CIRCLE = 0.1865, 5e-3, 4.5e-3
LAYERS, ENDS = 38, (13, 25, 38)
"""Layers of nodes along the rod, and how many of them the cables of each third pass."""


def rod_robot(friction: float) -> Robot:
    """The rod, its cables with a friction coefficient."""
    body = Body(
        source=Source.MESH, file="rod.vtk", content=b"", mesh=rod_mesh(),
        material=Material(young=5e6, poisson=0.3, density=1000.0),
    )  # fmt: skip
    heights = np.linspace(0, LENGTH, LAYERS)
    winches, cables = [], []
    for third, end in enumerate(ENDS):
        for turn in range(3):
            angle = 0.5 * third + 2 * np.pi * turn / 3
            x, y = CIRCLE * np.cos(angle), CIRCLE * np.sin(angle)
            name, points = f"{third + 1}{turn + 1}", tuple((x, y, float(height)) for height in heights[1:end])
            winches.append(Winch(name=name, at=(x, y, 0.0), travel=0.02, release=0.012))
            cables.append(Cable(winch=name, points=points, stiffness=1e5, friction=friction))
    foot = Pin(box=((-0.01, -0.01, -1e-4), (0.01, 0.01, 1e-4)))
    tip = Marker(name="tip", at=(0.0, 0.0, LENGTH))
    return Robot(
        name="rod", body=body, pins=(foot,), winches=tuple(winches), cables=tuple(cables), markers=(tip,), poses={}
    )


def rod_mesh() -> Mesh:
    """Layers of 19 nodes, prisms between them, three tetrahedra in each."""
    from scipy.spatial import Delaunay

    rings = [np.zeros((1, 2))]
    for ring in (1, 2):
        angles = 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        rings.append(0.5 * ring * RADIUS * np.column_stack([np.cos(angles), np.sin(angles)]))
    flat = np.concatenate(rings)
    low = np.sort(Delaunay(flat).simplices, axis=1)
    low = low[_areas(flat[low]) > 1e-3 * RADIUS**2]  # on a circle some have no area
    high = low + len(flat)
    parts = [
        np.column_stack([low, high[:, 2]]),
        np.column_stack([low[:, :2], high[:, 1:]]),
        np.column_stack([low[:, 0], high]),
    ]
    layer = np.concatenate(parts)
    elements = np.concatenate([layer + step * len(flat) for step in range(LAYERS - 1)])
    nodes = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in np.linspace(0, LENGTH, LAYERS)])
    sides = nodes[elements][:, 1:] - nodes[elements][:, :1]
    elements[np.linalg.det(sides) < 0] = elements[np.linalg.det(sides) < 0][:, [0, 2, 1, 3]]
    return Mesh(nodes, elements)


def rod_commands(count: int) -> Float[np.ndarray, "commands 9"]:
    """Contractions that bend each third by itself, up to 5 mm, (count, 9) [m]."""
    random = np.random.default_rng(0)
    ways, sizes = random.uniform(0, 2 * np.pi, (count, 3)), random.uniform(0, 5e-3, (count, 3))
    turns = 2 * np.pi * np.arange(3) / 3
    return (sizes[:, :, None] * np.cos(turns - ways[:, :, None])).reshape(count, 9)


def _areas(corners: np.ndarray) -> Vector:
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return np.abs(ax * by - ay * bx)
