"""Checks whether a pattern is true to its robot, measured on the SVG and DXF that are written."""

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.checks.seen_drawings import SeenDxf, SeenSvg, drawing_checks, farthest
from hydrostat.fabrication.kit_options import PatternOptions
from hydrostat.fabrication.patches.cutting import MOST_EASE
from hydrostat.fabrication.patches.skin_holes import NearestOnSkin
from hydrostat.fabrication.patches.space_pattern import SpacePattern
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import PatternPart
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Mount, Robot

HOLES = 0.1  # how far a hole may be from where the simulated cable passes [mm]


def pattern_checks(
    robot: Robot, pattern: Pattern, svg: bytes, dxf: bytes, options: PatternOptions
) -> tuple[Check, ...]:
    """Holes and scale of the SVG, and whether the DXF shows the same; InputError if it is no drawing in millimetres."""
    seen = SeenSvg(svg)
    front = seen.circles(PatternPart.PINHOLE, panel="front")
    return _flat_holes(robot, pattern, front, options), *drawing_checks(seen, SeenDxf(dxf))


def _flat_holes(
    robot: Robot, pattern: Pattern, circles: Float[np.ndarray, "holes 3"], options: PatternOptions
) -> Check:
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


def patch_checks(robot: Robot, pattern: SpacePattern, svg: bytes, dxf: bytes) -> tuple[Check, ...]:
    """Holes, seams, outlines, area and scale; InputError if it is no drawing in millimetres."""
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
        what=f"both sides of each of {len(pattern.seams)} seams are equally long",
        measured=f"at most {worst:.1%} apart",
        allowed=f"{MOST_EASE:.0%}, eased in",
        passed=worst <= MOST_EASE,
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
