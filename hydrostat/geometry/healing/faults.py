"""Faults of a surface: where it runs through itself, and all that was found, in words."""

from collections.abc import Iterator

import numpy as np

from hydrostat.arrays import Bool, Float, Int
from hydrostat.errors import SurfaceError
from hydrostat.geometry.healing.healing import Piece
from hydrostat.geometry.healing.mend import Holes, Welded, sides_of
from hydrostat.geometry.healing.shells import Role, Shells
from hydrostat.geometry.surface import Surface
from hydrostat.units import plural

_BOXES = 4096  # and no more triangles, for the next may cross many more others
MAX_PAIRS = 100_000  # pairs that cross, after which the search ends

# a turn that no CAD model is aligned with: its walls are not seen from the side, where many boxes overlap
_TURN = np.linalg.qr(np.array([[0.61, 0.33, -0.72], [-0.47, 0.88, 0.05], [0.64, 0.31, 0.70]]))[0]

_Corners = Float[np.ndarray, "pairs 3 3"]


def crossing_pairs(surface: Surface) -> Int[np.ndarray, "pairs 2"]:
    """Pairs of triangles of which a side of one runs through the other, or that are folded flat on each other.

    Triangles that touch each other, or lie in one plane and overlap there without a common edge, do not count. Ends
    early where a surface is nothing but crossings. Raises SurfaceError: so much of it lies about itself, as shells
    within shells do, that the search would not end in time.
    """
    found, seen = [np.zeros((0, 2), dtype=np.int64)], 0
    # pairs whose boxes meet, in all, and for each triangle of a large surface
    most_seen, seen_each = 3_000_000, 60
    # of the size of the surface: what is nearer to a plane than this touches it, and does not cross it
    near = 1e-9
    for pairs in _candidates(surface):
        seen += len(pairs)
        if seen > max(most_seen, seen_each * len(surface.triangles)):
            raise SurfaceError(
                "most of its triangles lie about each other, as in shells within shells: this is no surface of a body; "
                "in the program it comes from, keep the outer one, and export it again"
            )
        first, second = (surface.triangles[side] for side in pairs.T)
        same = first[:, :, None] == second[:, None, :]
        shared = same.sum(axis=(1, 2))
        cross = np.zeros(len(pairs), dtype=bool)
        for count, test in ((0, _apart_cross), (1, _corner_cross), (2, _side_cross)):
            some = np.flatnonzero(shared == count)
            one = _roll_triangles(first[some], same[some].any(axis=2), count)
            two = _roll_triangles(second[some], same[some].any(axis=1), count)
            cross[some] = test(surface.vertices[one], surface.vertices[two], near * surface.size)
        found.append(pairs[cross])
        if sum(map(len, found)) >= MAX_PAIRS:
            break
    return np.concatenate(found)


def _roll_triangles(triangles: np.ndarray, shared: np.ndarray, count: int) -> np.ndarray:
    """Triangles turned so that one common corner comes first, or, of two, the corner that is not common."""
    if count == 0:
        return triangles
    start = np.argmax(shared, axis=1) if count == 1 else np.argmin(shared, axis=1)
    return np.take_along_axis(triangles, (start[:, None] + np.arange(3)) % 3, axis=1)


