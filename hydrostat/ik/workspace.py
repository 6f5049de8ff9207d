"""`find_workspaces`: all that each marker of a robot can be brought to by its winches, as a figure and as a cloud."""

from dataclasses import dataclass
from itertools import product

import numpy as np
import shapely

from hydrostat.arrays import Float, Points, Vector
from hydrostat.errors import InputError
from hydrostat.simulation import Simulation, without_contact_friction
from hydrostat.sobol import draw_sobol


def workspace_extent(moves: Float[np.ndarray, "rows winches"], spans: Vector, *, dim: int, floor: float) -> float:
    """Geometric mean over markers of the mean half-axis of the ellipsoid that a box of contractions brings each to [m].

    For each marker it is the 2 dim-th root of det(J S^2 J^T + floor^2 I), that is, up to a factor, the dim-th root of
    the ellipsoid's volume. So a marker that only goes to and fro along a line counts little, and one that nothing moves
    counts as `floor`.

    Args:
        moves: derivatives of the coordinates of the markers by the contractions, marker after marker.
        spans: admissible contraction change of each winch to either side [m].
        dim: coordinates of a marker.
        floor: extent that counts as no reach at all [m], above 0.
    """
    if not moves.size:
        return floor
    scaled = (moves * spans).reshape(-1, dim, moves.shape[1])
    squares = scaled @ scaled.transpose(0, 2, 1) + floor**2 * np.eye(dim)
    return float(np.exp(np.linalg.slogdet(squares)[1].mean() / (2 * dim)))


def usable_spans(
    pulls: Float[np.ndarray, "cables winches"], ranges: Vector, tension: float
) -> Float[np.ndarray, " winches"]:
    """Share of each winch's range that its hardest cable lets it go, to first order [m].

    Args:
        pulls: derivatives of the tensions by the contractions [N/m].
        ranges: travel and release of each winch [m].
        tension: maximum cable tension [N].
    """
    hardest = np.abs(pulls).max(axis=0, initial=0.0)
    return np.minimum(ranges, tension / np.maximum(hardest, 1e-12))


@dataclass(frozen=True, kw_only=True, eq=False)
class MarkerWorkspace:
    """Workspace of one marker.

    Attributes:
        marker: name of the marker.
        places: marker positions in the solved poses [m].
        cells: corners of a convex part of the workspace around each of these positions [m], (poses, corners, dim).
        directions: principal directions of the workspace, the widest first, a unit vector each.
        extents: extent of the workspace along each direction [m].
        size: area [m^2] of a flat body, volume [m^3] in space, of the union of all parts; 0 if the marker moves along a
            line only.
    """

    marker: str
    places: Points
    cells: Float[np.ndarray, "poses corners dim"]
    directions: Float[np.ndarray, "dim dim"]
    extents: Vector
    size: float

    def __str__(self) -> str:
        """Area or volume, the extents, and the direction of the longest."""
        dim, way = len(self.extents), self.directions[0]
        number = 100.0**dim * self.size
        size = f"{number:.0f}" if number >= 100 else f"{number:.2g}"
        extents = " × ".join(f"{1e3 * extent:.0f}" for extent in self.extents)
        along = f"at {np.degrees(np.arctan2(way[1], way[0])) % 180:.0f}°" if dim == 2 else _direction_text(way)
        return f"{size} {'cm²' if dim == 2 else 'cm³'}, {extents} mm, long axis {along}"


def _direction_text(way: Vector) -> str:
    """Components of a unit vector, such as "along (+0.00, -1.00, +0.00)"."""
    return f"along ({', '.join(f'{part:+.2f}' for part in way)})"


def find_workspaces(
    simulation: Simulation, *, tension: float | None = None, count: int = 64, threads: int = 2
) -> tuple[MarkerWorkspace, ...]:
    """Compute the workspace of each marker within travel and release of the winches and limits of the drives.

    Poses are solved at contractions spread evenly over what all winches can do, each from rest, so straight along the
    loading path where cables rub. Each stands for a share of the contractions; the Jacobian gives, to first order, what
    part that is of the places that a marker reaches, and the union of these parts is measured. With more than three
    winches the shares do not cover all contractions, and what is told is rather too little. Poses that are not stable
    or ask a cable for more than its limit are left out. So is friction of contact, which has no derivatives.

    Args:
        simulation: the robot's physics.
        tension: maximum cable tension [N]; None for no limit.
        count: approximate number of solved poses.
        threads: number of threads.

    Raises:
        InputError: a robot without markers, or without winches and drives; no number of poses, or other physics that
            remember the way.
    """
    robot = without_contact_friction(simulation.robot)
    if robot is not simulation.robot:
        simulation = Simulation(robot, options=simulation.options)
    if not robot.num_controls or not robot.markers:
        raise InputError("reach is that of markers by winches or drives; the robot needs at least one of each")
    if count < 1:
        raise InputError(f"count must be at least 1, not {count}")
    low, high = robot.control_limits
    shares, half = _tiles(len(low), count)
    found = simulation.solve_batch(low + shares * (high - low), threads=threads)
    derivatives = np.zeros((0, 0, 0, 0)) if found.jacobians is None else found.jacobians
    held = found.converged & found.stable & np.isfinite(derivatives).all(axis=(1, 2, 3))
    if tension is not None:
        held[held] &= found.tensions[held].max(axis=1, initial=0.0) <= tension
    taken, derivatives = found.contractions[held], derivatives[held]
    below = np.maximum(taken - half * (high - low), low) - taken
    above = np.minimum(taken + half * (high - low), high) - taken
    return tuple(
        _marker_workspace(marker.name, found.markers[held, own], derivatives[:, own], below, above)
        for own, marker in enumerate(robot.markers)
    )


