"""`Pattern`: the panels of a plush robot on one sheet, for a laser cutter (R10)."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import shapely
from shapely import LineString, Polygon

from hydrostat.errors import InputError
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patterns.labels import PanelLabels
from hydrostat.fabrication.patterns.marks import (
    cable_marks,
    crossed_drawings,
    decoration_marks,
    marker_marks,
    seam_marks,
    winch_marks,
)
from hydrostat.fabrication.patterns.opening import Opening, find_opening
from hydrostat.fabrication.patterns.pinholes import Pinhole, find_pinholes, pinhole_problems
from hydrostat.fabrication.patterns.shape import LaserLine, Layer, Panel, PatternPart, Place, Shape, trace
from hydrostat.fabrication.patterns.sheet_layout import lay_out
from hydrostat.fabrication.patterns.skin import Notch, Skin, find_notches, flat_skin
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, cable_stitches
from hydrostat.robot import CableSide, Robot, sewn_sides


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
    pieces = []
    for number, cut in enumerate(cuts, start=1):
        short = f"gusset {number} of {len(cuts)}"
        titles = f"{name} - {short}", short, f"gusset {number}"  # the first that has room is written
        pieces.append(_piece(titles, number, _StripPiece(*cut), thickness, options))
    return tuple(pieces)


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


def _piece(
    titles: tuple[str, ...], number: int, stretch: _StripPiece, thickness: float, options: PatternOptions
) -> Panel:
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
    labels.title(*titles)
    labels.grain()
    return Panel(name=f"gusset-{number}", origin=(0.0, 0.0), mirrored=False, shapes=(*shapes, *labels.shapes()))


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """A sheet of panels at true scale, its lower left corner at (0, 0)."""

    name: str  # name of the robot
    panels: tuple[Panel, ...]  # pieces of cloth: the front, the back, and the pieces of the gusset if there is one
    shapes: tuple[Shape, ...]  # shapes on the sheet next to the panels: the bar of 100 mm
    width: float  # width of the sheet [mm]
    height: float  # height of the sheet [mm]
    stitches: tuple[CableStitches, ...] = ()  # stitches of each cable, in cable order
    # the slit in the back, seen from the front, from the robot's origin; None if there is none
    opening: Opening | None = None
    problems: tuple[str, ...] = ()  # reasons why it cannot be cut well, one line each; only with `force`
    warnings: tuple[str, ...] = ()  # warnings, one line each
    notes: tuple[str, ...] = ()  # information for sewing, one line each

    def panel(self, name: str) -> Panel:
        """The panel of this name (InputError: there is none)."""
        for panel in self.panels:
            if panel.name == name:
                return panel
        names = ", ".join(panel.name for panel in self.panels)
        raise InputError(f'unknown panel "{name}". Available: {names}.')

    @property
    def gusset(self) -> tuple[Panel, ...]:
        """The pieces of the strip between front and back, in the order in which they are joined."""
        return tuple(panel for panel in self.panels if panel.name.startswith("gusset"))


@dataclass(frozen=True, kw_only=True)
class _PatternDraft:
    """Inputs from which the panels are drawn."""

    robot: Robot
    options: PatternOptions
    skin: Skin
    notches: tuple[Notch, ...]
    stitches: tuple[CableStitches, ...]
    opening: Opening | None

    def stitches_on(self, panel: str) -> tuple[CableStitches, ...]:
        """Stitches on one panel, of each cable of the robot or of none."""
        return tuple(stitches for stitches in self.stitches if stitches.panel == panel)

    def label_cables(self, labels: PanelLabels, panel: str) -> None:
        """Numbers of the cables that are sewn on a panel."""
        sewn = self.stitches_on(panel)
        if sewn:
            labels.cable_numbers(self.robot, first=sewn[0].cable)


def plush_pattern(robot: Robot, *, options: PatternOptions | None = None) -> Pattern:
    """Front and back of a flat plush robot, and a gusset for a thick one, to be sewn, turned and stuffed (R10).

    All panels show the right side of the cloth: the front as drawn, the back as seen from behind. Cables run along the
    panel that the robot says, or along both, stitched in and out of it at their points, so the pinholes are there. The
    zipper is in the back, beside them. Raises InputError: the body is not flat, or a hole or an edge cannot be cut as
    drawn, or cables in the middle (unless `force`).
    """
    options = options or PatternOptions()
    skin = flat_skin(robot.body, options)
    holes = find_pinholes(robot, skin.seam, options)
    problems = _problems(robot, skin, holes, options)
    if problems and not options.force:
        first, *others = problems
        raise InputError(f"{first} (and {len(others)} more such)" if others else first)
    sides = sewn_sides(robot)
    behind = options.back_pinholes or "back" in sides
    runs = [cable.points for cable in robot.cables] if "back" in sides else []
    draft = _PatternDraft(
        robot=robot,
        options=options,
        skin=skin,
        notches=find_notches(skin),
        stitches=cable_stitches(robot, skin.seam),
        opening=find_opening(robot, skin.seam, holes if behind else (), options, runs=runs),
    )
    edges = (*trace(skin.cut, Layer.CUT, PatternPart.EDGE), *trace(skin.slits, Layer.CUT, PatternPart.SLIT))
    cloth = (*edges, *seam_marks(skin, draft.notches), *winch_marks(robot, skin.seam))
    pinholes = tuple(hole.circle for hole in holes)
    markers = marker_marks(robot) if options.marker_names else ()
    marks = {side: cable_marks(robot, draft.stitches_on(side), skin.seam, holes) for side in sides}
    drawn = decoration_marks(robot, skin.seam, holes)
    front = (*cloth, *(pinholes if "front" in sides else ()), *marks.get("front", ()), *markers, *drawn)
    back = (*cloth, *(pinholes if behind else ()), *marks.get("back", ()))
    thickness = 1e3 * (robot.body.thickness or 0.0)
    wanted = wants_gusset(skin.seam, thickness, options)
    gusset = gusset_panels(robot.name, skin, draft.notches, thickness, options) if wanted else ()
    sheet = lay_out((_front(draft, front), _back(draft, back)), gusset, options.gap)
    return Pattern(
        name=robot.name,
        panels=sheet.panels,
        shapes=sheet.ruler,
        width=sheet.width,
        height=sheet.height,
        stitches=draft.stitches,
        opening=draft.opening,
        problems=problems,
        warnings=_warnings(draft, thickness, gusset=wanted),
        notes=(*skin.notes, *_notes(draft)),
    )


def pattern_problems(robot: Robot, options: PatternOptions) -> tuple[str, ...]:
    """Return the reasons why a flat body cannot be cut and sewn, one line each (InputError: it is not flat)."""
    skin = flat_skin(robot.body, options)
    return _problems(robot, skin, find_pinholes(robot, skin.seam, options), options)


def _problems(robot: Robot, skin: Skin, holes: tuple[Pinhole, ...], options: PatternOptions) -> tuple[str, ...]:
    return skin.problems + pinhole_problems(holes, skin.seam, options) + _unheld(robot)


def _front(draft: _PatternDraft, shapes: tuple[Shape, ...]) -> Panel:
    """The front panel about the robot's origin, with its labels."""
    labels = PanelLabels(draft.skin.seam, shapes, mirrored=False)
    labels.notch_names([(notch.name, notch.stroke) for notch in draft.notches], draft.skin.cut)
    draft.label_cables(labels, "front")
    labels.winch_names(draft.robot)
    labels.marker_names(draft.robot, draft.options)
    labels.hole_numbers(draft.stitches_on("front"))
    labels.title(f"{draft.robot.name} - front")
    labels.grain()
    return Panel(name="front", origin=(0.0, 0.0), mirrored=False, shapes=(*shapes, *labels.shapes()))


