"""Surfaces of known volume [m], and what makes them dirty: as scans, careless CAD and damaged files are."""

import numpy as np

from hydrostat.geometry.contour import contour
from hydrostat.geometry.surface import Surface


def sphere(radius: float = 0.03, center: tuple[float, float, float] = (0.0, 0.0, 0.0), divisions: int = 4) -> Surface:
    """An icosahedron, each triangle divided in four again and again, blown up to a sphere."""
    golden = (1 + 5**0.5) / 2
    vertices = np.array(
        [p for a in (-1, 1) for b in (-golden, golden) for p in ((a, b, 0.0), (0.0, a, b), (b, 0.0, a))]
    )
    from scipy.spatial import ConvexHull

    triangles = ConvexHull(vertices).simplices.astype(np.int64)
    for _ in range(divisions):
        sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        edges, place = np.unique(sides, axis=0, return_inverse=True)
        middle = (len(vertices) + place).reshape(-1, 3)
        vertices = np.concatenate([vertices, vertices[edges].mean(axis=1)])
        one, two, three = triangles.T
        first, second, third = middle.T
        triangles = np.concatenate(
            [
                np.stack(corners, axis=1)
                for corners in ((one, first, third), (first, two, second), (third, second, three), middle.T)
            ]
        )
    vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    corners = vertices[triangles]
    inward = np.linalg.det(corners) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return Surface(np.array(center) + radius * vertices, triangles)


def cuboid(lowest: tuple[float, float, float], highest: tuple[float, float, float]) -> Surface:
    """A box of 12 triangles."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [piece for a, b, c, d in quads for piece in ((a, b, c), (a, c, d))]
    return Surface(np.array(lowest) + corners * (np.array(highest) - lowest), np.array(triangles))


def torus(ring: float = 0.04, tube: float = 0.012, spacing: float = 0.003) -> Surface:
    """A ring about the z axis, as contoured from its closed form."""
    reach = 1.2 * (ring + tube)
    box = np.array([[-reach, -reach, -2 * tube], [reach, reach, 2 * tube]])
    return contour(lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - ring, p[:, 2]) - tube, box, spacing)


def both(*surfaces: Surface) -> Surface:
    """Several surfaces as one; they may lie in each other."""
    starts = np.cumsum([0, *(len(surface.vertices) for surface in surfaces)])
    return Surface(
        np.concatenate([surface.vertices for surface in surfaces]),
        np.concatenate([start + surface.triangles for start, surface in zip(starts, surfaces, strict=False)]),
    )


def inside_out(surface: Surface) -> Surface:
    """All triangles turned around."""
    return Surface(surface.vertices, surface.triangles[:, ::-1])


def with_flipped(surface: Surface, share: float, seed: int = 0) -> Surface:
    """A share of the triangles turned around."""
    triangles = surface.triangles.copy()
    chosen = np.random.default_rng(seed).random(len(triangles)) < share
    triangles[chosen] = triangles[chosen][:, ::-1]
    return Surface(surface.vertices, triangles)


def with_hole(surface: Surface, center: np.ndarray, radius: float) -> Surface:
    """Without the triangles whose middle is nearer to a place than a radius."""
    middles = surface.vertices[surface.triangles].mean(axis=1)
    return Surface(surface.vertices, surface.triangles[np.linalg.norm(middles - center, axis=1) > radius])


def with_small_holes(surface: Surface, count: int, seed: int = 0) -> Surface:
    """Without some single triangles, none next to another."""
    chosen = np.random.default_rng(seed).choice(len(surface.triangles), count, replace=False)
    return Surface(surface.vertices, np.delete(surface.triangles, chosen, axis=0))


def unmerged(surface: Surface) -> Surface:
    """Every triangle with three vertices of its own, as in STL files."""
    return Surface(surface.vertices[surface.triangles].reshape(-1, 3), np.arange(surface.triangles.size).reshape(-1, 3))


def with_duplicates(surface: Surface, count: int) -> Surface:
    """The first triangles twice, and as many that have no area."""
    first = surface.triangles[:count]
    return Surface(surface.vertices, np.concatenate([surface.triangles, first, first[:, [0, 1, 1]]]))


def with_slivers(surface: Surface, count: int, share: float = 1e-4) -> Surface:
    """Some edges cut very near to their end, which makes triangles like needles; the shape stays."""
    vertices, triangles = list(surface.vertices), surface.triangles.tolist()
    for number in range(0, 20 * count, 20):
        one, two, _ = triangles[number]
        cut = len(vertices)
        vertices.append(vertices[one] + share * (vertices[two] - vertices[one]))
        for place in [n for n, corners in enumerate(triangles) if one in corners and two in corners]:
            corners = triangles[place]
            triangles[place] = [cut if corner == one else corner for corner in corners]
            triangles.append([cut if corner == two else corner for corner in corners])
    return Surface(np.array(vertices), np.array(triangles))


def with_noise(surface: Surface, size: float, seed: int = 0) -> Surface:
    """Every vertex moved by a random way."""
    random = np.random.default_rng(seed)
    return Surface(surface.vertices + size * random.standard_normal(surface.vertices.shape), surface.triangles)


def with_specks(surface: Surface, centers: np.ndarray, radius: float) -> Surface:
    """Small loose spheres beside it."""
    return both(surface, *(sphere(radius, tuple(map(float, center)), 1) for center in centers))


def lens(radius: float, apart: float) -> float:
    """Volume of what two equal spheres share (Wolfram MathWorld, sphere-sphere intersection)."""
    return np.pi * (4 * radius + apart) * (2 * radius - apart) ** 2 / 12
