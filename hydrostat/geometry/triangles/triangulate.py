"""Triangles from an outline."""

import numpy as np
from shapely import contains_xy, distance
from shapely import points as shapely_points

from hydrostat.arrays import Points
from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.outline import Outline
from hydrostat.geometry.triangles.divide import Spacing, divide
from hydrostat.geometry.triangles.draft import Draft
from hydrostat.geometry.triangles.relax import push_apart, repair, smooth

_MIN_NODES, _MAX_NODES = 8, 200_000


def triangulate(outline: Outline, element_size: float) -> Mesh:
    """Fill an outline with triangles as near to equilateral as it allows, with edges of about the element size [m].

    Corners stay; elsewhere the sides of the mesh follow the outline to within a fifth of an element. Elements are
    smaller where the body is thin or the outline bends much. The same outline and size give the same mesh.

    Raises:
        InputError: so large that the body has too few elements, or so small that it has too many.
        OutlineError: the body is too thin somewhere; the message says where.
    """
    _check_element_size(outline, element_size)
    draft = _with_all_sides(divide(outline, element_size))
    spacing = _inner_spacing(draft)
    draft = _with_all_sides(Draft(draft.divisions, _seeds(draft, spacing)))
    for _ in range(6):
        added = _gap_centers(draft, spacing)
        if not len(added):
            break
        draft = _with_all_sides(Draft(draft.divisions, np.concatenate([draft.interior, added])))
    draft = _with_all_sides(push_apart(draft, spacing, steps=12))
    draft = smooth(draft, power=2.0, rounds=6)
    draft = repair(smooth(draft, power=8.0, rounds=4))
    return _mesh(draft, element_size)


def _check_element_size(outline: Outline, element_size: float) -> None:
    """Refuse element sizes that make too few or too many elements."""
    if not 0.0 < element_size < np.inf:
        raise InputError(f"the element size must be positive, not {element_size} m")
    count = outline.area / (0.25 * np.sqrt(3.0) * element_size**2)
    size = f"elements of {1e3 * element_size:.4g} mm"
    if count < _MIN_NODES:
        most = 0.9e3 * element_size * np.sqrt(count / _MIN_NODES)
        body = f"a body of {1e3 * outline.size:.4g} mm"
        raise InputError(f"{size} are too large for {body}: take {most:.2g} mm or less")
    if count > _MAX_NODES:
        least = 1.1e3 * element_size * np.sqrt(count / _MAX_NODES)
        raise InputError(f"{size} would be {count:.3g}, at most {_MAX_NODES} are made: take {least:.2g} mm or more")


def _with_all_sides(draft: Draft) -> Draft:
    """Split sides of the outline until the triangles have them all."""
    for _ in range(30):
        if not draft.missing_sides.size:
            return draft
        for node in sorted(
            {int(pair.min() if np.ptp(pair) == 1 else pair.max()) for pair in draft.missing_sides}, reverse=True
        ):
            ring, number = draft.place(node)
            draft = draft.with_division(ring, draft.divisions[ring].split(number))
    raise OutlineError("the outline comes too near to itself for this element size: take smaller elements")


def _inner_spacing(draft: Draft) -> Spacing:
    """Spacing inside that follows the sides of the outline."""
    ends = draft.points[draft.edges]
    return Spacing(ends.mean(axis=1), np.minimum(1.0, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)))


def _seeds(draft: Draft, spacing: Spacing) -> Points:
    """Hexagonal lattice where the spacing is full, half a step off the outline."""
    low, high = draft.points.min(axis=0), draft.points.max(axis=0)
    middle, rise = 0.5 * (low + high), 0.5 * np.sqrt(3.0)
    columns, rows = np.ceil((high - middle) / [1.0, rise]).astype(int) + 1
    column, row = np.meshgrid(np.arange(-columns, columns + 1), np.arange(-rows, rows + 1))
    lattice = middle + np.column_stack([(column + 0.5 * (row % 2)).ravel(), rise * row.ravel()])
    lattice = lattice[contains_xy(draft.polygon, lattice[:, 0], lattice[:, 1])]
    away = distance(draft.polygon.boundary, shapely_points(lattice))
    wanted = spacing(lattice)
    return lattice[(wanted > 0.9) & (away > 0.65 * wanted)]


def _gap_centers(draft: Draft, spacing: Spacing) -> Points:
    """Circle centers of triangles much larger than wanted, the largest first, none too near to another."""
    centers, radii = _circles(draft)
    wanted = spacing(centers)
    excess = radii / wanted
    order = np.argsort(-excess, kind="stable")
    order = order[excess[order] > 0.8]
    order = order[contains_xy(draft.polygon, centers[order, 0], centers[order, 1])]
    order = order[distance(draft.polygon.boundary, shapely_points(centers[order])) > 0.5 * wanted[order]]
    taken: list[int] = []
    for index in order:
        if not taken or np.linalg.norm(centers[taken] - centers[index], axis=1).min() > 0.8 * wanted[index]:
            taken.append(int(index))
    return centers[taken]


def _circles(draft: Draft) -> tuple[Points, np.ndarray]:
    """Center and radius of the circle through the corners of each triangle."""
    corners = draft.points[draft.triangles]
    b, c = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    scale = 0.5 / (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    bb, cc = np.einsum("ij,ij->i", b, b), np.einsum("ij,ij->i", c, c)
    offset = np.column_stack([c[:, 1] * bb - b[:, 1] * cc, b[:, 0] * cc - c[:, 0] * bb]) * scale[:, None]
    return corners[:, 0] + offset, np.linalg.norm(offset, axis=1)


def _mesh(draft: Draft, element_size: float) -> Mesh:
    """Finished mesh [m], nodes and elements numbered along the longer side of the body."""
    points, triangles = draft.points, draft.triangles
    used = np.unique(triangles)
    axis = int(np.ptp(points[:, 1]) > np.ptp(points[:, 0]))
    order = used[np.lexsort((points[used, 1 - axis], points[used, axis]))]
    number = np.full(len(points), -1)
    number[order] = np.arange(len(order))
    elements = number[triangles]
    first = np.argmin(elements, axis=1)
    elements = np.take_along_axis(elements, (first[:, None] + np.arange(3)) % 3, axis=1)
    return Mesh(points[order] * element_size, elements[np.lexsort(elements.T[::-1])])
