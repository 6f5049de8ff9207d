"""Whether a pattern is true to its robot: measured on the SVG and DXF that are written."""

import io
import re
from collections.abc import Iterator
from xml.etree import ElementTree

import numpy as np
from jaxtyping import Float

from hydrostat.errors import InputError
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.pattern_options import PatternOptions
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Mount, Robot

HOLES = 0.1
"""How far a hole may be from where the simulated cable passes [mm]."""

SCALE = 0.1
"""How much the bar of 100 mm may be too long or too short [mm]."""

_SVG = "{http://www.w3.org/2000/svg}"


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
    seen = _circles_of_svg(svg)
    return (
        _holes(robot, pattern, seen, options),
        _same_holes(seen, _circles_of_dxf(dxf)),
        _bar(svg),
    )


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


def _same_holes(svg: Float[np.ndarray, "holes 3"], dxf: Float[np.ndarray, "others 3"]) -> Check:
    """Each hole of one has one of the other in its place, of its size."""
    gap = np.inf
    if len(svg) == len(dxf):
        gaps = np.linalg.norm(svg[:, None] - dxf[None], axis=2)
        gap = max(float(gaps.min(axis=side).max(initial=0.0)) for side in (0, 1)) if len(svg) else 0.0
    return Check(
        what=f"SVG and DXF show the same {len(svg)} holes",
        measured=f"at most {gap:.3f} mm apart" if np.isfinite(gap) else f"{len(svg)} and {len(dxf)} holes",
        allowed="0.01 mm",
        passed=gap <= 0.01,
    )


def _bar(svg: bytes) -> Check:
    lengths = [float(np.ptp(points[:, 0])) for points in _paths(svg, "ruler")]
    length = max(lengths, default=0.0)
    return Check(
        what="the check bar of the pattern is as long as it says",
        measured=f"{length:.3f} mm",
        allowed=f"100 mm, {SCALE:g} mm more or less",
        passed=abs(length - 100.0) <= SCALE,
    )


def _circles_of_svg(svg: bytes) -> Float[np.ndarray, "holes 3"]:
    """Holes of the drawing [mm]: x and y from its lower left corner, and radius."""
    root, scale, height = _page(svg)
    found = [
        (float(item.get("cx", 0)), height - float(item.get("cy", 0)), float(item.get("r", 0)))
        for group in root.iter(f"{_SVG}g")
        if group.get("id", "").startswith("pinhole-")
        for item in group.iter(f"{_SVG}circle")
    ]
    return scale * np.array(found, dtype=float).reshape(-1, 3)


def _circles_of_dxf(dxf: bytes) -> Float[np.ndarray, "holes 3"]:
    """The same from the other drawing."""
    from ezdxf.filemanagement import read

    space = read(io.StringIO(dxf.decode())).modelspace()
    found = [(*item.dxf.center.vec2, item.dxf.radius) for item in space.query("CIRCLE") if item.dxf.layer == "PINHOLE"]
    return np.array(found, dtype=float).reshape(-1, 3)


def _paths(svg: bytes, part: str) -> Iterator[Float[np.ndarray, "points 2"]]:
    """Corners of all paths that stand for a part [mm]."""
    root, scale, height = _page(svg)
    for item in root.iter(f"{_SVG}path"):
        if item.get("class") == part:
            numbers = np.array(re.findall(r"-?[\d.]+", item.get("d", "")), dtype=float).reshape(-1, 2)
            yield scale * np.stack([numbers[:, 0], height - numbers[:, 1]], axis=1)


def _page(svg: bytes) -> tuple[ElementTree.Element, float, float]:
    """The drawing, millimetres a unit of it counts, and its height in units."""
    root = ElementTree.fromstring(svg)
    width = re.fullmatch(r"([\d.]+)mm", root.get("width", ""))
    box = [float(number) for number in root.get("viewBox", "").split()]
    if width is None or len(box) != 4:
        raise InputError("pattern.svg: no size in millimetres")
    return root, float(width[1]) / box[2], box[3]