def _back(draft: _PatternDraft, shapes: tuple[Shape, ...]) -> Panel:
    """The back panel about the robot's origin, seen from behind, with its labels."""
    zipper = (draft.opening.mark, *draft.opening.placket) if draft.opening else ()
    mirror = tuple(shape.mirror() for shape in (*shapes, *zipper))
    labels = PanelLabels(draft.skin.seam, mirror, mirrored=True)
    labels.notch_names([(notch.name, notch.stroke) for notch in draft.notches], draft.skin.cut)
    if draft.opening:
        labels.opening(draft.opening)
    draft.label_cables(labels, "back")
    labels.winch_names(draft.robot)
    labels.hole_numbers(draft.stitches_on("back"))
    labels.title(f"{draft.robot.name} - back")
    labels.grain()
    return Panel(name="back", origin=(0.0, 0.0), mirrored=True, shapes=(*mirror, *labels.shapes()))


def _warnings(draft: _PatternDraft, thickness: float, *, gusset: bool) -> tuple[str, ...]:
    """Warn of the thickness, the opening, and cables in drawn shapes."""
    warnings = [
        *(draft.opening.warnings if draft.opening else ()),
        *crossed_drawings(draft.robot, draft.stitches_on("front")),
    ]
    stuffed = stuffed_thickness(draft.skin.seam)
    if not gusset and thickness > stuffed:
        warnings.append(
            f"without a gusset the stuffed body is about {stuffed:.0f} mm thick, but it was simulated with "
            f"{thickness:g} mm. It will be softer. Sew it with the gusset or simulate it thinner"
        )
    return tuple(warnings)


def _notes(draft: _PatternDraft) -> tuple[str, ...]:
    """Information on cables below the zipper and on stoppers inside."""
    inside = (
        f"the stopper of cable {sewn.cable} is inside the body. Adjust it through the opening"
        for sewn in draft.stitches
        if sewn.stopper is Side.INSIDE
    )
    return (*_over_zipper(draft), *inside)


def _unheld(robot: Robot) -> tuple[str, ...]:
    """Return a problem if cables would run without cloth to hold them."""
    if robot.face is not CableSide.MIDDLE or not robot.cables:
        return ()
    return (
        'cables in the middle are held by nothing in loose filling. Set face = "pairs", which is as flat, or cast it '
        "(--method foam)",
    )


def _over_zipper(draft: _PatternDraft) -> list[str]:
    """A sentence for all cables of the back that the zipper crosses."""
    if draft.opening is None:
        return []
    crossed = [
        f"C{sewn.cable}"
        for sewn in draft.stitches_on("back")
        if LineString([stitch.place for stitch in sewn.stitches]).intersects(draft.opening.slit)
    ]
    if not crossed:
        return []
    return [f"the zipper crosses {', '.join(crossed)} on the back. Route them inside there, under its tape"]


def cut_sheet(name: str, rings: Iterable[tuple[Place, ...]]) -> Pattern:
    """A plate with its holes [mm], above the bar of 100 mm."""
    lines = tuple(LaserLine(layer=Layer.CUT, part=PatternPart.EDGE, points=ring, closed=True) for ring in rings)
    gap = 10.0  # round the plate [mm]
    sheet = lay_out((Panel(name="plate", origin=(0.0, 0.0), mirrored=False, shapes=lines),), (), gap)
    ruler = tuple(line for line in sheet.ruler if line.part is PatternPart.RULER)
    return Pattern(name=name, panels=sheet.panels, shapes=ruler, width=sheet.width, height=sheet.height)
