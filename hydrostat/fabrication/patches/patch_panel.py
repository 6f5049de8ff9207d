"""`PatchPanel`: a patch as a piece of cloth: cut, seam, notches, holes and what is written on it."""

import math
from collections.abc import Iterable
from itertools import pairwise

import shapely
from shapely import LineString, Polygon
from shapely.geometry.polygon import orient

from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.patch import Patch
from hydrostat.fabrication.patches.seams import PatchNotch
from hydrostat.fabrication.patches.skin_holes import SHARED, SkinHole
from hydrostat.fabrication.patterns.labels import PanelLabels
from hydrostat.fabrication.patterns.marks import dashed
from hydrostat.fabrication.patterns.opening import Opening
from hydrostat.fabrication.patterns.shape import Circle, LaserLine, Layer, Panel, PatternPart, Place, Shape, trace
from hydrostat.fabrication.patterns.skin import Skin, skin_of
from hydrostat.fabrication.patterns.stitches import Side

_CLEAR = 0.8
_CROSS = 2.0


def patch_skin(patch: Patch, options: PatternOptions) -> Skin:
    """Seam line and cut of a patch."""
    return skin_of(orient(patch.outline), options)


def patch_panel(
    name: str,
    title: str,
    skin: Skin,
    notches: Iterable[PatchNotch],
    cables: Iterable[tuple[int, tuple[tuple[SkinHole, Place], ...]]],
    opening: Opening | None,
    options: PatternOptions,
) -> Panel:
    """The panel of a patch; of each cable its number, and its holes on this patch in stitch order, with places [mm]."""
    strokes = [(notch.name, _stroke(notch.place, skin)) for notch in notches]
    cables = tuple(cables)
    shapes: list[Shape] = [
        *trace(skin.cut, Layer.CUT, PatternPart.EDGE),
        *trace(skin.slits, Layer.CUT, PatternPart.SLIT),
        *trace(skin.seam, Layer.MARK, PatternPart.SEAM),
        *(line for _, stroke in strokes for line in trace(stroke, Layer.MARK, PatternPart.NOTCH)),
        *((opening.mark, *opening.placket) if opening else ()),
    ]
    holes = [pair for _, own in cables for pair in own]
    for index, (hole, place) in enumerate(holes):
        if all(math.dist(place, other) > SHARED for _, other in holes[:index]):
            shapes += _hole(hole, place, options)
    for _, own in cables:
        shapes += _cable_lines(own, skin.seam, options)
    labels = PanelLabels(skin.seam, tuple(shapes), mirrored=False)
    labels.notch_names(strokes, skin.cut)
    if opening:
        labels.opening(opening)
    for cable, own in cables:
        if own:
            labels.cable_name(cable, own[-1][1])
    for hole, place in holes:
        labels.figure(f"{hole.point}", place)
    words = (title, name.replace("-", " "), f"{name[0]}{name.partition('-')[2]}")
    labels.title(next((text for text in words if labels.has_room(text)), words[-1]))
    labels.grain()
    return Panel(name=name, origin=(0.0, 0.0), mirrored=False, shapes=(*shapes, *labels.shapes()))


def _stroke(place: Place, skin: Skin) -> LineString:
    """Stroke from the seam across the allowance."""
    return shapely.shortest_line(shapely.Point(place), skin.cut.exterior)


def _hole(hole: SkinHole, place: Place, options: PatternOptions) -> tuple[Shape, ...]:
    """A pinhole, or a cross on the seam line where the cable passes between two stitches."""
    x, y = place
    if not hole.in_seam:
        return (Circle(layer=Layer.PINHOLE, part=PatternPart.PINHOLE, centre=place, radius=options.pinhole / 2),)
    return tuple(
        LaserLine(layer=Layer.MARK, part=PatternPart.MARKER, points=((x - dx, y - dy), (x + dx, y + dy)))
        for dx, dy in ((_CROSS, _CROSS), (_CROSS, -_CROSS))
    )


def _cable_lines(own: tuple[tuple[SkinHole, Place], ...], seam: Polygon, options: PatternOptions) -> tuple[Shape, ...]:
    """The cable between neighbouring holes on this patch: solid outside, dashed inside."""
    shapes: list[Shape] = []
    clear = options.pinhole / 2 + _CLEAR
    for (hole, place), (following, there) in pairwise(own):
        if following.point != hole.point + 1 or (hole.in_seam and following.in_seam):
            continue  # from seam to seam it runs along the seam
        ends = shapely.union_all([shapely.Point(end).buffer(clear) for end in (place, there)])
        drawn = LineString([place, there]).intersection(seam).difference(ends)
        drawn = shapely.MultiLineString([part for part in shapely.get_parts(drawn).tolist() if part.length])
        if hole.after is Side.INSIDE:
            drawn = dashed(drawn)
        shapes += trace(drawn, Layer.MARK, PatternPart.CABLE)
    return tuple(shapes)
