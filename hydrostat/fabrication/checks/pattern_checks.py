"""Checks whether a pattern is true to its robot, measured on SVG and DXF as they are written, in mm."""

import io
import re
from functools import cached_property
from xml.etree import ElementTree

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.fabrication.kit import Check
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.cutting import MAX_EASE
from hydrostat.fabrication.patches.skin_holes import NearestOnSkin
from hydrostat.fabrication.patches.space_pattern import SpacePattern
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Layer, Panel, PatternPart
from hydrostat.robot import Mount, Robot, sewn_sides
from hydrostat.units import plural

_SVG = "{http://www.w3.org/2000/svg}"


class SeenSvg:
    """An SVG as it is written (InputError: it has no size in millimeters)."""

    def __init__(self, content: bytes) -> None:
        self._root = ElementTree.fromstring(content)
        width = re.fullmatch(r"([\d.]+)mm", self._root.get("width", ""))
        box = [float(number) for number in self._root.get("viewBox", "").split()]
        if width is None or len(box) != 4:
            raise InputError("pattern.svg: no size in millimeters")
        self._scale, self._height = float(width[1]) / box[2], box[3]

    def circles(self, part: PatternPart, *, panel: str = "") -> Float[np.ndarray, "circles 3"]:
        """Middle and radius of each circle that stands for a part [mm], of all panels or of one."""
        found = [
            (float(item.get("cx", 0)), self._height - float(item.get("cy", 0)), float(item.get("r", 0)))
            for group in self._root.iter(f"{_SVG}g")
            if group.get("id", "").endswith(f"-{panel}") or (not panel and "-" in group.get("id", ""))
            for item in group.findall(f"{_SVG}circle")
            if item.get("class") == part
        ]
        return self._scale * np.array(found, dtype=float).reshape(-1, 3)

    def paths(self, part: PatternPart) -> list[Float[np.ndarray, "_ 2"]]:
        """Corners of all paths that stand for a part [mm]."""
        found = []
        for item in self._root.iter(f"{_SVG}path"):
            if item.get("class") == part:
                numbers = np.array(re.findall(r"-?[\d.]+", item.get("d", "")), dtype=float).reshape(-1, 2)
                found.append(self._scale * np.column_stack([numbers[:, 0], self._height - numbers[:, 1]]))
        return found


class SeenDxf:
    """A DXF as it is written."""

    def __init__(self, content: bytes) -> None:
        from ezdxf.filemanagement import read

        self._document = read(io.StringIO(content.decode()))

    @property
    def millimeters(self) -> bool:
        """True if the drawing is in millimeters."""
        millimeters = 4  # value of $INSUNITS in a DXF in millimeters
        return self._document.header.get("$INSUNITS") == millimeters

    @cached_property
    def pinholes(self) -> Float[np.ndarray, "circles 3"]:
        """Middle and radius of each circle that is cut as a pinhole [mm]."""
        found = [
            (*item.dxf.center.vec2, item.dxf.radius)
            for item in self._document.modelspace().query("CIRCLE")
            if item.dxf.layer == Layer.PINHOLE.upper()
        ]
        return np.array(found, dtype=float).reshape(-1, 3)

    @cached_property
    def level_lines(self) -> Float[np.ndarray, " lines"]:
        """Lengths of the lines that are marked from left to right [mm], each of two ends."""
        lines = self._document.modelspace().query(f'LWPOLYLINE[layer=="{Layer.MARK.upper()}"]')
        ends = [np.array(item.get_points("xy")) for item in lines]  # type: ignore[attr-defined]
        found = [abs(end[1, 0] - end[0, 0]) for end in ends if len(end) == 2 and end[0, 1] == end[1, 1]]
        return np.array(found, dtype=float)


def drawing_checks(svg: SeenSvg, dxf: SeenDxf) -> tuple[Check, ...]:
    """Check that both drawings show the same holes, and the scale bar at its length of 100 mm."""
    return _same_holes(svg.circles(PatternPart.PINHOLE), dxf.pinholes), _bar(svg, dxf)


