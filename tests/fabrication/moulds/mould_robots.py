"""Small robots to cast, of tetrahedra whose volumes are known."""

import numpy as np
from builders import box_mesh, mesh_body

from hydrostat.geometry import Mesh
from hydrostat.robot import MATERIALS, Body, Cable, Pin, Robot, Winch

CELLS = (5, 4, 3)


def slab_body(size: tuple[float, float, float] = (0.1, 0.08, 0.06), *, material: str = "flexfoam-it x") -> Body:
    """A box of tetrahedra about the origin [m]."""
    mesh = box_mesh(CELLS, size=size)
    return mesh_body(Mesh(mesh.nodes - np.array(size) / 2, mesh.elements), material=MATERIALS[material])


def blob_body(size: tuple[float, float, float] = (0.12, 0.08, 0.06)) -> Body:
    """A box bent and twisted a little, so that no wall is flat: its volume is the sum of its tetrahedra."""
    mesh = box_mesh((8, 6, 4), size=size)
    x, y, z = (mesh.nodes - np.array(size) / 2).T
    round_y, round_z = y * (1 - 40 * x**2), z * (1 - 60 * x**2 - 100 * y**2)
    nodes = np.column_stack([x + 2 * y * z, round_y + 3 * x**2, round_z])
    return mesh_body(Mesh(nodes, mesh.elements), material=MATERIALS["flexfoam-it x"])


def foam_robot(
    body: Body, *winches: tuple[float, float, float], at: tuple[float, float, float] = (0, 0, 0.025)
) -> Robot:
    """A robot held at its left end, with a cable from each winch to a point."""
    names = [f"w{number}" for number in range(len(winches))]
    return Robot(
        name="slab",
        body=body,
        pins=(Pin(box=((-1.0, -1.0, -1.0), (-0.04, 1.0, 1.0))),),
        winches=tuple(Winch(name=name, at=place) for name, place in zip(names, winches, strict=True)),
        cables=tuple(Cable(winch=name, points=(place, at)) for name, place in zip(names, winches, strict=True)),
        poses={},
    )
