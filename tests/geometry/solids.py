"""Bodies in space [m] as closed surfaces, made by trimesh or from implicit fields, and what is asked of meshes."""

from collections.abc import Callable

import numpy as np
import trimesh

from hydrostat.arrays import Points, Vector
from hydrostat.geometry.contour import contour
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.surface import Surface

make = trimesh.creation

Maker = Callable[[], Surface]


def surface(made: trimesh.Trimesh) -> Surface:
    """A surface of trimesh."""
    return Surface(np.asarray(made.vertices, dtype=float), np.asarray(made.faces))


def moved(
    body: Surface,
    *,
    turned: float = 0.0,
    about: tuple[float, float, float] = (1, 2, 3),
    shift: tuple[float, float, float] = (0, 0, 0),
    scale: float = 1.0,
) -> Surface:
    """A body scaled, turned [rad] about an axis through the origin, then shifted [m]."""
    rotation = trimesh.transformations.rotation_matrix(turned, about)[:3, :3]
    return Surface(scale * body.vertices @ rotation.T + np.array(shift), body.triangles)


def mirrored(body: Surface) -> Surface:
    """A body as a mirror shows it."""
    return Surface(body.vertices * [-1, 1, 1], body.triangles[:, ::-1])


def ball(radius: float = 0.05, divisions: int = 4) -> Surface:
    """A sphere about the origin."""
    return surface(make.icosphere(divisions, radius))


def ellipsoid(x: float, y: float, z: float) -> Surface:
    """An ellipsoid of these half axes about the origin."""
    unit = ball(1.0)
    return Surface(unit.vertices * [x, y, z], unit.triangles)


def brick(x: float, y: float, z: float) -> Surface:
    """A box of these sides about the origin."""
    return surface(make.box((x, y, z)))


def ring(around: float = 0.05, tube: float = 0.02) -> Surface:
    """A torus about the z axis."""
    return surface(make.torus(around, tube, 64, 32))


def hollow(outer: float = 0.05, inner: float = 0.03) -> Surface:
    """A ball with a closed cavity."""
    wall, hole = ball(outer, 3), ball(inner, 3)
    triangles = np.concatenate([wall.triangles, hole.triangles[:, ::-1] + len(wall.vertices)])
    return Surface(np.concatenate([wall.vertices, hole.vertices]), triangles)


def two_fingers(gap: float, width: float = 0.014) -> Surface:
    """A palm 60 mm long with two fingers of 60 mm beside each other."""
    far = 2 * width + gap
    corners = [(0, 0), (0.12, 0), (0.12, width), (0.06, width), (0.06, width + gap), (0.12, width + gap), (0.12, far)]
    from shapely import Polygon

    return surface(make.extrude_polygon(Polygon([*corners, (0, far)]), 0.02))


def capsules(seed: int) -> Surface:
    """A random smooth union of capsules that hang together."""
    random = np.random.default_rng(seed)
    ends = [random.uniform(-0.04, 0.04, 3)]
    parts = []
    for _ in range(random.integers(2, 6)):
        start = ends[random.integers(len(ends))]
        end = start + random.normal(size=3) * 0.04
        ends.append(end)
        parts.append((start, end, random.uniform(0.008, 0.018)))
    joint = 0.006

    def field(points: Points) -> Vector:
        total = np.zeros(len(points))
        for start, end, radius in parts:
            along = np.clip((points - start) @ (end - start) / ((end - start) @ (end - start)), 0, 1)
            total += np.exp(-(np.linalg.norm(points - start - along[:, None] * (end - start), axis=1) - radius) / joint)
        return -joint * np.log(np.maximum(total, 1e-300))

    margin = 0.018 + 0.01
    box = np.array([np.min(ends, axis=0) - margin, np.max(ends, axis=0) + margin])
    return contour(field, box, 0.002)


def boundary(mesh: Mesh) -> Surface:
    """The outer faces of a mesh, with no other node than theirs."""
    nodes, facets = np.unique(mesh.boundary, return_inverse=True)
    return Surface(mesh.nodes[nodes], facets.reshape(-1, 3))


def euler(body: Surface) -> int:
    """Euler characteristic: 2 for each ball-like part of the surface, 2 less for each handle."""
    sides = np.sort(body.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return len(np.unique(body.triangles)) - len(np.unique(sides, axis=0)) + len(body.triangles)


def assert_proper(mesh: Mesh) -> None:
    """Every edge of the boundary has two facets and every node of it one fan (libigl); one part; no node to spare."""
    import igl

    outer = boundary(mesh)
    sides = np.sort(outer.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()
    assert np.all(igl.is_vertex_manifold(outer.triangles))
    assert mesh.parts.max() == 0
    assert len(np.unique(mesh.elements)) == len(mesh.nodes)
    faces = np.concatenate([np.delete(mesh.elements, corner, axis=1) for corner in range(4)])
    assert np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)[1].max() <= 2
    assert (mesh.volumes > 0).all()
