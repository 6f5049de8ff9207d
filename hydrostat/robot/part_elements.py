"""`find_part_elements`, `find_part_facets`: elements and surfaces of the parts of a body."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from hydrostat.arrays import Float, Int, Nodes
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, locate
from hydrostat.given import list_choices
from hydrostat.robot.part import BodyPart
from hydrostat.units import quote


def find_part_elements(
    mesh: Mesh, parts: Sequence[BodyPart], labels: Mapping[str, Int[np.ndarray, " _"]]
) -> Int[np.ndarray, " elements"]:
    """Number of the part of each element of a linear mesh, from 1; 0 for the body itself.

    `labels` are the labels of its file, each with its elements.

    Raises InputError: a part of another dimension, of a name that another has, that holds no element, overlaps, or is
    rigid but in several pieces, or a label that the file does not have.
    """
    middles = mesh.nodes[mesh.elements].mean(axis=1)
    found = np.zeros(len(middles), dtype=np.int64)
    for index, part in enumerate(parts):
        where = f'winch "{part.winch}"' if part.winch else f"body.part[{index}]"
        if part.name in [other.name for other in parts[:index]]:
            raise InputError(f'{where}.name: there are two of the name "{part.name}"; names must be unique')
        if part.dim > mesh.dim:
            key = "points[0]" if part.at is None else "at"
            raise InputError(f"{where}.{key} has {part.dim} coordinates, but the body has {mesh.dim}")
        held = part.holds(middles) if part.label is None else _find_labeled(where, part.label, labels, len(middles))
        if not held.any():
            raise InputError(
                f'{where}: "{part.name}" holds no element: it lies outside the body or is thinner than an element; '
                "move it, enlarge it, or take a smaller element_size"
            )
        if part.winch:
            held = _find_largest_piece(mesh, held)
        shared = held & (found > 0)
        if shared.any():
            other = parts[found[shared][0] - 1].name
            what, more = ("its motor", ", or take a smaller motor") if part.winch else (f'"{part.name}"', "")
            raise InputError(
                f'{where}: {what} overlaps "{other}" in {int(shared.sum())} elements; move one of them{more}'
            )
        if part.is_rigid and (pieces := _pieces(mesh, part, held)):
            raise InputError(f'{where}: rigid "{part.name}" {pieces}')
        found[held] = index + 1
    return found


def _find_largest_piece(mesh: Mesh, held: np.ndarray) -> np.ndarray:
    """Mask of the elements that hang together through facets: a motor cannot be drawn larger until all do."""
    groups = Mesh(mesh.nodes, mesh.elements[held]).element_groups
    largest = held.copy()
    largest[held] = groups == np.bincount(groups).argmax()
    return largest


def _find_labeled(where: str, label: str, labels: Mapping[str, Int[np.ndarray, " _"]], count: int) -> np.ndarray:
    """Mask of the elements of a label (InputError: the file has none of the name)."""
    if label not in labels:
        known = list_choices("labels", list(labels), label) if labels else "The file has none, or is no ready mesh."
        raise InputError(f"{where}.label: unknown label {quote(label)}. {known}")
    held = np.zeros(count, dtype=bool)
    held[labels[label]] = True
    return held


def _pieces(mesh: Mesh, part: BodyPart, held: np.ndarray) -> str:
    """Complaint of elements that are not joined through facets, which could move apart or turn; empty if they are."""
    elements = mesh.elements[held]
    groups = Mesh(mesh.nodes, elements).element_groups
    count = int(groups.max()) + 1
    if count == 1:
        return ""
    nodes = [np.unique(elements[groups == group]) for group in range(count)]
    nodes.sort(key=len, reverse=True)
    told = " and ".join(_place(mesh.nodes[one].mean(axis=0)) for one in nodes[:2])
    outside = 0.0
    if part.dim == mesh.dim:
        grid = part.grid(1000)
        outside = float((~locate(mesh, grid[part.holds(grid)]).inside).mean())
    if outside < 0.05:
        return (
            f"is in {count} pieces of the mesh, at {told}: it is too thin for its elements. Enlarge it or take a "
            "smaller element_size"
        )
    apart = np.linalg.norm(mesh.nodes[nodes[0]][:, None] - mesh.nodes[nodes[1]], axis=2).min()
    return (
        f"is in {count} pieces, {1e3 * apart:.3g} mm apart, at {told}, as it leaves the body between them: they would "
        "move apart. Keep it inside the body or make it several parts"
    )


def _place(point: Float[np.ndarray, " dim"]) -> str:
    """Place [m] in millimeters."""
    return "[" + ", ".join(f"{1e3 * value:.0f}" for value in point + 0.0) + "] mm"


def find_part_facets(
    mesh: Mesh, owners: Int[np.ndarray, " elements"], count: int
) -> tuple[Int[np.ndarray, "_ 3"], ...]:
    """Facets around each of the parts of a body in space, seen from outside it; empty for a flat body.

    Args:
        mesh: mesh of the body.
        owners: part of each element, counted from 1; 0 for the body itself.
        count: number of parts.
    """
    if mesh.dim == 2:
        return ()
    return tuple(Mesh(mesh.nodes, mesh.elements[owners == index + 1]).boundary for index in range(count))


def find_rings(edges: Int[np.ndarray, "edges 2"]) -> Iterator[Int[np.ndarray, " _"]]:
    """Closed chains of directed edges."""
    following: dict[int, list[int]] = {}
    for start, end in edges.tolist():
        following.setdefault(start, []).append(end)
    while following:
        ring = [min(following)]
        while ring[-1] in following:
            here = ring[-1]
            ring.append(following[here].pop())
            if not following[here]:
                del following[here]
        yield np.array(ring[:-1])


PASSES = 3
MIN_QUALITY = 0.25
"""Least shape of an element that a move may leave, 1 for a regular one; or what it was before."""


def conform(mesh: Mesh, parts: Sequence[BodyPart]) -> Mesh:
    """Mesh with nodes moved onto the borders of parts, where an edge crosses one; nodes on the boundary stay.

    A node moves to the nearest place of the border if it is nearer to it than the other end of an edge that crosses,
    and no element becomes flatter than `MIN_QUALITY`. Elements keep their nodes.
    """
    nodes = mesh.nodes.copy()
    free = np.ones(len(nodes), dtype=bool)
    free[mesh.boundary_nodes] = False
    around = _elements_around(mesh)
    quality = _qualities(nodes, mesh.elements)
    for _ in range(PASSES):
        for part in parts:
            if part.label is not None:
                continue  # its border is one of elements already
            for node, place in _candidates(mesh, nodes, part, free):
                before, touched = nodes[node].copy(), around[node]
                nodes[node] = place
                found = _qualities(nodes, mesh.elements[touched])
                if (found < np.minimum(MIN_QUALITY, quality[touched])).any():
                    nodes[node] = before
                    continue
                quality[touched] = found
                free[node] = False
    return Mesh(nodes, mesh.elements)


def _candidates(
    mesh: Mesh, nodes: Nodes, part: BodyPart, free: np.ndarray
) -> list[tuple[int, Float[np.ndarray, " dim"]]]:
    """Nodes that should move, with their places on the border; those that are nearest to it first."""
    depths, places = part.border(nodes)
    one, two = mesh.edges.T
    crossing = depths[one] * depths[two] < 0
    one, two = one[crossing], two[crossing]
    nearer = np.where(np.abs(depths[one]) <= np.abs(depths[two]), one, two)
    chosen = np.unique(nearer[free[nearer]])
    chosen = chosen[np.argsort(np.abs(depths[chosen]), kind="stable")]
    return [(int(node), places[node]) for node in chosen]


def _elements_around(mesh: Mesh) -> list[Int[np.ndarray, " _"]]:
    """Elements at each node."""
    corners = mesh.elements.ravel()
    owners = np.repeat(np.arange(len(mesh.elements)), mesh.elements.shape[1])[np.argsort(corners, kind="stable")]
    return np.split(owners, np.cumsum(np.bincount(corners, minlength=len(mesh.nodes)))[:-1])


def _qualities(nodes: Nodes, elements: Int[np.ndarray, "elements corners"]) -> Float[np.ndarray, " elements"]:
    """Volume over that of the regular simplex with the same mean square of its edges; below 0 if turned over."""
    corners, dim = nodes[elements], nodes.shape[1]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / (2.0 if dim == 2 else 6.0)
    spans = corners[:, :, None] - corners[:, None]
    squares = (spans**2).sum(axis=(1, 2, 3)) / (dim * (dim + 1))  # each edge stands there twice
    regular = np.sqrt(3.0) / 4 if dim == 2 else np.sqrt(2.0) / 12
    return volumes / (regular * squares ** (dim / 2))