def _candidates(surface: Surface) -> Iterator[Int[np.ndarray, "pairs 2"]]:
    """Pairs of triangles whose boxes meet, each pair once."""
    import shapely

    corners = (surface.vertices @ _TURN)[surface.triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    tree = shapely.STRtree(boxes)
    start, chunk = 0, 16
    pairs = 1_000_000  # about as many are looked at at once
    while start < len(boxes):
        first, second = tree.query(boxes[start : start + chunk])
        first = first + start
        start += chunk
        chunk = int(np.clip(chunk * pairs / max(len(first), 1), 16, min(4 * chunk, _BOXES)))
        meets = (first < second) & (low[first, 2] <= high[second, 2]) & (low[second, 2] <= high[first, 2])
        yield np.stack([first[meets], second[meets]], axis=1).astype(np.int64)


def _apart_cross(one: _Corners, two: _Corners, near: float) -> Bool[np.ndarray, " pairs"]:
    """Mask of the pairs of triangles without a common corner that cross."""
    cross = np.zeros(len(one), dtype=bool)
    one_heights, two_heights = _heights(one, two), _heights(two, one)
    maybe = np.flatnonzero(_straddles(one_heights, near) & _straddles(two_heights, near))
    for corners, others, heights in ((one, two, one_heights), (two, one, two_heights)):
        for start in range(3):
            end = (start + 1) % 3
            ends = corners[maybe][:, [start, end]]
            cross[maybe] |= _runs_through(ends, heights[maybe][:, [start, end]], others[maybe], near)
    return cross


def _corner_cross(one: _Corners, two: _Corners, near: float) -> Bool[np.ndarray, " pairs"]:
    """Mask of the pairs of triangles with a common first corner that cross: the far side of one through the other."""
    cross = np.zeros(len(one), dtype=bool)
    for corners, others in ((one, two), (two, one)):
        heights = _heights(corners, others)[:, 1:]
        maybe = np.flatnonzero(_straddles(heights, near))
        cross[maybe] |= _runs_through(corners[maybe][:, 1:], heights[maybe], others[maybe], near)
    return cross


def _side_cross(one: _Corners, two: _Corners, near: float) -> Bool[np.ndarray, " pairs"]:
    """Mask of triangle pairs with a common side, opposite their first corners, that are folded flat on each other."""
    side = one[:, 2] - one[:, 1]
    heights = [np.cross(side, corners[:, 0] - one[:, 1]) for corners in (one, two)]
    with np.errstate(all="ignore"):
        lengths = np.linalg.norm(heights, axis=2)
        cosine = np.einsum("pd,pd->p", *heights) / lengths.prod(axis=0)
    tall = lengths.min(axis=0) > near * np.linalg.norm(side, axis=1)
    return tall & (cosine > 1.0 - 1e-12)


def _heights(corners: _Corners, others: _Corners) -> Float[np.ndarray, "pairs 3"]:
    """Heights [m] of corners above the planes of other triangles; 0 where such a one has no area."""
    normal = np.cross(others[:, 1] - others[:, 0], others[:, 2] - others[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(length > 0.0, length, np.inf)
    return np.einsum("pcd,pd->pc", corners - others[:, :1], normal)


def _straddles(heights: Float[np.ndarray, "pairs some"], near: float) -> Bool[np.ndarray, " pairs"]:
    """Mask of the triangles with corners both above and below."""
    return (heights.max(axis=1, initial=-np.inf) > near) & (heights.min(axis=1, initial=np.inf) < -near)


def _runs_through(
    ends: Float[np.ndarray, "pairs 2 3"], heights: Float[np.ndarray, "pairs 2"], corners: _Corners, near: float
) -> Bool[np.ndarray, " pairs"]:
    """Mask of the segments, with ends at these heights above a triangle's plane, that run through the triangle."""
    way = ends[:, 1] - ends[:, 0]
    ring = corners - ends[:, :1]
    turns = [np.einsum("pd,pd->p", way, np.cross(ring[:, k], ring[:, (k + 1) % 3])) for k in range(3)]
    within = (np.min(turns, axis=0) >= 0.0) | (np.max(turns, axis=0) <= 0.0)
    return within & _straddles(heights, near)


def pieces_of(shells: Shells) -> tuple[Piece, ...]:
    """Parts of a surface that are neither body nor cavity."""
    counts = np.bincount(shells.label)
    return tuple(
        Piece.of_box(shells.boxes[part], int(counts[part]), role.value)
        for part, role in enumerate(shells.roles)
        if role in (Role.WITHIN, Role.SPECK)
    )


def sliver_count(surface: Surface) -> int:
    """Number of triangles that are slivers."""
    corners = surface.vertices[surface.triangles]
    longest = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    sliver = 1e-3  # a triangle lower than this share of its longest side is a sliver
    return int((np.linalg.norm(surface.crosses, axis=1) < sliver * longest**2).sum())


def describe_faults(
    welded: Welded,
    surface: Surface,
    holes: Holes,
    flipped: int,
    crossing: Int[np.ndarray, "pairs 2"],
    shells: Shells,
    slivers: int,
) -> tuple[str, ...]:
    """Describe the faults found in a surface, a line each.

    The surface is turned one way already: `flipped` triangles looked another way than most of their patch; `crossing`
    are pairs of triangles.
    """
    sides = sides_of(surface.triangles)
    crowded, turned = int(sides.is_non_manifold.sum()), int(sides.is_misoriented.sum())
    longest = 1e3 * holes.length.max(initial=0.0)
    roles = shells.roles
    most = "at least " if len(crossing) >= MAX_PAIRS else ""
    lines = (
        (welded.merged, plural(welded.merged, "corner") + " in the place of another"),
        (welded.flat, plural(welded.flat, "triangle") + " without an area"),
        (welded.repeated, plural(welded.repeated, "triangle") + " that stand there twice"),
        (welded.walls, plural(welded.walls, "triangle") + " back to back in walls inside"),
        (len(holes), f"{plural(len(holes), 'hole')}, the longest {longest:.3g} mm around"),
        (crowded, plural(crowded, "edge") + " with more than two triangles"),
        (flipped, plural(flipped, "flipped triangle")),
        (turned, plural(turned, "edge") + " where inside and outside change sides"),
        (shells.inside_out.sum(), plural(int(shells.inside_out.sum()), "part") + " inside out"),
        (len(crossing), f"{most}{plural(len(crossing), 'pair')} of triangles that run through each other"),
        (len(roles) > 1, f"{len(roles)} parts that are not joined"),
        (roles.count(Role.CAVITY), plural(roles.count(Role.CAVITY), "pocket") + " of air inside, clean and thus kept"),
        (slivers, plural(slivers, "sliver")),
    )
    return tuple(text for count, text in lines if count)
