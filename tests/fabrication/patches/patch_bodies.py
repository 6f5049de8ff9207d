"""Small surfaces whose flat images are known, and bodies of them."""

import numpy as np
from builders import box_mesh, mesh_body

from hydrostat.fabrication.patches.patch import Disc, rim_of
from hydrostat.fabrication.patches.skin_mesh import SkinMesh
from hydrostat.geometry import Mesh
from hydrostat.robot import MATERIALS, Body, Cable, Pin, Robot, Winch


def grid_disc(places: np.ndarray) -> Disc:
    """A disc of a grid of places, rows x columns x 3, each cell cut in two."""
    rows, columns = places.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return disc(places.reshape(-1, 3), triangles)


def disc(vertices: np.ndarray, triangles: np.ndarray) -> Disc:
    """A disc of triangles."""
    return Disc(vertices=vertices, triangles=triangles, rim=rim_of(triangles), of=np.arange(len(vertices)))


def half_cylinder(radius: float = 20.0, length: float = 60.0, rows: int = 9, columns: int = 13) -> Disc:
    """Half of the side of a cylinder, of flat strips along it [mm]."""
    turn, along = np.meshgrid(np.linspace(0, np.pi, columns), np.linspace(0, length, rows))
    return grid_disc(np.stack([radius * np.cos(turn), radius * np.sin(turn), along], axis=-1))


def half_cone(rows: int = 8, columns: int = 13) -> Disc:
    """Half of the side of a cone without its tip [mm]."""
    turn, along = np.meshgrid(np.linspace(0, np.pi, columns), np.linspace(10, 60, rows))
    return grid_disc(np.stack([0.5 * along * np.cos(turn), 0.5 * along * np.sin(turn), along], axis=-1))


def folded(rows: int = 7) -> Disc:
    """Three sides of a box, one after the other [mm]."""
    path = np.array([(0, 0), (10, 0), (20, 0), (30, 0), (30, 12), (30, 25), (15, 25), (0, 25)], dtype=float)
    across = np.linspace(0, 40, rows)
    return grid_disc(np.stack([np.column_stack([path, np.full(len(path), y)]) for y in across]))


def cap(angle: float, radius: float = 50.0, rings: int = 16, columns: int = 48) -> Disc:
    """A cap of a sphere, its rim that far from its pole as seen from the center [mm]."""
    tilt = np.repeat(angle * np.arange(1, rings + 1) / rings, columns)
    turn = np.tile(2 * np.pi * np.arange(columns) / columns, rings)
    ring = np.column_stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
    vertices = radius * np.concatenate([[[0.0, 0.0, 1.0]], ring])
    index = 1 + np.arange(rings * columns).reshape(rings, columns)
    after = np.roll(index, -1, axis=1)
    fan = np.column_stack([np.zeros(columns, dtype=np.int64), index[0], after[0]])
    a, b, c, d = (part.ravel() for part in (index[:-1], index[1:], after[1:], after[:-1]))
    return disc(vertices, np.concatenate([fan, np.column_stack([a, b, c]), np.column_stack([a, c, d])]))


def ellipsoid_body(size: tuple[float, float, float] = (0.12, 0.05, 0.1), cells: int = 6) -> Body:
    """An ellipsoid of tetrahedra about the origin, as long along each axis as told [m]."""
    mesh = box_mesh((cells, cells, cells), size=(2.0, 2.0, 2.0))
    cube = mesh.nodes - 1.0
    longest, norm = np.abs(cube).max(axis=1, keepdims=True), np.linalg.norm(cube, axis=1, keepdims=True)
    ball = cube * longest / np.maximum(norm, 1e-12)
    return mesh_body(Mesh(ball * np.array(size) / 2, mesh.elements), material=MATERIALS["polyester fibre"])


def cushion(body: Body, *routes: list[tuple[float, float, float]]) -> Robot:
    """A robot with a winch at the first point of each route [m]."""
    return Robot(
        name="cushion",
        body=body,
        pins=(Pin(at=(0.0, 0.0, 0.0), radius=1.0),),
        winches=tuple(Winch(name=f"w{number}", at=route[0]) for number, route in enumerate(routes)),
        cables=tuple(Cable(winch=f"w{number}", points=tuple(route)) for number, route in enumerate(routes)),
        poses={},
    )


def skin_of_ball(radius: float = 40.0) -> SkinMesh:
    """A sphere [mm]."""
    import igl

    vertices, triangles = _octahedron()
    for _ in range(4):
        vertices, triangles = (np.array(part) for part in igl.upsample(vertices, triangles, 1))
        vertices = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    patch = np.zeros(len(triangles), dtype=np.int64)
    return SkinMesh(vertices=radius * vertices, triangles=triangles.astype(np.int64), patch=patch)


def _octahedron() -> tuple[np.ndarray, np.ndarray]:
    vertices = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=float)
    corners = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    return vertices, np.array(corners)
