"""Spacing of nodes, and the rings of an outline divided by it into the edges of a mesh."""

from bisect import bisect
from dataclasses import dataclass

import numpy as np
from shapely import Polygon, STRtree, contains_xy, linestrings

from hydrostat.arrays import Float, Points, Vector
from hydrostat.errors import OutlineError
from hydrostat.geometry.outline import Curve, Outline, Stations
from hydrostat.geometry.triangles.draft import Division, Draft

_BEND = 0.7  # a chord of length s leaves a circle of radius r by s^2 / 8r: less than 0.09


@dataclass(frozen=True, eq=False)
class Spacing:
    """Wanted distance of nodes at any point, in units of the element size; 1 away from fine regions."""

    places: Float[np.ndarray, "places 2"]  # positions with a finer spacing
    values: Float[np.ndarray, " places"]  # spacing at these positions

    def __call__(self, points: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, " points"]:
        """Wanted distance of neighbors at some points."""
        fine = np.flatnonzero(self.values < 0.999)
        wanted = np.ones(len(points))
        growth = 0.3  # how much the spacing may grow for each unit of distance
        for part in np.array_split(np.arange(len(points)), 1 + len(points) * len(fine) // 2_000_000):
            if fine.size and part.size:
                along, up = (points[part, axis, None] - self.places[fine, axis] for axis in (0, 1))
                reach = np.sqrt(along * along + up * up)
                wanted[part] = np.minimum(1.0, (self.values[fine] + growth * reach).min(axis=1))
        return wanted


@dataclass(frozen=True, eq=False)
class CurveSamples:
    """Rings of an outline, finely and evenly sampled, in units of the element size."""

    places: Float[np.ndarray, "samples 2"]  # (samples, 2)
    inward: Float[np.ndarray, "samples 2"]  # unit normals into the body, (samples, 2)
    rings: Float[np.ndarray, " samples"]  # ring of each sample
    stations: Float[np.ndarray, " samples"]  # arc length of each sample on its ring
    bends: Float[np.ndarray, " samples"]  # spacing that the bend of the ring allows


def sample_rings(curves: tuple[Curve, ...], corners: tuple[Stations, ...]) -> CurveSamples:
    """Sample rings; `corners` are the stations of the true corners, whose bend does not count."""
    parts = []
    step = 1 / 12
    bend_reach = 1 / 6
    least_bend = 0.35
    for ring, (curve, sharp) in enumerate(zip(curves, corners, strict=True)):
        count = max(16, int(np.ceil(curve.length / step)))
        stations = np.arange(count) * (curve.length / count)
        tangents = curve.tangents(stations, min(step, curve.length / 16))
        reach = min(bend_reach, curve.length / 12)
        bend = np.abs(curve.turning_angles(stations, reach)) / (2 * reach)
        if sharp.size:
            gaps = np.abs(stations[:, None] - sharp)
            bend[np.minimum(gaps, curve.length - gaps).min(axis=1) <= 1.2 * reach] = 0.0
        bends = np.clip(np.sqrt(_BEND / np.maximum(bend, 1e-9)), least_bend, 1.0)
        inward = np.column_stack([-tangents[:, 1], tangents[:, 0]])
        parts.append((curve.at(stations), inward, np.full(count, float(ring)), stations, bends))
    return CurveSamples(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def widths_at(samples: CurveSamples, curves: tuple[Curve, ...], polygon: Polygon) -> tuple[Vector, Vector]:
    """Width of the body at each sample, at most 1, and the same without pointed tips.

    Two samples span a width if they face each other through the body and the way between them along the outline is
    long compared with it, which it is not across a tip or a corner.
    """
    from scipy.spatial import KDTree  # Imported here: not every command needs it.

    width, neck = np.ones(len(samples.places)), np.ones(len(samples.places))
    tree = KDTree(samples.places)
    most_pairs = 20_000_000  # places of an outline that are within an element of each other
    if tree.count_neighbors(tree, 1.0) > most_pairs:
        raise OutlineError(
            "the outline comes near to itself in too many places: draw it simpler, or take smaller elements"
        )
    pairs = tree.query_pairs(1.0, output_type="ndarray")
    first, second = pairs[:, 0], pairs[:, 1]
    across = samples.places[second] - samples.places[first]
    distance = np.linalg.norm(across, axis=1)
    facing = np.einsum("ij,ij->i", across, samples.inward[first]) > 0.7 * distance
    facing &= np.einsum("ij,ij->i", across, samples.inward[second]) < -0.7 * distance
    first, second, distance = first[facing], second[facing], distance[facing]
    middle = 0.5 * (samples.places[first] + samples.places[second])
    inside = contains_xy(polygon, middle[:, 0], middle[:, 1])
    first, second, distance = first[inside], second[inside], distance[inside]
    lengths = np.array([curve.length for curve in curves])[samples.rings[first].astype(int)]
    way = np.abs(samples.stations[first] - samples.stations[second])
    way = np.where(samples.rings[first] == samples.rings[second], np.minimum(way, lengths - way), np.inf)
    for least, result in ((np.maximum(4.0 * distance, 1.0), width), (2.0, neck)):
        real = way > least
        np.minimum.at(result, first[real], distance[real])
        np.minimum.at(result, second[real], distance[real])
    return width, neck


FLOOR = 1 / 6  # spacing never goes below this part of the element size on account of a thin feature

_CORNER_ANGLE = np.radians(33)


def divide(outline: Outline, element_size: float) -> Draft:
    """Place nodes on the rings of an outline: corners kept, closer together at bends and at thin places.

    Returns a draft without points inside, in units of `element_size`. Raises OutlineError where a place is too thin for
    it.
    """
    curves = tuple(Curve(ring / element_size) for ring in outline.rings)
    _refuse_long(outline, sum(curve.length for curve in curves), element_size)
    corners = tuple(_corners(curve) for curve in curves)
    samples = sample_rings(curves, corners)
    scaled = Outline(curves[0].corners, tuple(curve.corners for curve in curves[1:]))
    width, neck = widths_at(samples, curves, scaled.polygon)
    _refuse_thin(samples.places, neck, element_size)
    known = Spacing(samples.places, np.minimum(np.minimum(width, samples.bends), 1.0).clip(FLOOR))
    wanted = known(samples.places)
    divisions = []
    for ring, (curve, sharp) in enumerate(zip(curves, corners, strict=True)):
        here = samples.rings == ring
        divisions.append(_divide_ring(curve, sharp, samples.stations[here], wanted[here]))
    return _split_where_crossing(tuple(_split_where_far(division) for division in divisions))


def _refuse_thin(places: Points, neck: Vector, element_size: float) -> None:
    """Raise an error that says where the body is too thin, if it is."""
    worst = int(np.argmin(neck))
    if neck[worst] < FLOOR:
        x, y = 1e3 * element_size * places[worst]
        width = 1e3 * element_size * neck[worst]
        raise OutlineError(
            f"the outline is only {width:.2g} mm wide near ({x:.4g}, {y:.4g}) mm, too thin for elements of "
            f"{1e3 * element_size:.4g} mm: thicken it, or take elements of {width / FLOOR:.2g} mm or less"
        )


def _refuse_long(outline: Outline, rim: float, element_size: float) -> None:
    """Reject shapes with a rim too long in elements, before long work."""
    width = 2 * outline.area / (rim * element_size)
    if width < FLOOR * element_size:
        raise OutlineError(
            f"the outline is only {1e3 * width:.2g} mm wide on average, too thin for elements of "
            f"{1e3 * element_size:.4g} mm: thicken it, or take elements of {1e3 * width / FLOOR:.2g} mm or less"
        )
    most_rim = 50_000  # elements along the outline
    if rim > most_rim:
        raise OutlineError(
            f"the outline is {rim * element_size:.3g} m long, {rim:.3g} elements of {1e3 * element_size:.4g} mm, "
            f"at most {most_rim} are made: draw it with fewer teeth, or take larger elements"
        )


def _corners(curve: Curve) -> Stations:
    """Stations of the true corners: where a ring turns much on a short way, and little just before and after."""
    corner_reach = 1 / 12
    reach = min(corner_reach, curve.length / 24)
    stations = curve.stations[:-1]
    sharp = np.abs(curve.turning_angles(stations, reach))
    around = np.abs(curve.turning_angles(stations, 2 * reach))
    likely = np.flatnonzero((sharp > _CORNER_ANGLE) & (sharp > 0.75 * around))
    found: list[float] = []
    for index in likely[np.argsort(-np.abs(curve.turning[likely]) - sharp[likely], kind="stable")]:
        place = float(stations[index])
        after = bisect(found, place)
        gaps = [abs(found[other % len(found)] - place) for other in (after - 1, after)] if found else []
        if all(min(gap, curve.length - gap) > 2 * reach for gap in gaps):
            found.insert(after, place)
    return np.array(found)


def _divide_ring(curve: Curve, sharp: Stations, stations: Vector, wanted: Vector) -> Division:
    """Space nodes evenly between corners, measured in wanted spacings."""
    turns = np.concatenate([stations + turn * curve.length for turn in (0, 1, 2)])
    density = 1.0 / np.tile(wanted, 3)
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(turns))])
    begins = sharp if sharp.size else stations[:1]
    least = {0: 6, 1: 3, 2: 2}.get(sharp.size, 1)
    nodes, fixed = [], []
    for begin, end in zip(begins, np.append(begins[1:], begins[0] + curve.length), strict=True):
        low, high = np.interp([begin, end], turns, count)
        pieces = max(least, int(np.ceil(high - low - 0.4)))
        nodes.append(np.interp(np.linspace(low, high, pieces + 1)[:-1], count, turns))
        nodes[-1][0] = begin
        fixed.append(np.arange(pieces) == (0 if sharp.size else -1))
    places = np.mod(np.concatenate(nodes), curve.length)
    order = np.argsort(places, kind="stable")
    return Division(curve, places[order], np.concatenate(fixed)[order])


def _split_where_far(division: Division) -> Division:
    """Split edges that stray from the ring."""
    sagitta = 0.12  # an edge stays this near to the outline, in element sizes
    while True:
        far = np.flatnonzero(division.sagitta() > sagitta)
        if not far.size:
            return division
        for edge in far[::-1]:
            division = division.split(int(edge))


def _split_where_crossing(divisions: tuple[Division, ...]) -> Draft:
    """Split edges that cross each other."""
    draft = Draft(divisions, np.zeros((0, 2)))
    for _ in range(20):
        if draft.polygon.is_valid:
            return draft
        lines = np.asarray(linestrings(draft.points[draft.edges]))
        first, second = STRtree(lines).query(lines, predicate="intersects")
        neighbors = (draft.edges[first][:, :, None] == draft.edges[second][:, None, :]).any(axis=(1, 2))
        for edge in np.unique(first[~neighbors])[::-1]:
            ring, number = draft.place(int(edge))
            draft = draft.with_division(ring, draft.divisions[ring].split(number))
    raise OutlineError("the outline comes too near to itself for this element size: take smaller elements")
