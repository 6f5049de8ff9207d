"""The gusset: the strip of cloth between front and back that makes a flat plush robot as thick as it was simulated."""

import math
from itertools import pairwise

import shapely
from shapely import LineString, Polygon

from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patterns.labels import PanelLabels
from hydrostat.fabrication.patterns.shape import Layer, Panel, PatternPart, Shape, trace
from hydrostat.fabrication.patterns.skin import Notch, Skin


def stuffed_thickness(seam: Polygon) -> float:
    """Thickness of a limb of two flat panels when it is stuffed [mm].

    Stuffing makes a round tube of two flat strips of width w, and keeps its girth: 2 w = pi d. The mean width of a
    branched outline is w = 2 area / length of its seams, which is exact for a long strip and for a ring.
    """
    return 2 / math.pi * 2 * seam.area / seam.length


def wants_gusset(seam: Polygon, thickness: float, options: PatternOptions) -> bool:
    """Return True if a body so thick [mm] gets a gusset: by the options, else if panels alone stay thinner."""
    return thickness > stuffed_thickness(seam) if options.gusset is None else options.gusset


def gusset_panels(
    name: str, skin: Skin, notches: tuple[Notch, ...], thickness: float, options: PatternOptions
) -> tuple[Panel, ...]:
    """The strip of each seam, from its top round the body, in pieces with their own seam allowance.

    A piece lies right side up with its edge to the front panel above. From left to right it then follows the seam
    counter-clockwise as seen from the front (clockwise round a hole). Pieces are joined at a notch where there is one.
    """
    cuts = []
    for ring, seam in enumerate((skin.seam.exterior, *skin.seam.interiors)):
        own = [notch for notch in notches if notch.ring == ring]
        ends = _strip_ends(seam.length, [notch.along for notch in own if notch.name], options.gusset_piece)
        cuts += [(own, start, end, seam.length) for start, end in pairwise(ends)]
    return tuple(
        _piece(f"{name} - gusset {number} of {len(cuts)}", number, _StripPiece(*cut), thickness, options)
        for number, cut in enumerate(cuts, start=1)
    )


class _StripPiece:
    """A stretch of a seam, laid straight: its length, and the notches on it from its beginning."""

    def __init__(self, notches: list[Notch], start: float, end: float, seam: float) -> None:
        self.length = end - start
        round_trip = [(notch.along + turn, notch.name) for notch in notches for turn in (0.0, seam)]
        near = [(along - start, name) for along, name in round_trip if start - 1e-6 <= along <= end + 1e-6]
        self.notches = sorted((min(max(along, 0.0), self.length), name) for along, name in near)


def _strip_ends(length: float, notches: list[float], longest: float) -> list[float]:
    """Places where a strip is cut: at the last notch before it would become too long, else just there [mm]."""
    ends = [0.0]
    while length - ends[-1] > longest + 1e-9:
        here = ends[-1]
        ends.append(
            max((notch for notch in notches if here + longest / 2 < notch <= here + longest), default=here + longest)
        )
    return [*ends, length]


def _piece(title: str, number: int, stretch: _StripPiece, thickness: float, options: PatternOptions) -> Panel:
    length, allowance = stretch.length, options.seam_allowance
    seam = shapely.box(0.0, 0.0, length, thickness)
    cut = shapely.box(-allowance, -allowance, length + allowance, thickness + allowance)
    shapes: list[Shape] = [*trace(cut, Layer.CUT, PatternPart.EDGE), *trace(seam, Layer.MARK, PatternPart.SEAM)]
    strokes = []
    for along, name in stretch.notches:
        for low, high in ((thickness, thickness + allowance), (-allowance, 0.0)):
            strokes.append((name, LineString([(along, low), (along, high)])))
    for _, stroke in strokes if allowance else ():
        shapes += trace(stroke, Layer.MARK, PatternPart.NOTCH)
    labels = PanelLabels(seam, tuple(shapes), mirrored=False)
    labels.notch_names(strokes, cut)
    labels.edge_names("to the front", "to the back")
    labels.title(title)
    labels.grain()
    return Panel(name=f"gusset-{number}", origin=(0.0, 0.0), mirrored=False, shapes=(*shapes, *labels.shapes()))
