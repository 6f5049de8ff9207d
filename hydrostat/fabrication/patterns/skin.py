"""`Skin`: the seam of a flat body and the edge along which its cloth is cut; `Notch`: a mark by which panels meet."""

from collections.abc import Iterator
from dataclasses import dataclass
from string import ascii_uppercase

import shapely
from shapely import LinearRing, LineString, MultiLineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.robot import Body


@dataclass(frozen=True)
class Skin:
    """One panel of cloth, seen from the front."""

    seam: Polygon  # the body's own outline [mm], counter-clockwise, its holes clockwise
    cut: Polygon  # its parallel, one seam allowance out into the cloth [mm]
    slits: MultiLineString  # further cuts, in bays too narrow for two allowances [mm]
    problems: tuple[str, ...]  # why it cannot be cut and sewn as drawn, a line each
    notes: tuple[str, ...]  # information for sewing, one line each


def flat_skin(body: Body, options: PatternOptions) -> Skin:
    """The skin of a flat body (InputError: the body is not flat, or is in several pieces)."""
    return skin_of(orient(shapely.transform(silhouette(body), lambda points: 1e3 * points)), options)


def skin_of(seam: Polygon, options: PatternOptions) -> Skin:
    """The cloth round a seam line [mm], which runs counter-clockwise, its holes clockwise."""
    outside = _offset(Polygon(seam.exterior), options.seam_allowance, options)
    slits, problems = _slits(seam, outside, options)
    holes = []
    for index, ring in enumerate(seam.interiors):
        hole = _offset(Polygon(ring), -options.seam_allowance, options)
        if hole.is_empty:
            problems.append(
                f"hole {index + 1} of the outline, at {_at(Polygon(ring))}, is too narrow for a seam allowance "
                f"of {options.seam_allowance:g} mm. Choose a smaller allowance or a wider hole. "
                'For an eye, set inner = "drawn" in [body], or choose "Surface lines" in Start'
            )
        else:
            holes.append(hole.exterior)
    cut = Polygon(outside.exterior, holes)
    return Skin(seam, cut, slits, tuple(problems), _tight_bays(seam, cut, slits, options))


def silhouette(body: Body) -> Polygon:
    """The drawn outline [m], or the boundary of a mesh."""
    if body.mesh.dim != 2:
        raise InputError("a body in space has no flat pattern: draw one for a flat body, or cast this one in a mold")
    if body.outline is not None:
        return body.outline.polygon
    edges = [shapely.LineString(ends) for ends in body.mesh.nodes[body.mesh.boundary]]
    largest = max(
        _polygons(shapely.polygonize(edges)), key=lambda piece: Polygon(piece.exterior).area, default=Polygon()
    )
    if abs(largest.area - body.mesh.volumes.sum()) > 1e-6 * body.mesh.volumes.sum():
        raise InputError("the mesh is no single piece: a pattern needs one outline")
    return largest


def _offset(polygon: Polygon, distance: float, options: PatternOptions) -> Polygon:
    """The parallel of a polygon; the largest piece where it falls apart."""
    steps = 24  # straight pieces of a quarter turn: 0.004 mm from the arc of an 8 mm allowance
    grown = polygon.buffer(distance, quad_segs=steps, join_style=options.corner.value, mitre_limit=2.0)
    largest = max(_polygons(grown), key=lambda piece: piece.area, default=Polygon())
    tolerance = 0.01  # maximum deviation of a straightened offset line [mm], a tenth of a laser's kerf
    straight = largest.simplify(tolerance)
    return straight if isinstance(straight, Polygon) else largest


def _slits(seam: Polygon, outside: Polygon, options: PatternOptions) -> tuple[MultiLineString, list[str]]:
    """Cuts that open the bays whose mouth the allowance closes, and what is wrong with those that cannot be opened."""
    slits, problems = [], []
    for bay in outside.interiors:
        mouth = shapely.shortest_line(bay, outside.exterior)
        slits += [bay, mouth]
        room = seam.distance(mouth)
        if room < options.cloth:
            problems.append(
                f"the seam allowance of {options.seam_allowance:g} mm closes the bay at {_at(Polygon(bay))}, "
                f"and a slit into it would leave {room:.2f} mm of cloth at the seam, not {options.cloth:g} mm. "
                "Choose a smaller allowance or widen the bay"
            )
    return MultiLineString(slits), problems


