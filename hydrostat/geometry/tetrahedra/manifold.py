"""`manifold`: tetrahedra whose boundary is a proper surface: every edge of it between two facets, one fan a node."""

import numpy as np

from hydrostat.arrays import Elements, Int, Nodes, Points
from hydrostat.geometry.mesh import Mesh, joined_groups
from hydrostat.geometry.tetrahedra.stuffing import Numbers, signed_volumes


def manifold(nodes: Nodes, elements: Elements) -> tuple[Mesh, Points]:
    """Largest part that faces join, with a node of its own for each group of elements that faces join about it.

    So what touches at an edge or a node only, such as two fingers, is parted. Where an edge is left between two groups
    about it that are joined elsewhere, the smaller group goes; where two hollows meet at a node, what lies at the
    smaller. Nodes keep their order. Returns for each other part, too, its places nearest to the rest, and the middles
    of what went [m].
    """
    part = _parts(elements)
    mesh, breaks = _split_nodes(nodes, elements[part == _largest(part)]), [_breaks(nodes, elements, part)]
    while (gone := _crowded_edge_elements(mesh)).any() or (gone := _pinched_node_elements(mesh)).any():
        left = np.flatnonzero(~gone)
        part = _parts(mesh.elements[left])
        left = left[part == _largest(part)]
        breaks.append(mesh.nodes[np.delete(mesh.elements, left, axis=0)].mean(axis=1))
        mesh = _split_nodes(mesh.nodes, mesh.elements[left])
    return mesh, np.concatenate(breaks)


def euler(triangles: Elements) -> int:
    """Euler characteristic of a closed surface: 2 for each part like a ball, 2 less for each handle."""
    return len(np.unique(triangles)) - len(triangles) // 2


def _breaks(nodes: Nodes, elements: Elements, part: Numbers) -> Points:
    from scipy.spatial import KDTree  # Imported here: not every command needs it.

    places = [np.empty((0, 3))]
    for number in np.setdiff1d(part, _largest(part)):
        own, others = (nodes[np.unique(elements[chosen])] for chosen in (part == number, part != number))
        gaps = KDTree(others).query(own)[0]
        places.append(own[gaps <= gaps.min() * (1 + 1e-9)])
    return np.concatenate(places)


def _joins(simplices: Elements) -> Int[np.ndarray, "2 joins"]:
    """Pairs of corners (corner count x simplex + corner) that are the same node of a side that two simplices share."""
    count = simplices.shape[1]
    corners = np.arange(simplices.size).reshape(-1, count)
    corners = np.take_along_axis(corners, np.argsort(simplices, axis=1), axis=1)
    faces = np.concatenate([np.delete(corners, corner, axis=1) for corner in range(count)])
    names = simplices.ravel()[faces]
    order = np.lexsort(names.T)
    same = np.flatnonzero((names[order][1:] == names[order][:-1]).all(axis=1))
    return np.stack([faces[order[same]].ravel(), faces[order[same + 1]].ravel()])


def _parts(elements: Elements) -> Numbers:
    """Number of the part, joined by faces, that each element is of."""
    return joined_groups(_joins(elements) // 4, len(elements))


def _largest(part: Numbers) -> int:
    return int(np.argmax(np.bincount(part, minlength=1)))


def _split_nodes(nodes: Nodes, elements: Elements) -> Mesh:
    """Node for every group of elements that faces join about it."""
    group = joined_groups(_joins(elements), elements.size)
    first = np.unique(group, return_index=True)[1]
    origin = elements.ravel()[first]
    order = np.lexsort((first, origin))
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return Mesh(nodes[origin[order]], rank[group].reshape(-1, 4))


def _crowded_edge_elements(mesh: Mesh) -> np.ndarray:
    """Choose elements to leave out for edges of the boundary between more than two facets: the smaller groups there."""
    sides = np.sort(
        np.concatenate([mesh.boundary[:, [0, 1]], mesh.boundary[:, [1, 2]], mesh.boundary[:, [2, 0]]]), axis=1
    )
    keys, counts = np.unique(sides[:, 0] * len(mesh.nodes) + sides[:, 1], return_counts=True)
    out = np.zeros(len(mesh.elements), dtype=bool)
    for edge in np.column_stack(np.divmod(keys[counts > 2], len(mesh.nodes))):
        around = np.flatnonzero(np.isin(mesh.elements, edge).sum(axis=1) == 2)
        group = joined_groups(_joins(mesh.elements[around]) // 4, len(around))
        volumes = signed_volumes(mesh.nodes, mesh.elements[around])
        sizes = np.bincount(group, weights=volumes)
        out[around[group != np.argmax(sizes)]] = True
    return out


def _pinched_node_elements(mesh: Mesh) -> np.ndarray:
    """Choose elements to leave out for nodes of the boundary with several fans of facets: those at the smaller fans."""
    fan = joined_groups(_joins(mesh.boundary), mesh.boundary.size)
    _, first, sizes = np.unique(fan, return_index=True, return_counts=True)
    owner = mesh.boundary.ravel()[first]
    order = np.lexsort((first, -sizes, owner))
    smaller = np.zeros(len(sizes), dtype=bool)
    smaller[order[1:]] = owner[order[1:]] == owner[order[:-1]]
    out = np.zeros(len(mesh.elements), dtype=bool)
    out[mesh.boundary_elements[np.flatnonzero(smaller[fan]) // 3]] = True
    return out
