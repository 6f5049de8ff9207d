"""A flat-and-thick plush as a body in space: its outline blown up."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve
from shapely import maximum_inscribed_circle

from hydrostat.arrays import Bool, Elements, Float, Int, Nodes, Vector
from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.outline import Outline
from hydrostat.geometry.surface import Surface
from hydrostat.geometry.triangles.triangulate import triangulate

_STEPS = 4


def inflate(outline: Outline, height: float, *, spacing: float) -> Surface:
    """Blow up an outline to a closed surface, mirrored in the plane of the outline (z = 0).

    The thickness is proportional to the root of u, with lap u = -1 in the outline and u = 0 on its rim (Baran 2009). So
    the rim is round and upright, an arm is rounded like the belly but thinner, a disc becomes an ellipsoid; a hole in
    the outline is a hole through the body. u is solved by linear finite elements; the volume converges with the power
    3/2 of the spacing, for u bends in the row next to the rim and the root of it more so.
    The same input gives the same surface.

    Args:
        outline: outline of the body [m].
        height: thickness where it is thickest [m].
        spacing: length of the edges of the triangles [m]; shorter next to the rim, where the surface bends.

    Raises:
        InputError: `height` is not positive, or far more than the outline is wide; `spacing` makes too few or too
            many triangles.
        OutlineError: the outline is too thin somewhere for the spacing; the message says where.
    """
    if not 0.0 < height < np.inf:
        raise InputError(f"the height must be positive, not {height} m")
    widest = 2 * float(maximum_inscribed_circle(outline.polygon).length)
    stout = 1.5  # times as thick as wide is no plush any more
    if height > stout * widest:
        raise InputError(
            f"the height of {1e3 * height:.4g} mm is too much for an outline {1e3 * widest:.3g} mm wide at its widest: "
            f"take {1e3 * stout * widest:.3g} mm or less"
        )
    try:
        mesh = _without_bridges(triangulate(outline, spacing))
    except OutlineError:
        raise
    except InputError as error:
        raise InputError(f"spacing: {error}") from None
    bulge = torsion(mesh)
    rim = np.zeros(len(mesh.nodes), dtype=bool)
    rim[mesh.boundary_nodes] = True
    nodes, triangles, bulge = _grade_mesh(mesh, rim, bulge)
    return _both_sides(nodes, triangles, 0.5 * height * np.sqrt(bulge / bulge.max()), int(rim.sum()))


def torsion(mesh: Mesh) -> Vector:
    """Solution u of lap u = -1 inside a flat mesh with u = 0 on the boundary, at the nodes [m^2].

    Named after the twisting of bars, where it is known as Prandtl's stress function.
    """
    corners = mesh.nodes[mesh.elements]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    blocks = np.einsum("tid,tjd->tij", opposite, opposite) / (4.0 * mesh.volumes[:, None, None])
    rows, columns = np.repeat(mesh.elements, 3, axis=1), np.tile(mesh.elements, (1, 3))
    count = len(mesh.nodes)
    stiffness = coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count)).tocsc()
    load = np.bincount(mesh.elements.ravel(), weights=np.repeat(mesh.volumes / 3.0, 3), minlength=count)
    inner = np.setdiff1d(np.arange(count), mesh.boundary_nodes)
    bulge = np.zeros(count)
    bulge[inner] = np.asarray(spsolve(stiffness[inner][:, inner], load[inner]))
    # Exact solutions are positive inside; elements with blunt corners promise it only in the limit.
    bulge[inner] = np.maximum(bulge[inner], 1e-6 * bulge.max())
    return bulge


def _without_bridges(mesh: Mesh) -> Mesh:
    """Mesh with a node in the middle of each inner edge that runs from rim to rim, where u could not rise."""
    rim = np.zeros(len(mesh.nodes), dtype=bool)
    rim[mesh.boundary_nodes] = True
    outer = {tuple(edge) for edge in np.sort(mesh.boundary, axis=1).tolist()}
    bridges = [edge for edge in mesh.edges[rim[mesh.edges].all(axis=1)].tolist() if tuple(edge) not in outer]
    if not bridges:
        return mesh
    number = {tuple(edge): len(mesh.nodes) + index for index, edge in enumerate(bridges)}
    nodes = np.concatenate([mesh.nodes, mesh.nodes[np.array(bridges)].mean(axis=1)])
    elements = [part for element in mesh.elements.tolist() for part in _split_triangle(tuple(element), number)]
    return Mesh(nodes, np.array(elements))


def _split_triangle(triangle: tuple[int, ...], middles: dict[tuple[int, ...], int]) -> list[tuple[int, ...]]:
    """Triangle, cut where its sides have a middle node; one side after another, so that neighbors agree."""
    for turn in range(3):
        a, b, c = (triangle[(turn + corner) % 3] for corner in range(3))
        middle = middles.get((min(a, b), max(a, b)))
        if middle is not None:
            return _split_triangle((a, middle, c), middles) + _split_triangle((middle, b, c), middles)
    return [triangle]


def _grade_mesh(mesh: Mesh, rim: Bool[np.ndarray, " _"], bulge: Vector) -> tuple[Nodes, Elements, Vector]:
    """Mesh with its edges that leave the rim divided, finer towards the rim, and u at its nodes.

    At shares 1/16, 4/16, 9/16 of the first row the root of u rises in even steps, as u is all but linear there.
    """
    leaving = mesh.edges[rim[mesh.edges].sum(axis=1) == 1]
    leaving = np.where(rim[leaving[:, :1]], leaving, leaving[:, ::-1])
    shares = (np.arange(1, _STEPS) / _STEPS)[None, :, None] ** 2
    start, end = mesh.nodes[leaving[:, 0], None], mesh.nodes[leaving[:, 1], None]
    added = start + shares * (end - start)
    steps = len(mesh.nodes) + np.arange(len(leaving) * (_STEPS - 1)).reshape(-1, _STEPS - 1)
    ladders = {(a, b): [a, *between, b] for (a, b), between in zip(leaving.tolist(), steps.tolist(), strict=True)}
    triangles = [part for element in mesh.elements.tolist() for part in _rungs(element, rim, ladders)]
    risen = shares[..., 0] * bulge[leaving[:, 1], None]
    return (
        np.concatenate([mesh.nodes, added.reshape(-1, 2)]),
        np.array(triangles),
        np.concatenate([bulge, risen.ravel()]),
    )


def _rungs(
    element: list[int], rim: Bool[np.ndarray, " _"], ladders: dict[tuple[int, int], list[int]]
) -> list[tuple[int, int, int]]:
    """Triangle cut along the divisions of its two sides that leave the rim, if it has such."""
    onto = [bool(rim[node]) for node in element]
    if sum(onto) == 0:
        return [(element[0], element[1], element[2])]
    # Turn it so that the odd one out comes first: the one inside, or the one on the rim.
    turn = onto.index(sum(onto) == 1)
    a, b, c = element[turn], element[(turn + 1) % 3], element[(turn + 2) % 3]
    left, right = (ladders[a, b], ladders[a, c]) if onto[turn] else (ladders[b, a][::-1], ladders[c, a][::-1])
    parts = [(a, left[1], right[1])]
    for step in range(1, _STEPS):
        parts.append((left[step], left[step + 1], right[step + 1]))
        parts.append((left[step], right[step + 1], right[step]))
    return parts


def _both_sides(
    nodes: Nodes, triangles: Int[np.ndarray, "triangles 3"], rise: Float[np.ndarray, " nodes"], rim: int
) -> Surface:
    """Surface over the triangles and its mirror image below, joined where the rise is none."""
    below = np.flatnonzero(rise > 0.0)
    if len(nodes) - len(below) != rim:
        raise OutlineError("the body is too thin to be inflated: take a larger spacing or a wider outline")
    mirror = np.arange(len(nodes))
    mirror[below] = len(nodes) + np.arange(len(below))
    vertices = np.concatenate([np.column_stack([nodes, rise]), np.column_stack([nodes[below], -rise[below]])])
    return Surface(vertices, np.concatenate([triangles, mirror[triangles][:, ::-1]]))