def farthest(one: Float[np.ndarray, "ones d"], other: Float[np.ndarray, "others d"]) -> float:
    """The largest distance from a place of either to the nearest of the other; infinite if one has none."""
    if not len(one) and not len(other):
        return 0.0
    away = np.linalg.norm(one[:, None] - other[None], axis=2)
    return max(float(away.min(axis=side, initial=np.inf).max(initial=0.0)) for side in (0, 1))


def _same_holes(svg: Float[np.ndarray, "holes 3"], dxf: Float[np.ndarray, "others 3"]) -> Check:
    """Each hole of one has one of the other in its place, of its size."""
    gap = farthest(svg, dxf) if len(svg) == len(dxf) else np.inf
    return Check(
        what=f"SVG and DXF show the same {len(svg)} holes",
        measured=f"at most {gap:.3f} mm apart" if np.isfinite(gap) else f"{len(svg)} and {len(dxf)} holes",
        allowed="0.01 mm",
        passed=gap <= 0.01,
    )


def _bar(svg: SeenSvg, dxf: SeenDxf) -> Check:
    drawn = max((float(np.ptp(points[:, 0])) for points in svg.paths(PatternPart.RULER)), default=0.0)
    near = dxf.level_lines[np.argmin(np.abs(dxf.level_lines - 100.0))] if len(dxf.level_lines) else 0.0
    unit = "" if dxf.millimeters else ", but the DXF does not count millimeters"
    scale = 0.1  # maximum error of the bar of 100 mm [mm]
    return Check(
        what="the check bar of the pattern is as long as it says",
        measured=f"{drawn:.3f} mm in the SVG, {near:.3f} mm in the DXF{unit}",
        allowed=f"100 mm, {scale:g} mm more or less",
        passed=max(abs(drawn - 100.0), abs(float(near) - 100.0)) <= scale and dxf.millimeters,
    )


HOLES = 0.1  # maximum distance of a hole from the simulated cable [mm]


def pattern_checks(
    robot: Robot, pattern: Pattern, svg: bytes, dxf: bytes, options: PatternOptions
) -> tuple[Check, ...]:
    """Holes and scale of the SVG, and whether the DXF shows the same; InputError if it is no drawing in millimeters."""
    seen = SeenSvg(svg)
    holes = [
        _flat_holes(robot, pattern.panel(side), seen.circles(PatternPart.PINHOLE, panel=side), options)
        for side in sewn_sides(robot)
    ]
    return *holes, *drawing_checks(seen, SeenDxf(dxf))


def _flat_holes(robot: Robot, panel: Panel, circles: Float[np.ndarray, "holes 3"], options: PatternOptions) -> Check:
    """Every point of a cable is where a hole of its own would lie within the hole that is cut."""
    worst, count = 0.0, 0
    for cable in robot.cables:
        first = 1 if robot.winch(cable.winch).mount is Mount.WORLD else 0
        for point in cable.points[first:]:
            place = np.array(panel.on_sheet(point))
            away = np.linalg.norm(circles[:, :2] - place, axis=1) - (circles[:, 2] - options.pinhole / 2)
            worst = max(worst, float(np.maximum(away, 0.0).min(initial=np.inf)))
            count += 1
    return Check(
        what=f"pinholes {_on(panel, robot)}are where the {count} points of the simulated cables are",
        measured=f"at most {worst:.3f} mm off",
        allowed=f"{HOLES:g} mm",
        passed=worst <= HOLES,
    )


def _on(panel: Panel, robot: Robot) -> str:
    """Name of the panel for a check; empty if only the front is sewn."""
    return "" if sewn_sides(robot) == ("front",) else f"of the {panel.name} "


def patch_checks(robot: Robot, pattern: SpacePattern, svg: bytes, dxf: bytes) -> tuple[Check, ...]:
    """Holes, seams, outlines, area and scale; InputError if it is no drawing in millimeters."""
    seen = SeenSvg(svg)
    drawn = (_space_holes(robot, pattern, seen), _crosses(robot, pattern, seen), _outlines(pattern, seen))
    return (*drawn, *drawing_checks(seen, SeenDxf(dxf)), _seams(pattern), _area(pattern))


