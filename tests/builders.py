"""Small meshes and robots, made in code; robots of the gallery, read once."""

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import permutations
from typing import Any

import numpy as np

from hydrostat.geometry import Mesh
from hydrostat.robot import (
    Body,
    Cable,
    Marker,
    Material,
    Mount,
    Pin,
    Robot,
    Source,
    Winch,
    gallery_folder,
    list_gallery,
    load_robot,
)

FOAM = Material(young=30e3, poisson=0.3, density=40)


def strip_mesh(columns: int, rows: int, *, size: tuple[float, float] = (0.2, 0.05)) -> Mesh:
    """Rectangle [0, length] x [-height/2, height/2]; diagonals alternate, so that the pattern favors no direction."""
    length, height = size
    x, y = np.meshgrid(np.linspace(0, length, columns + 1), np.linspace(-height / 2, height / 2, rows + 1))
    elements = []
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            even = (row + column) % 2 == 0
            elements += [(a, b, c), (a, c, d)] if even else [(a, b, d), (b, c, d)]
    return Mesh(np.column_stack([x.ravel(), y.ravel()]), np.array(elements))


def box_mesh(cells: tuple[int, int, int], *, size: tuple[float, float, float] = (0.1, 0.05, 0.05)) -> Mesh:
    """Box of tetrahedra: each cell cut into six about its diagonal (Kuhn)."""
    axes = [np.linspace(0, side, count + 1) for side, count in zip(size, cells, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    index = np.arange(len(nodes)).reshape([count + 1 for count in cells])
    elements = []
    for corner in np.ndindex(*cells):
        for order in permutations(range(3)):
            place, path = np.array(corner), [index[corner]]
            for axis in order:
                place[axis] += 1
                path.append(index[tuple(place)])
            if np.linalg.det(nodes[path[1:]] - nodes[path[0]]) < 0:
                path[2], path[3] = path[3], path[2]
            elements.append(path)
    return Mesh(nodes, np.array(elements))


def mesh_body(mesh: Mesh, *, thickness: float | None = None, material: Material = FOAM) -> Body:
    """A body of a ready mesh, without a file."""
    flat = 0.03 if mesh.dim == 2 and thickness is None else thickness
    return Body(source=Source.MESH, file="made.vtk", content=b"", material=material, thickness=flat, mesh=mesh)


def strip_robot(
    *,
    columns: int = 16,
    rows: int = 4,
    mount: Mount = Mount.BODY,
    slack: float = 0.0,
    sheathed: tuple[tuple[int, int], ...] = (),
    stiffness: float = 4e3,
) -> Robot:
    """A strip 200 x 50 mm held at its left end, with one cable above and one below the middle.

    With `Mount.WORLD` the upper winch stands in the world, beyond the strip's left end.
    """
    stops = np.linspace(0.01, 0.19, 7)
    upper = [(float(x), 0.015) for x in stops]
    lower = [(float(x), -0.012) for x in stops]
    if mount is Mount.WORLD:
        upper[0] = (-0.05, 0.04)
    options = {"slack": slack, "sheathed": sheathed, "stiffness": stiffness}
    return Robot(
        name="strip",
        body=mesh_body(strip_mesh(columns, rows)),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0))),),
        winches=(Winch(name="up", at=upper[0], mount=mount), Winch(name="down", at=lower[0])),
        cables=(
            Cable(winch="up", points=tuple(upper), **options),
            Cable(winch="down", points=tuple(lower)),
        ),
        markers=(Marker(name="tip", at=(0.2, 0.0)),),
        poses={},
    )


def routed_strip(
    routes: Mapping[str, Sequence[tuple[float, float]]],
    *,
    slack: float = 0.0,
    gravity: tuple[float, float] | None = None,
    **winch: float,
) -> Robot:
    """A coarse strip 200 x 50 mm on soft pins at its left end, with a cable for each winch, and three markers."""
    return Robot(
        name="strip",
        body=mesh_body(strip_mesh(8, 2)),
        pins=(Pin(box=((-0.001, -1.0), (0.001, 1.0)), stiffness=3e3),),
        gravity=gravity,
        winches=tuple(Winch(name=name, at=route[0], **winch) for name, route in routes.items()),
        cables=tuple(Cable(winch=name, points=tuple(route), slack=slack) for name, route in routes.items()),
        markers=tuple(Marker(name=name, at=(x, 0.0)) for name, x in (("root", 0.03), ("middle", 0.11), ("tip", 0.19))),
        poses={},
    )


def box_robot() -> Robot:
    """A box 120 x 40 x 40 mm held at its left end, with two cables along it."""
    stops = np.linspace(0.005, 0.115, 5)
    tracks = {"one": (0.01, 0.03), "two": (0.03, 0.01)}
    points = {name: tuple((float(x), y, z) for x in stops) for name, (y, z) in tracks.items()}
    return Robot(
        name="box",
        body=mesh_body(box_mesh((6, 2, 2), size=(0.12, 0.04, 0.04))),
        pins=(Pin(box=((-0.001, -1.0, -1.0), (0.001, 1.0, 1.0))),),
        winches=tuple(Winch(name=name, at=points[name][0]) for name in tracks),
        cables=tuple(Cable(winch=name, points=points[name]) for name in tracks),
        markers=(Marker(name="tip", at=(0.12, 0.02, 0.02)),),
        poses={},
    )


@cache
def gallery_texts() -> dict[str, dict[str, Any]]:
    """What is written in robot.toml of each robot of the gallery; nothing is meshed."""
    return {name: tomllib.loads((gallery_folder(name) / "robot.toml").read_text("utf-8")) for name in list_gallery()}


@cache
def gallery_robot(name: str) -> Robot:
    """A robot of the gallery, meshed once in a process: robots do not change."""
    return load_robot(gallery_folder(name))
