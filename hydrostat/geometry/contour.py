"""Closed surfaces of the region where a field is negative, by marching cubes with exact crossings."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Points, Vector
from hydrostat.errors import SurfaceError
from hydrostat.geometry.surface import Surface

MAX_GRID_POINTS = 4_000_000  # a grid with more points than this is refused

Field = Callable[[Points], Vector]
"""A number for each point, negative inside: a signed distance [m], or 0.5 minus a winding number."""

_CHUNK = 200_000  # points in one call of the field
_BLOCK = 8  # cells along the side of a block that is settled as a whole

Settled = Callable[[Points, Vector], Bool[np.ndarray, " points"]]
"""Return True if the field has one sign all within a reach [m] of each point."""


def contour(
    field: Field,
    box: Float[np.ndarray, "2 3"],
    spacing: float,
    *,
    distance: bool = False,
    settled: Settled | None = None,
    accuracy: float = 1e-5,
) -> Surface:
    """Closed surface of the region where a field is negative, outward oriented and manifold; the same on every run.

    Marching cubes tell which edges of a grid are crossed and how the crossings join (Lorensen & Cline 1987, with tables
    that leave no gaps); every crossing is then moved along its edge to where the field changes its sign, so that fields
    with a jump (winding numbers) are met as exactly as smooth ones. Between the crossings the surface is flat: edges
    and corners are cut by up to about half a spacing, and what is thinner than it may be missed.

    Args:
        field: called with many points at once, all within the box.
        box: lowest and highest coordinates [m]; the region ends at its sides.
        spacing: grid spacing [m].
        distance: the field changes by at most the way between two points (a signed distance), so what is far from
            its zero need not be computed; the result is the same, only sooner.
        settled: the same for other fields: whether the sign is the same all within a reach [m] of points.
        accuracy: accuracy of the crossings, as a share of the spacing.

    Raises:
        SurfaceError: the grid is too fine for the box, no grid point is inside, or the field is not finite.
    """
    grid = _Grid(np.asarray(box, dtype=float), spacing)
    if distance:
        settled = lambda points, reach: np.abs(field(points)) > reach  # noqa: E731
    inside = _inside_by_blocks(field, settled, grid) if settled else grid.inside(field, np.arange(grid.points))
    if not inside.any():
        raise SurfaceError(f"nothing is inside on a grid of {1e3 * spacing:.3g} mm: use a smaller spacing")
    low, high, triangles = _crossed_edges(inside, grid)
    share = _crossings(lambda points: grid.clip(field, points), grid.at(low), grid.at(high), inside[low], accuracy)
    vertices = grid.at(low) + share[:, None] * (grid.at(high) - grid.at(low))
    return Surface(vertices, triangles)


class _Grid:
    """Points at equal distances over a box and one layer beyond; numbered along x, then y, then z."""

    def __init__(self, box: Float[np.ndarray, "2 3"], spacing: float) -> None:
        extent = box[1] - box[0]
        if not (np.isfinite(box).all() and extent.min() > 0.0 and np.isfinite(spacing) and spacing > 0.0):
            raise SurfaceError("a contour needs a box with three sides above 0 and a spacing above 0")
        self.box, self.spacing = box, spacing
        shape = np.ceil(extent / spacing) + 3.0
        if shape.prod() > MAX_GRID_POINTS:
            raise SurfaceError(
                f"a grid of {1e3 * spacing:.3g} mm over {' x '.join(f'{1e3 * side:.4g}' for side in extent)} mm has "
                f"{shape.prod():.3g} points, at most {MAX_GRID_POINTS} are computed: use a larger spacing"
            )
        self.shape = shape.astype(np.int64)
        self.points = int(self.shape.prod())
        # of the spacing: faces that lie at multiples of it from the sides of the box meet no grid point
        offset = 0.37
        self.origin = box[0] - (1.0 + offset) * spacing

    def indices(self, numbers: Int[np.ndarray, " some"]) -> Int[np.ndarray, "some 3"]:
        """Places on the grid of some of its points."""
        return np.stack(np.unravel_index(numbers, tuple(self.shape), order="F"), axis=1)

    def at(self, numbers: Int[np.ndarray, " some"]) -> Points:
        """Positions [m] of some of its points."""
        return self.origin + self.spacing * self.indices(numbers)

    def clip(self, field: Field, points: Points) -> Vector:
        """Field at points [m] within the box, and 1 beyond it."""
        values = np.ones(len(points))
        within = np.flatnonzero(((points >= self.box[0]) & (points <= self.box[1])).all(axis=1))
        for start in range(0, len(within), _CHUNK):
            some = within[start : start + _CHUNK]
            values[some] = field(points[some])
        if not np.isfinite(values).all():
            raise SurfaceError("the field of a contour is not a finite number everywhere in its box")
        return values

    def inside(self, field: Field, numbers: Int[np.ndarray, " some"]) -> Bool[np.ndarray, " some"]:
        """Return True if some of its points are inside."""
        chunks = [numbers[start : start + _CHUNK] for start in range(0, len(numbers), _CHUNK)]
        return np.concatenate([self.clip(field, self.at(chunk)) < 0.0 for chunk in chunks] or [np.zeros(0, dtype=bool)])


def _inside_by_blocks(field: Field, settled: Settled, grid: _Grid) -> Bool[np.ndarray, " points"]:
    """Mask of the grid points inside, evaluated one by one only in blocks that their center does not decide."""
    corners = np.stack(np.meshgrid(*(np.arange(0, side, _BLOCK) for side in grid.shape), indexing="ij"), axis=-1)
    corners = corners.reshape(-1, 3)
    last = np.minimum(corners + _BLOCK, grid.shape) - 1
    lowest, highest = (grid.origin + grid.spacing * index for index in (corners, last))
    # a middle beyond the box is judged from the nearest point within it, which is as far as that from the rest
    middle = np.clip((lowest + highest) / 2, *grid.box)
    reach = np.linalg.norm(np.maximum(highest - middle, middle - lowest), axis=1)
    values, whole = grid.clip(field, middle), settled(middle, reach)
    inside = np.zeros(tuple(grid.shape), dtype=bool, order="F")
    near = np.zeros_like(inside, order="F")
    for (x, y, z), value, far in zip(corners, values, whole, strict=True):
        block = np.s_[x : x + _BLOCK, y : y + _BLOCK, z : z + _BLOCK]
        inside[block], near[block] = far and value < 0.0, not far
    # the layers beyond the box are outside whatever the middle of their block says
    numbers = np.flatnonzero(inside.ravel(order="F"))
    inside = inside.ravel(order="F")
    places = grid.at(numbers)
    inside[numbers] = ((places >= grid.box[0]) & (places <= grid.box[1])).all(axis=1)
    numbers = np.flatnonzero(near.ravel(order="F"))
    inside[numbers] = grid.inside(field, numbers)
    return inside


def _crossed_edges(
    inside: Bool[np.ndarray, " points"], grid: _Grid
) -> tuple[Int[np.ndarray, " vertices"], Int[np.ndarray, " vertices"], Int[np.ndarray, "triangles 3"]]:
    """Ends of every grid edge with a crossing, and their connections: marching cubes on -1 and 1, met mid-edge."""
    import igl

    places = grid.indices(np.arange(grid.points)).astype(float)
    x, y, z = (int(side) for side in grid.shape)
    middles, triangles, _ = igl.marching_cubes(np.where(inside, -1.0, 1.0), places, x, y, z, 0.0)
    low, high = (step(middles).astype(np.int64) @ np.array([1, x, x * y]) for step in (np.floor, np.ceil))
    return low, high, np.array(triangles).astype(np.int64)  # a long long, which is the same and yet another type


def _crossings(
    field: Field, start: Points, end: Points, start_inside: Bool[np.ndarray, " points"], accuracy: float
) -> Vector:
    """Find the sign change of the field from start to end, as a share of the distance.

    The false position and bisection take turns: the first is quick on smooth fields, the second cannot be slowed by
    a jump, at which both are bisections.
    """
    sign = np.where(start_inside, 1.0, -1.0)  # so that all go from negative to positive
    low, high = np.zeros(len(start)), np.ones(len(start))
    low_value, high_value = sign * field(start), sign * field(end)
    share = np.full(len(start), np.inf)
    active = np.arange(len(start))
    for turn in range(60):
        guess = low[active] + (high[active] - low[active]) * _zero(low_value[active], high_value[active])
        moved = np.abs(guess - share[active]) > accuracy
        share[active] = guess
        active, guess = active[moved], guess[moved]
        if not len(active):
            break
        if turn % 2:
            guess = (low[active] + high[active]) / 2
        values = sign[active] * field(start[active] + guess[:, None] * (end[active] - start[active]))
        below = values < 0.0
        low[active[below]], low_value[active[below]] = guess[below], values[below]
        high[active[~below]], high_value[active[~below]] = guess[~below], values[~below]
    # of the spacing: how near to a grid point a crossing may come, so that no triangle has zero area
    clearance = 1e-3
    return np.clip(share, clearance, 1.0 - clearance)


def _zero(low: Vector, high: Vector) -> Vector:
    """Zero of the line from a value at most 0 to one at least 0, as a share of the distance."""
    span = high - low
    return np.where(span > 0.0, -low / np.where(span > 0.0, span, 1.0), 0.5)