def _tight_bays(seam: Polygon, cut: Polygon, slits: MultiLineString, options: PatternOptions) -> tuple[str, ...]:
    """Warn where two stretches of seam share one allowance, because they lie too close."""
    edges = shapely.union_all([cut.boundary, slits])
    shapely.prepare(edges)
    rings = (seam.exterior, *seam.interiors)
    corners = shapely.points([corner for ring in rings for corner in ring.coords])
    far = corners[~shapely.dwithin(edges, corners, 3 * options.seam_allowance)].tolist()
    bays = shapely.union_all([corner.buffer(options.seam_allowance) for corner in far])
    ends = [max(far, key=lambda corner: edges.distance(corner) * bay.covers(corner)) for bay in _polygons(bays)]
    if not ends:
        return ()
    bays_at = f"{'bay' if len(ends) == 1 else 'bays'} at {', '.join(_at(end) for end in ends)}"
    return (f"the seam allowance fills the narrow {bays_at}. Snip the cloth open there, down to the seam",)


def _polygons(geometry: BaseGeometry) -> list[Polygon]:
    """Its polygons, whatever else it holds."""
    pieces = getattr(geometry, "geoms", (geometry,))
    return [piece for piece in pieces if isinstance(piece, Polygon) and not piece.is_empty]


def _at(geometry: Polygon | shapely.Point) -> str:
    """Place of a geometry, in words."""
    place = geometry.representative_point()
    x, y = round(place.x, 1) + 0.0, round(place.y, 1) + 0.0
    return f"[{x:g}, {y:g}] mm"


@dataclass(frozen=True)
class Notch:
    """One stroke."""

    ring: int  # number of its seam: 0 for the outer one, then the holes in order
    along: float  # distance along that seam from its top, with the body on the left [mm]
    name: str  # a letter, the same on every panel; empty for the second stroke of the double notch
    stroke: LineString  # from the seam to the cut, seen from the front [mm]


def find_notches(skin: Skin) -> tuple[Notch, ...]:
    """Notches that meet when the panels lie on each other; none where the allowance is shared with another seam."""
    notches: list[Notch] = []
    allowance = skin.seam.boundary.distance(skin.cut.boundary)
    names = notch_letters()
    spacing = 80.0  # about how far apart notches are along the seam [mm]
    pair = 5.0  # distance of the two notches of the double notch [mm], which marks the top
    for ring, seam, cut in _allowances(skin):
        top = seam_top(seam)
        count = max(4, round(seam.length / spacing))
        for along in sorted([pair, *(seam.length * index / count for index in range(count))]):
            stroke = shapely.shortest_line(seam.interpolate((top + along) % seam.length), cut)
            if isinstance(stroke, LineString) and stroke.length < 1.5 * allowance and not stroke.intersects(skin.slits):
                notches.append(Notch(ring, along, "" if along == pair else next(names), stroke))
    return tuple(notches)


def seam_top(seam: LinearRing) -> float:
    """Distance of a seam's highest corner along it [mm]: the double notch, and the join of the side strip."""
    return seam.project(shapely.Point(max(seam.coords, key=lambda corner: corner[1])))


def notch_letters() -> Iterator[str]:
    """A, B, ... Z, AA, AB, ..."""
    yield from ascii_uppercase
    for first in notch_letters():
        yield from (first + second for second in ascii_uppercase)


def _allowances(skin: Skin) -> Iterator[tuple[int, LinearRing, LinearRing]]:
    """Each ring of the seam with its parallel in the cut."""
    if skin.seam.boundary.distance(skin.cut.boundary) < 1.0:
        return
    yield 0, skin.seam.exterior, skin.cut.exterior
    for cut in skin.cut.interiors:
        inner = shapely.Point(cut.coords[0])
        holes = list(enumerate(skin.seam.interiors, start=1))
        ring, seam = min(holes, key=lambda hole: Polygon(hole[1]).distance(inner))
        yield ring, seam, cut
