"""`best_chord`, `cut_chord`: a patch that distorts too much is cut along a line that is straight on the cloth."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry
from shapely.ops import split

from hydrostat.arrays import Bool, Float, Int
from hydrostat.fabrication.patches.flatten import distortion
from hydrostat.fabrication.patches.patch import Disc, Patch
from hydrostat.fabrication.patches.skin_mesh import SkinMesh, cut_at_zero
from hydrostat.fabrication.solids.printed import number_groups

_SHIFTS = (0.0, -0.06, 0.06)  # offsets beside the worst place that are tried, as shares of the root of the patch's area


@dataclass(frozen=True, kw_only=True)
class Chord:
    """A straight cut through a flat patch."""

    through: tuple[float, float]  # a place on it [mm]
    along: tuple[float, float]  # its unit direction
    low: float  # distance along the direction from that place to where it enters the patch [mm]
    high: float  # distance to where it leaves it [mm]

    def heights(self, places: Float[np.ndarray, "places 2"]) -> Float[np.ndarray, " places"]:
        """Signed distance of places from its line [mm]."""
        return (places - self.through) @ np.array([-self.along[1], self.along[0]])

    def crosses(self, ends: Float[np.ndarray, "edges 2 2"]) -> Bool[np.ndarray, " edges"]:
        """Return True for each edge that it crosses."""
        one, other = self.heights(ends[:, 0]), self.heights(ends[:, 1])
        over = one * other <= 0
        share = np.abs(one) / np.maximum(np.abs(one) + np.abs(other), 1e-300)
        at = (ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0]) - self.through) @ np.array(self.along)
        return over & (at > self.low - 1e-6) & (at < self.high + 1e-6)


MIN_NECK = 8.0  # A neck of a patch narrower than that [mm] cannot be sewn and turned. Assumed.


def is_narrow(outline: BaseGeometry) -> bool:
    """Return True if an outline [mm] has such a neck, or is no wider anywhere."""
    inner = outline.buffer(-MIN_NECK / 2)
    return inner.is_empty or isinstance(inner, shapely.MultiPolygon)


def best_chord(patch: Patch, limit: float) -> Chord | None:
    """Choose the chord near the worst place after which the patch should lie flattest; None if there is none.

    Where there are chords that leave no piece too narrow to be sewn, one of them.

    Judged by the scale with which the pieces would flatten if angles were kept: the solution of a Poisson equation with
    the curvature of the skin, zero along rim and chord (Ben-Chen, Gotsman, Bunin 2008), without flattening them all.
    """
    middle, size = _worst_place(patch, limit), float(np.sqrt(patch.disc.areas.sum()))
    outline, judge = patch.outline.buffer(0), _Judge(patch.disc)

    length = 0.25  # Penalty of a chord as long as the root of the patch's area: a shorter seam is less work

    def best(angles: Iterable[float], shifts: Iterable[float]) -> tuple[bool, float, float, float, Chord] | None:
        found = []
        for angle in angles:
            along = np.array([np.cos(angle), np.sin(angle)])
            for shift in shifts:
                chord = _chord(outline, middle + shift * size * np.array([-along[1], along[0]]), along)
                if chord is not None:
                    score = judge.score(patch, chord) * (1 + length * (chord.high - chord.low) / size)
                    narrow = any(is_narrow(piece) for piece in _pieces(outline, chord))
                    found.append((narrow, round(score, 9), angle, shift, chord))
        return min(found, key=lambda one: one[:4], default=None)

    directions = 12
    rough = best((np.pi / directions * np.arange(directions)).tolist(), _SHIFTS)
    if rough is None:
        return None
    narrow, _, angle, shift, chord = rough
    step = np.pi / directions / 3
    finer = (-0.03, -0.015, 0.0, 0.015, 0.03)  # offsets beside the best of those that are tried then
    fine = best((angle - step, angle, angle + step), [shift + part for part in finer])
    return fine[-1] if fine and fine[0] <= narrow else chord


def cut_chord(mesh: SkinMesh, patch: Patch, number: int, chord: Chord) -> SkinMesh:
    """The mesh with its patch of this number cut; the lesser piece gets the next free number."""
    field = np.zeros(len(mesh.vertices))
    field[patch.disc.of] = chord.heights(patch.flat)
    target = _in_space(patch, chord)
    cut, _, side = cut_at_zero(mesh, field, mesh.patch == number)
    pieces = cut.pieces(4 * cut.patch + side)
    sides = cut.neighbors
    inner = (cut.patch[sides] == number).all(axis=1)
    border = inner & (pieces[sides[:, 0]] != pieces[sides[:, 1]])
    middles = cut.vertices[cut.edges[0]].mean(axis=1)
    nearest = int(np.where(border, np.linalg.norm(middles - target, axis=1), np.inf).argmin())
    one, other = sorted(pieces[sides[nearest]].tolist())
    links = np.sort(pieces[sides[border]], axis=1)
    links = links[(links != [one, other]).any(axis=1)]
    group = number_groups(links, int(pieces.max()) + 1)
    halves = [(cut.patch == number) & (group[pieces] == group[piece]) for piece in (one, other)]
    lesser = min(halves, key=lambda half: cut.areas[half].sum())
    return cut.relabel_patches(np.where(lesser, int(cut.patch.max()) + 1, cut.patch))


def _worst_place(patch: Patch, limit: float) -> Float[np.ndarray, " 2"]:
    """The middle of the largest part of a patch that gives too much, on the patch [mm]."""
    bent, triangles = distortion(patch), patch.disc.triangles
    excess = np.maximum(bent.gives - limit, 0) * bent.areas
    label = (excess > 0).astype(np.int64)
    groups = _groups(triangles, label)
    worst = int(np.bincount(groups, excess).argmax())
    weights = np.where(groups == worst, excess, 0.0)
    centers = patch.flat[triangles].mean(axis=1)
    mean = np.average(centers, axis=0, weights=weights)
    there = np.where(weights > 0, np.linalg.norm(centers - mean, axis=1), np.inf)
    return centers[int(there.argmin())]


def _groups(triangles: Int[np.ndarray, "triangles 3"], label: Int[np.ndarray, " triangles"]) -> Int[np.ndarray, " _"]:
    """Number connected groups of triangles of one label."""
    ends = np.sort(triangles[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    shared = (ends[order[:-1]] == ends[order[1:]]).all(axis=1)
    links = np.column_stack([order[:-1][shared], order[1:][shared]]) // 3
    return number_groups(links[label[links[:, 0]] == label[links[:, 1]]], len(triangles))


def _chord(outline: BaseGeometry, through: np.ndarray, along: np.ndarray) -> Chord | None:
    """The chord of an outline through a place."""
    far = 4 * np.hypot(*np.ptp(np.array(outline.bounds).reshape(2, 2), axis=0))
    line = shapely.LineString([through - far * along, through + far * along])
    parts = [part for part in shapely.get_parts(outline.intersection(line)).tolist() if part.length > 0]
    part = next((part for part in parts if part.distance(shapely.Point(through)) < 1e-6), None)
    if part is None:
        return None
    low, high = sorted(((np.array(part.coords)[[0, -1]] - through) @ along).tolist())
    place, direction = through.tolist(), along.tolist()
    chord = Chord(through=(place[0], place[1]), along=(direction[0], direction[1]), low=low, high=high)
    pieces = _pieces(outline, chord)
    least = 0.03  # a piece of less than this share of the patch is not worth cutting off
    return None if len(pieces) < 2 or min(piece.area for piece in pieces) < least * outline.area else chord


def _pieces(outline: BaseGeometry, chord: Chord) -> list[BaseGeometry]:
    """Return the pieces into which a chord cuts an outline."""
    through, along = np.array(chord.through), np.array(chord.along)
    ends = shapely.LineString([through + chord.low * along, through + chord.high * along])
    return shapely.get_parts(split(outline, _longer(ends))).tolist()


def _longer(line: shapely.LineString) -> shapely.LineString:
    """A line a little longer at both ends, so that it does cut."""
    (a, b), (c, d) = line.coords[0], line.coords[-1]
    dx, dy = 1e-6 * (c - a), 1e-6 * (d - b)
    return shapely.LineString([(a - dx, b - dy), (c + dx, d + dy)])


def _in_space(patch: Patch, chord: Chord) -> Float[np.ndarray, " 3"]:
    """Place of the middle of a chord on the body: in the triangle whose middle is nearest."""
    at = np.array(chord.through) + np.array(chord.along) * (chord.low + chord.high) / 2
    nearest = int(np.linalg.norm(patch.flat[patch.disc.triangles].mean(axis=1) - at, axis=1).argmin())
    return patch.disc.vertices[patch.disc.triangles[nearest]].mean(axis=0)


class _Judge:
    """Solves for the scale of a disc with more or less of it cut."""

    def __init__(self, disc: Disc) -> None:
        import igl
        from scipy.sparse import csc_array  # Imported here: not every command needs it.

        self._stiffness = csc_array(-igl.intrinsic_delaunay_cotmatrix(disc.vertices, disc.triangles)[0])
        self._curvature = np.array(igl.gaussian_curvature(disc.vertices, disc.triangles))
        self._areas = np.bincount(disc.triangles.ravel(), np.repeat(disc.areas / 3, 3), len(disc.vertices))
        self._rim = np.zeros(len(disc.vertices), dtype=bool)
        self._rim[disc.rim] = True
        self._edges = np.unique(np.sort(disc.triangles[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2), axis=1), axis=0)

    def score(self, patch: Patch, chord: Chord) -> float:
        """Mean square of the logarithm of the scale."""
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        fixed = self._rim.copy()
        fixed[self._edges[chord.crosses(patch.flat[self._edges])]] = True
        free = np.flatnonzero(~fixed)
        scale = splu(csc_array(self._stiffness[free][:, free])).solve(self._curvature[free])
        return float(scale**2 @ self._areas[free] / self._areas.sum())