def _tiles(winches: int, count: int) -> tuple[Float[np.ndarray, "poses winches"], float]:
    """Sample points in the ranges of all winches, and half the width of each point's tile, as shares of these."""
    tiled = 3  # the ranges of so many winches are tiled evenly; of more, places in them are drawn
    # then each stands for what is so near on either side, as a share of the range: rather too little
    near = 0.1
    if winches > tiled:
        return draw_sobol(winches, count, np.random.default_rng(SEED)), near
    steps = max(round(count ** (1.0 / winches)), 1)
    middles = (np.arange(steps) + 0.5) / steps
    return np.array(list(product(middles, repeat=winches))), 0.5 / steps


def _marker_workspace(
    name: str,
    places: Points,
    derivatives: Float[np.ndarray, "poses dim winches"],
    below: Float[np.ndarray, "poses winches"],
    above: Float[np.ndarray, "poses winches"],
) -> MarkerWorkspace:
    dim = places.shape[1]
    by = np.einsum("kd,pdw->pkw", _directions(dim), derivatives)
    changes = np.where(by > 0, above[:, None], below[:, None])  # what brings it farthest in each direction
    cells = places[:, None] + np.einsum("pdw,pkw->pkd", derivatives, changes)
    corners = cells.reshape(-1, dim)
    if not len(corners):
        return MarkerWorkspace(
            marker=name, places=places, cells=cells, directions=np.eye(dim), extents=np.zeros(dim), size=0.0
        )
    _, _, directions = np.linalg.svd(corners - corners.mean(axis=0), full_matrices=False)
    extents = np.ptp(corners @ directions.T, axis=0)
    order = np.argsort(-extents)
    size = _covered_area(cells) if dim == 2 else _covered_volume(cells)
    return MarkerWorkspace(
        marker=name, places=places, cells=cells, directions=directions[order], extents=extents[order], size=size
    )


def _directions(dim: int) -> Float[np.ndarray, "ways dim"]:
    """Directions all around."""
    around = 32  # directions in the plane, and half as many as in space
    if dim == 2:
        angles = 2 * np.pi * np.arange(around) / around
        return np.column_stack([np.cos(angles), np.sin(angles)])
    heights = (np.arange(2 * around) + 0.5) / around - 1.0
    angles, radii = np.pi * (1 + 5**0.5) * np.arange(2 * around), np.sqrt(1 - heights**2)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles), heights])


def _covered_area(cells: Float[np.ndarray, "poses corners dim"]) -> float:
    return float(shapely.union_all([shapely.convex_hull(shapely.MultiPoint(cell)) for cell in cells]).area)


def _covered_volume(cells: Float[np.ndarray, "poses corners dim"]) -> float:
    """Volume of the union of the hulls [m^3]: the share of random points that are in one of them."""
    from scipy.spatial import ConvexHull, QhullError  # Imported here: not every command needs it.

    corners = cells.reshape(-1, 3)
    low, span = corners.min(axis=0), np.ptp(corners, axis=0)
    points = low + np.random.default_rng(SEED).uniform(size=(_POINTS, 3)) * span
    inside = np.zeros(len(points), dtype=bool)
    for cell in cells:
        try:
            hull = ConvexHull(cell)
        except QhullError:  # flat: it has no volume
            continue
        left = np.flatnonzero(
            ~inside & (points >= cell.min(axis=0)).all(axis=1) & (points <= cell.max(axis=0)).all(axis=1)
        )
        sides = points[left] @ hull.equations[:, :3].T + hull.equations[:, 3]
        inside[left[(sides <= 0.0).all(axis=1)]] = True
    return float(inside.mean() * span.prod())


SEED = 8
_POINTS = 20_000  # by which a volume is measured: to some per cent
