"""Whether the pattern of a flat body is true to its robot: measured on the SVG and DXF that are written."""

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.checks.seen_drawings import SeenDxf, SeenSvg, drawing_checks
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.pattern_options import PatternOptions
from hydrostat.fabrication.patterns.shape import Part
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Mount, Robot

HOLES = 0.1
"""How far a hole may be from where the simulated cable passes [mm]."""


def pattern_checks(
    robot: Robot, pattern: Pattern, svg: bytes, dxf: bytes, options: PatternOptions
) -> tuple[Check, ...]:
    """Holes and scale of the SVG, and whether the DXF shows the same.

    Args:
        robot: as it was simulated.
        pattern: tells where the robot's origin lies on the sheet.
        svg: the bytes of the drawing.
        dxf: the bytes of the other drawing.
        options: with which it was drawn.

    Raises:
        InputError: no drawing in millimetres.
    """
    seen = SeenSvg(svg)
    front = seen.circles(Part.PINHOLE, panel="front")
    return _holes(robot, pattern, front, options), *drawing_checks(seen, SeenDxf(dxf))


def _holes(robot: Robot, pattern: Pattern, circles: Float[np.ndarray, "holes 3"], options: PatternOptions) -> Check:
    """Every point of a cable is where a hole of its own would lie within the hole that is cut."""
    front = pattern.panel("front")
    worst, count = 0.0, 0
    for cable in robot.cables:
        first = 1 if robot.winch(cable.winch).mount is Mount.WORLD else 0
        for point in cable.points[first:]:
            place = np.array(front.on_sheet(point))
            away = np.linalg.norm(circles[:, :2] - place, axis=1) - (circles[:, 2] - options.pinhole / 2)
            worst = max(worst, float(np.maximum(away, 0.0).min(initial=np.inf)))
            count += 1
    return Check(
        what=f"pinholes are where the {count} points of the simulated cables are",
        measured=f"at most {worst:.3f} mm off",
        allowed=f"{HOLES:g} mm",
        passed=worst <= HOLES,
    )
