"""Divide the rings of an outline into the edges of a mesh."""

import numpy as np
from shapely import STRtree, linestrings

from hydrostat.arrays import Points, Vector
from hydrostat.errors import OutlineError
from hydrostat.geometry.curve import Curve, Stations
from hydrostat.geometry.outline import Outline
from hydrostat.geometry.triangles.draft import Division, Draft
from hydrostat.geometry.triangles.spacing import Spacing, sample, widths

SAGITTA = 0.12
"""An edge stays this near to the outline, in element sizes."""

FLOOR = 1 / 6
"""Spacing never goes below this part of the element size on account of a thin feature."""

_CORNER_REACH = 1 / 12
_CORNER_ANGLE = np.radians(33)


def divide(outline: Outline, element_size: float) -> Draft:
    """Place nodes on the rings of an outline: corners kept, closer together at bends and at thin places.

    Returns:
        A draft without points inside, in units of `element_size`.

    Raises:
        OutlineError: some place is too thin for this element size.
    """
    curves = tuple(Curve(ring / element_size) for ring in outline.rings)
    corners = tuple(_corners(curve) for curve in curves)
    samples = sample(curves, corners)
    scaled = Outline(curves[0].corners, tuple(curve.corners for curve in curves[1:]))
    width, neck = widths(samples, curves, scaled.polygon)
    _refuse_thin(samples.places, neck, element_size)
    known = Spacing(samples.places, np.minimum(np.minimum(width, samples.bends), 1.0).clip(FLOOR))
    wanted = known(samples.places)
    divisions = []
    for ring, (curve, sharp) in enumerate(zip(curves, corners, strict=True)):
        here = samples.rings == ring
        divisions.append(_divide_ring(curve, sharp, samples.stations[here], wanted[here]))
    return _simple(tuple(_near(division) for division in divisions))


def _refuse_thin(places: Points, neck: Vector, element_size: float) -> None:
    """Say where the body is too thin, if it is."""
    worst = int(np.argmin(neck))
    if neck[worst] < FLOOR:
        x, y = 1e3 * element_size * places[worst]
        width = 1e3 * element_size * neck[worst]
        raise OutlineError(
            f"the outline is only {width:.2g} mm wide near ({x:.4g}, {y:.4g}) mm, too thin for elements of "
            f"{1e3 * element_size:.4g} mm: thicken it, or take elements of {width / FLOOR:.2g} mm or less"
        )


def _corners(curve: Curve) -> Stations:
    """Stations of the true corners: where a ring turns much on a short way, and little just before and after."""
    reach = min(_CORNER_REACH, curve.length / 24)
    stations = curve.stations[:-1]
    sharp = np.abs(curve.turned(stations, reach))
    around = np.abs(curve.turned(stations, 2 * reach))
    likely = np.flatnonzero((sharp > _CORNER_ANGLE) & (sharp > 0.75 * around))
    found: list[float] = []
    for index in likely[np.argsort(-np.abs(curve.turning[likely]) - sharp[likely], kind="stable")]:
        gaps = np.abs(np.array(found) - stations[index])
        if not found or np.minimum(gaps, curve.length - gaps).min() > 2 * reach:
            found.append(float(stations[index]))
    return np.sort(np.array(found))


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


def _near(division: Division) -> Division:
    """Split edges that stray from the ring."""
    while True:
        far = np.flatnonzero(division.sagitta() > SAGITTA)
        if not far.size:
            return division
        for edge in far[::-1]:
            division = division.split(int(edge))


def _simple(divisions: tuple[Division, ...]) -> Draft:
    """Split edges that cross each other."""
    draft = Draft(divisions, np.zeros((0, 2)))
    for _ in range(20):
        if draft.polygon.is_valid:
            return draft
        lines = np.asarray(linestrings(draft.points[draft.edges]))
        first, second = STRtree(lines).query(lines, predicate="intersects")
        neighbours = (draft.edges[first][:, :, None] == draft.edges[second][:, None, :]).any(axis=(1, 2))
        for edge in np.unique(first[~neighbours])[::-1]:
            ring, number = draft.place(int(edge))
            draft = draft.with_division(ring, draft.divisions[ring].split(number))
    raise OutlineError("the outline comes too near to itself for this element size: take smaller elements")
