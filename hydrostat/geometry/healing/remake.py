"""A body remade as the region whose winding number is above one half, and its deviation from the input."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.errors import SurfaceError
from hydrostat.geometry.contour import MAX_GRID_POINTS, contour
from hydrostat.geometry.healing.faults import Piece
from hydrostat.geometry.healing.mend import members_of, sides_of
from hydrostat.geometry.surface import Solid, Surface, spread_points


@dataclass(frozen=True, eq=False)
class Remade:
    """Body remade from its winding number."""

    surface: Surface  # closed, manifold, outward
    spacing: float  # grid spacing [m]
    removed: tuple[Piece, ...]  # removed parts outside the body
    done: tuple[str, ...]  # notes on other repairs


def remake(surface: Surface, cavities: Float[np.ndarray, "cavities 2 3"], resolution: float) -> Remade:
    """Remake the body as the region around which the oriented triangles wind by more than one half.

    Cavities that stay are given by their boxes [m]; other pockets of air are filled. The resolution is the spacing of
    the grid [m], coarser where it would have too many points. Raises SurfaceError if there is no such region, or
    several bodies.
    """
    field = WindingField(surface)
    spacing = _allowed_spacing(surface, resolution)
    box = surface.box + 2.0 * spacing * np.array([[-1.0], [1.0]])
    accuracy = 1e-3  # of the spacing: how near crossings are to where they should be
    try:
        made = contour(field, box, spacing, settled=field.find_settled_points, accuracy=accuracy)
    except SurfaceError as error:
        raise SurfaceError(
            f"the surface encloses nothing that a grid of {1e3 * spacing:.3g} mm finds: it is an open sheet or thinner "
            "than that; close it where it comes from, or use smaller elements"
        ) from error
    return _one_body(made, cavities, spacing)


class WindingField:
    """One half minus the winding number, and a radius around each point within which its sign cannot change."""

    def __init__(self, surface: Surface) -> None:
        self.solid = Solid(surface)
        sides = sides_of(surface.triangles)
        rim = sides.turns != 0
        self.rim = sides.ends[rim]
        ends = surface.vertices[self.rim]
        self.length = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) @ np.abs(sides.turns[rim]))

    def __call__(self, points: Points) -> Vector:
        """One half minus the winding number."""
        return 0.5 - self.solid.winding(points)

    def find_settled_points(self, points: Points, reach: Vector) -> Bool[np.ndarray, " points"]:
        """Mask of the points around which the sign is constant within a reach [m]: no triangle, and no rim nearby.

        Away from the triangles the winding number has the gradient of the magnetic potential of a current along
        their open edges, by the law of Biot and Savart at most (length of the edges) / (4 pi distance^2).
        """
        import igl

        free = self.solid.gaps(points) > reach
        if not len(self.rim):
            return free
        squares = igl.point_mesh_squared_distance(points, self.solid.surface.vertices, self.rim)[0]
        rim = np.sqrt(np.array(squares)) - reach
        change = reach * self.length / (4.0 * np.pi * np.maximum(rim, 1e-12) ** 2)
        sum_error = 0.05  # how wrong the fast sum may be, amply
        return free & (rim > 0.0) & (np.abs(self(points)) > change + sum_error)


def _allowed_spacing(surface: Surface, resolution: float) -> float:
    """Resolution, or the smallest larger spacing whose grid does not have too many points."""
    extent = np.ptp(surface.box, axis=0)
    spacing = resolution
    while (np.ceil(extent / spacing) + 8.0).prod() > MAX_GRID_POINTS:
        spacing *= 1.05
    return float(spacing)


def _one_body(made: Surface, cavities: Float[np.ndarray, "cavities 2 3"], spacing: float) -> Remade:
    """Largest part of a contour with its cavities; small parts are removed, pockets of air filled."""
    sides = sides_of(made.triangles)
    label = sides.groups(sides.counts > 1)
    inside = made.vertices[made.triangles[:, 0]] - made.box.mean(axis=0)
    volumes = np.bincount(label, np.einsum("td,td->t", inside, made.crosses) / 6)
    numbers = members_of(label)
    body = int(np.argmax(volumes))
    keep, removed, filled = np.zeros(len(volumes), dtype=bool), [], []
    keep[body] = True
    # a part with less than this share of the body's volume is removed; one with more is a body of its own
    small = 0.01
    for part in np.flatnonzero(~keep).tolist():
        piece = made.part(numbers[part])
        if volumes[part] > small * volumes[body]:
            raise SurfaceError(_describe_second_body(made.part(numbers[body]), piece))
        if volumes[part] > 0.0:
            removed.append(Piece.of_box(piece.box, len(piece.triangles), "loose speck"))
        elif (np.abs(cavities - piece.box).max(axis=(1, 2)) < 2.0 * spacing).any():
            keep[part] = True
        else:
            filled.append(Piece.of_box(piece.box, len(piece.triangles), "a pocket of air filled"))
    surface = made.part(np.flatnonzero(keep[label]))
    return Remade(surface, spacing, tuple(removed), tuple(piece.text for piece in filled))


def _describe_second_body(body: Surface, other: Surface) -> str:
    """Describe a second body, and the positions of both."""
    places = [", ".join(f"{round(1e3 * x, 2) + 0.0:g}" for x in surface.box.mean(axis=0)) for surface in (body, other)]
    return (
        f"the surface is at least two bodies apart from each other, {1e3 * body.size:.3g} mm in size at "
        f"({places[0]}) mm and {1e3 * other.size:.3g} mm at ({places[1]}) mm: join them where the surface comes from, "
        "or keep one"
    )


@dataclass(frozen=True, eq=False)
class Deviation:
    """Distances between two surfaces."""

    # between what the surfaces have in common, from each to the other [m]; not of what is patched or lost, nor where
    # the first lies inside the second
    largest: float
    patched: float  # share of the second surface's area that is far from the first, as over its holes
    lost: Int[np.ndarray, " lost"]  # triangles of the first of which most lies outside the second and far from it


def deviation(before: Surface, after: Surface, near: float) -> Deviation:
    """Measure the distance of a closed surface from its source; beyond `near` [m] a part is patched, lost or inside."""
    import igl

    squared, nearest, _ = igl.point_mesh_squared_distance(after.vertices, before.vertices, before.triangles)
    distance = np.sqrt(np.array(squared))
    areas = np.linalg.norm(after.crosses, axis=1)
    patched = float(areas[(distance > near)[after.triangles].all(axis=1)].sum() / areas.sum())
    distance[(distance > near) | _at_rim(before)[np.array(nearest)]] = 0.0
    points, owner = spread_points(before, near)  # all over long triangles, not at their corners only
    back = np.sqrt(np.array(igl.point_mesh_squared_distance(points, after.vertices, after.triangles)[0]))
    some = np.flatnonzero(back > 0.05 * near)
    winding = np.array(igl.fast_winding_number(after.vertices, after.triangles, points[some]))
    back[some[winding >= 0.5]] = 0.0
    far = back > near
    count = len(before.triangles)
    lost = 2 * np.bincount(owner[far], minlength=count) > np.bincount(owner, minlength=count)
    back[far & lost[owner]] = 0.0
    return Deviation(float(max(distance.max(), back.max())), patched, np.flatnonzero(lost))


def _at_rim(surface: Surface) -> Bool[np.ndarray, " triangles"]:
    """Triangles with a corner at an open edge: points nearest to them may lie over a hole."""
    sides = sides_of(surface.triangles)
    rim = np.zeros(len(surface.vertices), dtype=bool)
    rim[sides.ends[sides.open]] = True
    return np.asarray(rim[surface.triangles].any(axis=1))
