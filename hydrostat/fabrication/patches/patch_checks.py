"""`patch_checks`: whether the pattern of a body in space is true to its robot, measured on the SVG that is written."""

import re
from xml.etree import ElementTree

import numpy as np
from jaxtyping import Float

from hydrostat.errors import InputError
from hydrostat.fabrication.patches.cutting import MOST_EASE
from hydrostat.fabrication.patches.skin_holes import NearestOnSkin
from hydrostat.fabrication.patches.space_pattern import SpacePattern
from hydrostat.fabrication.patterns.shape import Part
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Robot

HOLES = 0.1
"""How far a hole may be from the flat image of the skin nearest to the simulated cable [mm]."""

_SVG = "{http://www.w3.org/2000/svg}"


def patch_checks(robot: Robot, pattern: SpacePattern, svg: bytes) -> tuple[Check, ...]:
    """Holes, seams, outlines, area and scale.

    Args:
        robot: as it was simulated.
        pattern: tells where on the sheet the patches of its skin are.
        svg: the bytes of the drawing.

    Raises:
        InputError: no drawing in millimetres.
    """
    drawn = (_holes(robot, pattern, svg), _crosses(robot, pattern, svg), _outlines(pattern, svg), _bar(svg))
    return (*drawn, _seams(pattern), _area(pattern))


def _holes(robot: Robot, pattern: SpacePattern, svg: bytes) -> Check:
    """Every pinhole of the drawing belongs to a point of a cable, and every such point has its own."""
    seen = _circles(svg)
    wanted = [hole for hole in pattern.holes if hole.passes and not hole.in_seam]
    points = np.array([robot.cables[hole.cable - 1].points[hole.point - 1] for hole in wanted]).reshape(-1, 3)
    worst = 0.0
    if len(points):
        places = NearestOnSkin(pattern.patches).nearest(1e3 * points)[2]
        away = np.linalg.norm(places[:, None] - seen[None], axis=2) if len(seen) else np.full((len(points), 1), np.inf)
        worst = float(max(away.min(axis=1).max(), away.min(axis=0).max()))
    return Check(
        what=f"pinholes are where the skin is nearest to {len(wanted)} points of the simulated cables",
        measured=f"{len(seen)} holes, at most {worst:.3f} mm off",
        allowed=f"{HOLES:g} mm, no hole without a point, cables that meet share one",
        passed=worst <= HOLES and len(seen) <= len(wanted),
    )


def _crosses(robot: Robot, pattern: SpacePattern, svg: bytes) -> Check:
    """Every cross is on both sides of a seam, where that is nearest to the point of a cable."""
    wanted = []
    for hole in pattern.holes:
        if hole.passes and hole.in_seam:
            point = 1e3 * np.array(robot.cables[hole.cable - 1].points[hole.point - 1])
            seam = min(pattern.seams, key=lambda seam: seam.nearest(point)[0])
            wanted += [seam.place(seam.nearest(point)[1], side) for side in (0, 1)]
    seen = np.array([path.mean(axis=0) for path in _paths(svg, Part.MARKER)]).reshape(-1, 2)
    worst = 0.0
    if wanted:
        away = np.linalg.norm(np.array(wanted)[:, None] - seen[None], axis=2) if len(seen) else np.full((1, 1), np.inf)
        worst = float(max(away.min(axis=1).max(), away.min(axis=0).max()))
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


def _outlines(pattern: SpacePattern, svg: bytes) -> Check:
    """The seam lines of the drawing are the rims of the patches: compared by the length of each."""
    drawn = [np.linalg.norm(np.roll(path, -1, axis=0) - path, axis=1).sum() for path in _paths(svg, Part.SEAM)]
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


def _bar(svg: bytes) -> Check:
    length = max((float(np.ptp(points[:, 0])) for points in _paths(svg, Part.RULER)), default=0.0)
    return Check(
        what="the check bar of the pattern is as long as it says",
        measured=f"{length:.3f} mm",
        allowed="100 mm, 0.1 mm more or less",
        passed=abs(length - 100.0) <= 0.1,
    )


def _circles(svg: bytes) -> Float[np.ndarray, "holes 2"]:
    """Middles of the pinholes [mm]."""
    root, scale, height = _page(svg)
    found = [
        (float(item.get("cx", 0)), height - float(item.get("cy", 0)))
        for item in root.iter(f"{_SVG}circle")
        if item.get("class") == Part.PINHOLE
    ]
    return scale * np.array(found, dtype=float).reshape(-1, 2)


def _paths(svg: bytes, part: Part) -> list[Float[np.ndarray, "points 2"]]:
    """Corners of all paths that stand for a part [mm]."""
    root, scale, height = _page(svg)
    found = []
    for item in root.iter(f"{_SVG}path"):
        if item.get("class") == part:
            numbers = np.array(re.findall(r"-?[\d.]+", item.get("d", "")), dtype=float).reshape(-1, 2)
            found.append(scale * np.column_stack([numbers[:, 0], height - numbers[:, 1]]))
    return found


def _page(svg: bytes) -> tuple[ElementTree.Element, float, float]:
    """The drawing, millimetres a unit of it counts, and its height in units."""
    root = ElementTree.fromstring(svg)
    width = re.fullmatch(r"([\d.]+)mm", root.get("width", ""))
    box = [float(number) for number in root.get("viewBox", "").split()]
    if width is None or len(box) != 4:
        raise InputError("pattern.svg: no size in millimetres")
    return root, float(width[1]) / box[2], box[3]