def _space_holes(robot: Robot, pattern: SpacePattern, svg: SeenSvg) -> Check:
    """Every pinhole of the drawing belongs to a point of a cable, and every such point has its own."""
    seen = svg.circles(PatternPart.PINHOLE)[:, :2]
    wanted = [hole for hole in pattern.holes if hole.passes and not hole.in_seam]
    points = np.array([robot.cables[hole.cable - 1].points[hole.point - 1] for hole in wanted]).reshape(-1, 3)
    worst = 0.0
    if len(points):
        worst = farthest(NearestOnSkin(pattern.patches).nearest(1e3 * points)[2], seen)
    return Check(
        what=f"pinholes are where the skin is nearest to {len(wanted)} points of the simulated cables",
        measured=f"{len(seen)} holes, at most {worst:.3f} mm off",
        allowed=f"{HOLES:g} mm, no hole without a point, cables that meet share one",
        passed=worst <= HOLES and len(seen) <= len(wanted),
    )


def _crosses(robot: Robot, pattern: SpacePattern, svg: SeenSvg) -> Check:
    """Every cross is on both sides of a seam, where that is nearest to the point of a cable."""
    wanted = []
    for hole in pattern.holes:
        if hole.passes and hole.in_seam:
            point = 1e3 * np.array(robot.cables[hole.cable - 1].points[hole.point - 1])
            seam = min(pattern.seams, key=lambda seam: seam.nearest(point)[0])
            wanted += [seam.place(seam.nearest(point)[1], side) for side in (0, 1)]
    seen = np.array([path.mean(axis=0) for path in svg.paths(PatternPart.MARKER)]).reshape(-1, 2)
    worst = farthest(np.array(wanted).reshape(-1, 2), seen)
    return Check(
        what=f"crosses on seams are where {len(wanted) // 2} points of the simulated cables pass between stitches",
        measured=f"{len(seen) / 2:g} crosses, at most {worst:.3f} mm off",
        allowed=f"{HOLES:g} mm, one on each side",
        passed=worst <= HOLES and len(seen) <= 2 * len(wanted) and len(seen) % 2 == 0,
    )


def _seams(pattern: SpacePattern) -> Check:
    worst = max((seam.mismatch for seam in pattern.seams), default=0.0)
    return Check(
        what=f"equally long sides of {plural(len(pattern.seams), 'seam')}",
        measured=f"at most {worst:.1%} apart, beyond half a millimeter",
        allowed=f"{MAX_EASE:.0%}, eased in",
        passed=worst <= MAX_EASE,
    )


def _outlines(pattern: SpacePattern, svg: SeenSvg) -> Check:
    """The seam lines of the drawing are the rims of the patches: compared by the length of each."""
    drawn = [np.linalg.norm(np.roll(path, -1, axis=0) - path, axis=1).sum() for path in svg.paths(PatternPart.SEAM)]
    sewn = [patch.outline.exterior.length for patch in pattern.patches]
    gap = float(np.abs(np.sort(drawn) - np.sort(sewn)).max()) if len(drawn) == len(sewn) else np.inf
    return Check(
        what=f"the seam lines of the drawing are as long as those of the {len(sewn)} patches",
        measured=f"at most {gap:.3f} mm apart" if np.isfinite(gap) else f"{len(drawn)} seam lines",
        allowed="0.1 mm",
        passed=gap <= 0.1,
    )


def _area(pattern: SpacePattern) -> Check:
    patches = sum(float(patch.disc.areas.sum()) for patch in pattern.patches)
    least = min(float(patch.flat_areas.min()) for patch in pattern.patches)
    off = abs(patches / pattern.skin - 1)
    return Check(
        what="the patches cover the skin once, and no part of one lies on its back",
        measured=f"{patches:.1f} mm^2 of {pattern.skin:.1f} mm^2" + ("" if least > 0 else ", some turned over"),
        allowed="1e-9 of it more or less",
        passed=off <= 1e-9 and least > 0,
    )
