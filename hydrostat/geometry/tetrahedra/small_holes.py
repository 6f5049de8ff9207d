"""`fill_small_holes`: a closed surface without the holes that its elements are too large for."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Int, Points, Vector
from hydrostat.geometry.mesh import joined_groups
from hydrostat.geometry.surface import Solid, Surface

HOLE_SHARE = 1.0
"""Width below which a hole is filled, in element sizes: no place in it is then farther than half of one from a wall."""

_ASIDE = np.array([0.011, -0.007, -0.004]) + 1 / 3
"""Weights of the start of a ray in its triangle: from the center it would hit edges of regular surfaces."""

_Labels = Int[np.ndarray, " triangles"]


@dataclass(frozen=True, eq=False)
class SmallHoles:
    """Surface with its small holes filled."""

    surface: Surface  # closed, oriented outward
    places: Points  # middle of each filled hole [m]
    widths: Vector  # width of each filled hole [m]

    def __len__(self) -> int:
        return len(self.widths)

    def describe(self, element_size: float) -> str:
        """Note on the filled holes; empty without any."""
        if not len(self):
            return ""
        x, y, z = (f"{round(1e3 * value, 1) + 0.0:g}" for value in self.places[int(np.argmax(self.widths))])
        widest = f"{1e3 * self.widths.max():.2g} mm wide at ({x}, {y}, {z}) mm"
        which = f"1 hole {widest} is" if len(self) == 1 else f"{len(self)} holes up to {widest} are"
        size = f"{1e3 * element_size:.3g} mm"
        return f"{which} filled in the mesh: narrower than an element of {size}. Take smaller elements to keep holes"


def fill_small_holes(surface: Surface, width: float) -> SmallHoles:
    """Fill holes, dimples and voids that are narrower than a width [m] and whose openings are about as small.

    A wall is where a ray outward meets the surface again within the width. Patches of walls go, and their rims are
    closed, if each rim is no longer than that of a round hole of the width. So tunnels and screw holes are filled;
    slots, gaps between fingers and chambers with small openings stay. A patch between two bodies stays as well.
    """
    gaps = _outward_gaps(surface, width)
    patch = _join_walls(surface, gaps < width)
    patch = _keep_short_rims(surface, patch, 1.15 * np.pi * width)
    tries = 4  # patches that would leave a part of the body loose are put back, then those in mere creases
    for _ in range(tries):
        if patch.max(initial=-1) < 0:
            break
        closed, label, rims = _close_rims(surface, patch)
        keep, loose = _judge_parts(closed, label, width)
        back = rims[np.isin(label[len(label) - len(rims) :], loose)]
        if not len(back):
            closed = closed.part(keep[label])
            back = _find_shallow(surface, patch, closed, 0.1 * width)
            if not len(back):
                return _list_holes(surface, patch, gaps, closed)
        patch = np.where(np.isin(patch, back), -1, patch)
    return SmallHoles(surface, np.zeros((0, 3)), np.zeros(0))


def _find_shallow(surface: Surface, patch: _Labels, closed: Surface, depth: float) -> Int[np.ndarray, " patches"]:
    """Patches that lie within a depth [m] of the closed surface: creases, which no element sees."""
    chosen = np.flatnonzero(patch >= 0)
    middles = surface.vertices[surface.triangles[chosen]].mean(axis=1)
    deep = np.unique(patch[chosen][Solid(closed).gaps(middles) > depth])
    return np.setdiff1d(patch[chosen], deep)


def _list_holes(surface: Surface, patch: _Labels, gaps: Vector, closed: Surface) -> SmallHoles:
    corners = surface.vertices[surface.triangles]
    holes = [
        (corners[own].reshape(-1, 3), gaps[own]) for own in (patch == number for number in np.unique(patch[patch >= 0]))
    ]
    places = np.array([(own.min(axis=0) + own.max(axis=0)) / 2 for own, _ in holes])
    return SmallHoles(closed, places, np.array([float(wide.max()) for _, wide in holes]))


def _outward_gaps(surface: Surface, width: float) -> Vector:
    """Distance from each triangle outward to the surface again [m]; infinite where it is more than the width."""
    solid = Solid(surface)
    starts = np.einsum("c,tcd->td", _ASIDE, surface.vertices[surface.triangles])
    starts = starts + 1e-6 * width * solid.normals
    hits, gaps = solid.first_hits(starts, solid.normals, width)
    return np.where((hits >= 0) & (gaps < width) & (np.linalg.norm(solid.normals, axis=1) > 0.5), gaps, np.inf)


def _edge_keys(
    triangles: Int[np.ndarray, "triangles 3"],
) -> tuple[Int[np.ndarray, " edges"], Int[np.ndarray, " edges"]]:
    """Start and end of each side: those of all triangles from corner 0 to 1, then 1 to 2, then 2 to 0."""
    return triangles[:, [0, 1, 2]].T.ravel(), triangles[:, [1, 2, 0]].T.ravel()


def _opposite_sides(triangles: Int[np.ndarray, "triangles 3"]) -> Int[np.ndarray, "pairs 2"]:
    """Pairs of sides (number as in `_edge_keys`) that run along one edge in opposite ways."""
    starts, ends = _edge_keys(triangles)
    count = int(triangles.max()) + 1
    keys, turned = starts * count + ends, ends * count + starts
    order = np.argsort(keys, kind="stable")
    place = np.minimum(np.searchsorted(keys[order], turned), len(keys) - 1)
    found = keys[order][place] == turned
    return np.stack([np.flatnonzero(found), order[place[found]]], axis=1)


def _join_walls(surface: Surface, walls: Bool[np.ndarray, " triangles"]) -> _Labels:
    """Number of the patch of each wall, joined by edges that are no sharp ridges; -1 for other triangles."""
    pairs = _opposite_sides(surface.triangles) % len(surface.triangles)
    pairs = pairs[walls[pairs].all(axis=1)]
    normals, middles = Solid(surface).normals, surface.vertices[surface.triangles].mean(axis=1)
    one, two = pairs.T
    sharp = np.einsum("pd,pd->p", normals[one], normals[two]) < 0.75
    ridge = sharp & (np.einsum("pd,pd->p", middles[two] - middles[one], normals[one]) < 0.0)
    label = joined_groups(pairs[~ridge].T, len(surface.triangles))
    return np.where(walls, label, -1)


def _keep_short_rims(surface: Surface, patch: _Labels, longest: float) -> _Labels:
    """Patches all of whose rims are simple rings no longer than a length [m]; others become -1."""
    pairs = _opposite_sides(surface.triangles)
    owner = patch[pairs % len(surface.triangles)]
    rim = (owner[:, 0] != owner[:, 1]) & (owner[:, 1] >= 0)
    sides, owner = pairs[rim, 0], owner[rim, 1]
    starts, ends = (key[sides] for key in _edge_keys(surface.triangles))
    lengths = np.linalg.norm(surface.vertices[ends] - surface.vertices[starts], axis=1)
    size = len(surface.vertices)  # a vertex counts for each patch by itself
    _, corners = np.unique(np.stack([owner * size + starts, owner * size + ends]), return_inverse=True)
    starts, ends = corners.reshape(2, -1)
    count = int(corners.max(initial=-1)) + 1
    ring = joined_groups(np.stack([starts, ends]), count)[starts]
    simple = (np.bincount(starts, minlength=count) == 1) & (np.bincount(ends, minlength=count) == 1)
    bad = (np.bincount(ring, lengths, minlength=1)[ring] > longest) | ~simple[starts] | ~simple[ends]
    return np.where(np.isin(patch, owner[bad]), -1, patch)


def _close_rims(surface: Surface, patch: _Labels) -> tuple[Surface, _Labels, Int[np.ndarray, " caps"]]:
    """Surface without patches, a fan over each of their rims; the part of each triangle; the patch of each fan's."""
    pairs = _opposite_sides(surface.triangles)
    owner = patch[pairs % len(surface.triangles)]
    rim = (owner[:, 0] < 0) & (owner[:, 1] >= 0)
    starts, ends = (key[pairs[rim, 0]] for key in _edge_keys(surface.triangles))
    ring = np.unique(joined_groups(np.stack([starts, ends]), len(surface.vertices))[starts], return_inverse=True)[1]
    counts = np.bincount(ring, minlength=1)
    middles = np.stack([np.bincount(ring, axis, minlength=1) for axis in surface.vertices[starts].T], axis=1)
    caps = np.stack([ends, starts, len(surface.vertices) + ring], axis=1)
    triangles = np.concatenate([surface.triangles[patch < 0], caps])
    closed = Surface(np.concatenate([surface.vertices, middles / np.maximum(counts, 1)[:, None]]), triangles)
    pairs = _opposite_sides(triangles) % len(triangles)
    label = np.unique(joined_groups(pairs.T, len(triangles)), return_inverse=True)[1]
    return closed, label, owner[rim, 1]


def _judge_parts(
    closed: Surface, label: _Labels, width: float
) -> tuple[Bool[np.ndarray, " parts"], Int[np.ndarray, " loose"]]:
    """Parts that stay: the largest, and cavities; then those that would be loose, as large as a width cubed."""
    inside = closed.vertices[closed.triangles[:, 0]] - closed.box.mean(axis=0)
    volumes = np.bincount(label, np.einsum("td,td->t", inside, closed.crosses) / 6)
    keep = volumes < -(width**3)
    largest = int(np.argmax(volumes))
    keep[largest] = True
    loose = np.flatnonzero(volumes > width**3)
    return keep, loose[loose != largest]
