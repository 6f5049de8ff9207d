"""`Shells`: connected parts of a surface, oriented outward, and the role of each in the body."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.geometry.healing.mend import Sides, sides_of
from hydrostat.geometry.surface import Surface

SMALL_PART_SHARE = 0.1  # a part whose box has a diagonal below this share of the body's is small


class Role(Enum):
    """Meaning of a part for the body; the value says it in a report."""

    BODY = "body"
    CAVITY = "cavity"
    WITHIN = "inside the body, where it changes nothing"
    SPECK = "loose speck"


@dataclass(frozen=True, eq=False)
class Shells:
    """Connected parts of a surface, joined by edges."""

    surface: Surface  # the surface, closed parts turned outward but for cavities
    label: Int[np.ndarray, " triangles"]  # number of the part of each triangle
    inside_out: Bool[np.ndarray, " parts"]  # parts that looked inward and were turned as a whole
    whole: Bool[np.ndarray, " parts"]  # parts that are closed, manifold and turned one way
    boxes: Float[np.ndarray, "parts 2 3"]  # lowest and highest coordinates of each [m]
    roles: tuple[Role, ...]  # what each is to the body

    def of_role(self, *roles: Role) -> Bool[np.ndarray, " parts"]:
        """Mask of the parts that have one of some roles, (parts,)."""
        return np.array([role in roles for role in self.roles])


def shells_of(
    surface: Surface, flipped: Bool[np.ndarray, " triangles"], crossing: Int[np.ndarray, "pairs 2"], near: float
) -> Shells:
    """Parts of a surface without repeated vertices, whose patches are each turned one way.

    Closed parts that lie in no other are turned outward. A closed part within others has a meaning only by what is on
    its two sides: it is a cavity if it looks inward where the others look outward and none of its triangles was
    flipped, to look as most of their patch; else it lies within the body, whose overlap is body all the same. Small
    parts that neither cross nor touch others are specks; open ones must be further from others than `near` [m].
    """
    triangles = surface.triangles
    sides = sides_of(triangles)
    label = sides.groups(sides.counts > 1)
    boxes = _boxes_of_parts(surface.vertices, triangles, label)
    whole = _whole_parts(sides, label)
    volume = _volumes(surface.vertices, sides, label)
    largest = int(np.argmax(np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1)))
    clash = label[crossing]
    meets = np.zeros(len(boxes), dtype=bool)
    meets[clash[clash[:, 0] != clash[:, 1]].ravel()] = True
    count = np.bincount(label, flipped, minlength=len(boxes))
    roles, turned = _closed_roles(surface, label, boxes, whole, meets, volume, count)
    if not whole[largest]:
        # of open parts only the largest is judged by its volume; those without one of their own follow it
        turned[~whole] = volume[largest] < 0.0
    triangles = np.where(turned[label][:, None], triangles[:, ::-1], triangles)
    turned_surface = Surface(surface.vertices, triangles)
    _find_specks(turned_surface, label, boxes, whole, meets, roles, largest, near)
    return Shells(turned_surface, label, turned, whole, boxes, tuple(roles))


def _boxes_of_parts(vertices: np.ndarray, triangles: np.ndarray, label: np.ndarray) -> Float[np.ndarray, "parts 2 3"]:
    """Lowest and highest coordinates of each part."""
    order = np.argsort(label, kind="stable")
    starts = np.flatnonzero(np.diff(label[order], prepend=-1))
    corners = vertices[triangles[order]]
    low = np.minimum.reduceat(corners.min(axis=1), starts)
    return np.stack([low, np.maximum.reduceat(corners.max(axis=1), starts)], axis=1)


def _whole_parts(sides: Sides, label: np.ndarray) -> Bool[np.ndarray, " parts"]:
    """Parts of which every edge has two triangles that run along it in opposite ways."""
    bad = ((sides.counts != 2) | sides.is_misoriented)[sides.of].any(axis=1)
    return np.bincount(label, bad) == 0


def _volumes(vertices: np.ndarray, sides: Sides, label: np.ndarray) -> Vector:
    """Volume of each part [m^3], its hole closed by a fan about the middle of its open edges."""
    rows, columns = np.nonzero(sides.open[sides.of])
    ends = vertices[sides.ends[sides.of[rows, columns]]].mean(axis=1)
    parts = label[rows]
    count = np.bincount(parts, minlength=label.max() + 1)
    middle = np.stack([np.bincount(parts, axis, minlength=len(count)) for axis in ends.T], axis=1)
    first = np.unique(label, return_index=True)[1]
    middle = np.where(count[:, None] > 0, middle / np.maximum(count, 1)[:, None], vertices[sides.triangles[first, 0]])
    corners = vertices[sides.triangles] - middle[label][:, None]
    return np.bincount(label, np.einsum("td,td->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)


def _closed_roles(
    surface: Surface,
    label: np.ndarray,
    boxes: np.ndarray,
    whole: np.ndarray,
    meets: np.ndarray,
    volume: Vector,
    flipped: Vector,
) -> tuple[list[Role], Bool[np.ndarray, " parts"]]:
    """Roles of closed parts, those that cross others being body, and which parts are to be turned."""
    sign = np.where(volume < 0.0, -1, 1)
    around = _containers_of(surface, label, boxes, whole, whole & ~meets)
    outer = np.array([whole[part] and not around[part] for part in range(len(boxes))])
    # a part within others is judged as it stands in the file, thus turned along with what is around it
    turned = outer & (sign < 0)
    roles = [Role.BODY] * len(boxes)
    for part in np.flatnonzero([bool(containers) for containers in around]):
        root = next((container for container in around[part] if outer[container]), around[part][0])
        turned[part] = turned[root]
    sign = np.where(turned, -sign, sign)
    for part in np.flatnonzero([bool(containers) for containers in around]):
        if sign[part] < 0 and flipped[part]:
            turned[part] ^= True
            sign[part] = 1
        outside = int(sum(sign[container] for container in around[part]))
        if outside >= 1 and outside + sign[part] < 1:
            roles[part] = Role.CAVITY
        elif (outside >= 1) == (outside + sign[part] >= 1):
            roles[part] = Role.WITHIN
    return roles, turned


def _containers_of(
    surface: Surface, label: np.ndarray, boxes: np.ndarray, whole: np.ndarray, judged: np.ndarray
) -> list[list[int]]:
    """Find for each part that is judged the closed ones that it lies in."""
    import igl

    found: list[list[int]] = [[] for _ in boxes]
    diagonal = np.where(whole, np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1), -1.0)
    first = surface.vertices[surface.triangles[np.unique(label, return_index=True)[1], 0]]
    most_containers = 100
    for container in np.argsort(-diagonal, kind="stable")[: min(most_containers, int(whole.sum()))]:
        low, high = boxes[container]
        maybe = np.flatnonzero(judged & (boxes[:, 0] > low).all(axis=1) & (boxes[:, 1] < high).all(axis=1))
        if len(maybe):
            triangles = surface.triangles[label == container]
            winding = igl.fast_winding_number(surface.vertices, triangles, np.ascontiguousarray(first[maybe]))
            for part in maybe[np.abs(winding) > 0.5]:
                found[part].append(int(container))
    return found


def _find_specks(
    surface: Surface,
    label: np.ndarray,
    boxes: np.ndarray,
    whole: np.ndarray,
    meets: np.ndarray,
    roles: list[Role],
    largest: int,
    near: float,
) -> None:
    """Mark small loose parts; open ones only where they are no patch of the body, as a crack would leave it."""
    import igl

    diagonal = np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1)
    body = np.array([role is Role.BODY for role in roles])
    small = body & ~meets & (diagonal < SMALL_PART_SHARE * diagonal[largest])
    rest = surface.triangles[~small[label]]
    numbers = np.flatnonzero(small[label])
    if not len(numbers):
        return
    points, parts = surface.vertices[surface.triangles[numbers]].reshape(-1, 3), np.repeat(label[numbers], 3)
    distance = np.sqrt(igl.point_mesh_squared_distance(points, surface.vertices, rest)[0])
    apart = np.full(len(boxes), np.inf)
    np.minimum.at(apart, parts, distance)
    winding = igl.fast_winding_number(surface.vertices, rest, points)
    inside = np.zeros(len(boxes))
    np.maximum.at(inside, parts, winding)
    for part in np.flatnonzero(small & (whole | (apart > near))):
        roles[part] = Role.WITHIN if inside[part] > 0.5 else Role.SPECK
