"""`Pattern`: the panels of a plush robot on one sheet, for a laser cutter (R10)."""

from dataclasses import dataclass

import numpy as np
import shapely

from hydrostat.errors import InputError
from hydrostat.fabrication.patterns.labels import PanelLabels
from hydrostat.fabrication.patterns.lettering import Lettering
from hydrostat.fabrication.patterns.marks import cable_marks, marker_marks, opening_mark, seam_marks, winch_marks
from hydrostat.fabrication.patterns.pattern_options import PatternOptions
from hydrostat.fabrication.patterns.pinholes import find_pinholes, pinhole_problems
from hydrostat.fabrication.patterns.shape import Layer, Line, Part, Place, Shape, trace
from hydrostat.fabrication.patterns.skin import Skin, flat_skin
from hydrostat.robot import Point, Robot

_RULER = 100.0
"""Length of the bar that shows whether the sheet was cut at its true scale [mm]."""

_RULER_HEIGHT = 12.0
"""Room for the bar and its text below the panels [mm]."""


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One piece of cloth, its right side up.

    Attributes:
        name: "front" or "back".
        origin: where the robot's [0, 0] lies on the sheet [mm].
        mirrored: whether the robot's x runs to the left, as seen from behind.
        shapes: in places of the sheet [mm].
    """

    name: str
    origin: Place
    mirrored: bool
    shapes: tuple[Shape, ...]

    def on_sheet(self, point: Point) -> Place:
        """Where a point of the robot [m] lies on the sheet [mm]."""
        x, y = 1e3 * point[0], 1e3 * point[1]
        return self.origin[0] + (-x if self.mirrored else x), self.origin[1] + y


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """A sheet of panels at true scale, its lower left corner at (0, 0).

    Attributes:
        name: of the robot.
        panels: pieces of cloth.
        shapes: what lies on the sheet beside the panels: the bar of 100 mm.
        width: of the sheet [mm].
        height: of the sheet [mm].
        warnings: what to mind, a line each; with `force` also what cannot be cut honestly.
    """

    name: str
    panels: tuple[Panel, ...]
    shapes: tuple[Shape, ...]
    width: float
    height: float
    warnings: tuple[str, ...] = ()

    def panel(self, name: str) -> Panel:
        """The panel of this name.

        Raises:
            InputError: there is none.
        """
        for panel in self.panels:
            if panel.name == name:
                return panel
        names = ", ".join(panel.name for panel in self.panels)
        raise InputError(f'there is no panel "{name}"; its panels are: {names}')


def plush_pattern(robot: Robot, *, options: PatternOptions | None = None) -> Pattern:
    """Front and back of a flat plush robot, to be sewn, turned inside out and stuffed (R10).

    Both panels show the right side of the cloth: the front as drawn, the back as seen from behind. Cables run along the
    front panel, stitched in and out of it at their points, so the pinholes are there. The zipper is in the back.

    Raises:
        InputError: the body is not flat, or a hole or an edge cannot be cut as drawn (unless `force`).
    """
    options = options or PatternOptions()
    skin = flat_skin(robot.body, options)
    holes = find_pinholes(robot, skin.seam, options)
    problems = skin.problems + pinhole_problems(holes, skin.seam, options)
    if problems and not options.force:
        first, *others = problems
        raise InputError(f"{first} (and {len(others)} more such)" if others else first)
    edges = (*trace(skin.cut, Layer.CUT, Part.EDGE), *trace(skin.slits, Layer.CUT, Part.SLIT))
    cloth = (*edges, *seam_marks(skin), *winch_marks(robot, skin.seam))
    pinholes = tuple(hole.circle for hole in holes)
    markers = marker_marks(robot) if options.marker_names else ()
    front = (*cloth, *pinholes, *cable_marks(robot, skin.seam, holes), *markers)
    back = (*cloth, *(pinholes if options.back_pinholes else ()))
    drafts = (_front(robot, skin, front, options), _back(robot, skin, back, options))
    return _sheet(robot.name, drafts, options, (*problems, *skin.warnings))


def _front(robot: Robot, skin: Skin, shapes: tuple[Shape, ...], options: PatternOptions) -> Panel:
    """The front panel about the robot's origin, with its labels."""
    labels = PanelLabels(skin.seam, shapes, mirrored=False)
    labels.cable_numbers(robot)
    labels.winch_names(robot)
    labels.marker_names(robot, options)
    labels.title(f"{robot.name} - front")
    labels.grain()
    return Panel(name="front", origin=(0.0, 0.0), mirrored=False, shapes=(*shapes, *labels.shapes()))


def _back(robot: Robot, skin: Skin, shapes: tuple[Shape, ...], options: PatternOptions) -> Panel:
    """The back panel about the robot's origin, seen from behind, with its labels."""
    opening = opening_mark(robot, skin.seam, options.opening_reach)
    mirror = tuple(shape.mirrored() for shape in (*shapes, *((opening,) if opening else ())))
    labels = PanelLabels(skin.seam, mirror, mirrored=True)
    if opening:
        labels.opening(opening)
    labels.winch_names(robot)
    labels.title(f"{robot.name} - back")
    labels.grain()
    return Panel(name="back", origin=(0.0, 0.0), mirrored=True, shapes=(*mirror, *labels.shapes()))


def _sheet(name: str, drafts: tuple[Panel, ...], options: PatternOptions, warnings: tuple[str, ...]) -> Pattern:
    """Panels side by side from the left, the bar of 100 mm below them."""
    floor = options.gap + _RULER_HEIGHT
    left, height, panels = options.gap, 0.0, []
    for draft in drafts:
        low_x, low_y, high_x, high_y = shapely.total_bounds(np.array([shape.geometry for shape in draft.shapes]))
        dx, dy = left - float(low_x), floor - float(low_y)
        shapes = tuple(shape.moved(dx, dy) for shape in draft.shapes)
        panels.append(Panel(name=draft.name, origin=(dx, dy), mirrored=draft.mirrored, shapes=shapes))
        left += float(high_x - low_x) + options.gap
        height = max(height, floor + float(high_y - low_y) + options.gap)
    width = max(left, _RULER + 30 + 2 * options.gap)
    ruler = tuple(line.moved(options.gap, options.gap) for line in _ruler())
    return Pattern(name=name, panels=tuple(panels), shapes=ruler, width=width, height=height, warnings=warnings)


def _ruler() -> tuple[Line, ...]:
    """A bar of 100 mm from (0, 0) to the right, a stroke every 10 mm."""
    strokes: list[tuple[Place, ...]] = [((0.0, 0.0), (_RULER, 0.0))]
    strokes += [((x, 0.0), (x, 4.0 if x % 50 == 0 else 2.0)) for x in np.arange(0.0, _RULER + 1, 10.0).tolist()]
    bar = tuple(Line(layer=Layer.MARK, part=Part.RULER, points=points) for points in strokes)
    text = Lettering(f"{_RULER:g} mm", 4.0)
    return (*bar, *text.lines((_RULER + 4 + text.width / 2, 2.0)))
