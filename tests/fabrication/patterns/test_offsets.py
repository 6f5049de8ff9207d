"""The cut is the parallel of the seam: closed forms for convex outlines, distances for the others."""

import math

import numpy as np
import pytest
import shapely
from plush_robots import disc_path, drawn_body, plush_robot
from scipy.spatial import cKDTree

from hydrostat.fabrication import PatternOptions, plush_pattern
from hydrostat.fabrication.patterns.shape import Panel, PatternPart

CONVEX = {
    "triangle": "M0 0H120L30 90Z",
    "strip": "M0 0H200V25H0Z",
    "hexagon": disc_path(50.0, corners=6),
    "seventeen corners": disc_path(70.0, corners=17),
    "kite": "M60 0L120 40L60 150L0 40Z",
}

BENT = {
    "L": "M0 0H120V70H70V120H0Z",
    "star": "M100 0L124 67L195 69L138 112L159 181L100 140L41 181L62 112L5 69L76 67Z",
    "notched": "M0 0H45L60 40L75 0H120V90H0Z",
}


def cut_and_seam(path: str, allowance: float) -> tuple[shapely.Polygon, shapely.Polygon]:
    options = PatternOptions(seam_allowance=allowance, force=True)
    panel: Panel = plush_pattern(plush_robot(drawn_body(path), marker=(0, 0)), options=options).panel("front")
    found = {shape.part: shape for shape in panel.shapes if shape.part in (PatternPart.EDGE, PatternPart.SEAM)}
    return shapely.Polygon(found[PatternPart.EDGE].points), shapely.Polygon(found[PatternPart.SEAM].points)


@pytest.mark.parametrize("allowance", [5.0, 8.0, 12.0])
@pytest.mark.parametrize("name", CONVEX)
def test_a_convex_outline_grows_by_steiners_formula(name, allowance):
    """Oracle: closed form: A + P d + pi d^2 and P + 2 pi d; tolerance: chords 0.015 mm inside their arcs."""
    cut, seam = cut_and_seam(CONVEX[name], allowance)
    grown = seam.area + seam.length * allowance + math.pi * allowance**2
    assert cut.area == pytest.approx(grown, abs=0.015 * 2 * math.pi * allowance)
    assert cut.length == pytest.approx(seam.length + 2 * math.pi * allowance, abs=0.1)


def farthest(cut: shapely.Polygon, seam: shapely.Polygon, allowance: float) -> float:
    """How far the cut is anywhere from being one allowance off the nearest place of the seam [mm]."""
    along_cut, along_seam = (shapely.get_coordinates(shapely.segmentize(ring.exterior, 0.05)) for ring in (cut, seam))
    return float(np.abs(cKDTree(along_seam).query(along_cut)[0] - allowance).max())


@pytest.mark.parametrize("name", BENT)
def test_a_bent_outline_keeps_its_distance(name):
    """Oracle: nearest points of densely sampled lines, by a tree of scipy, which knows nothing of offsets."""
    assert farthest(*cut_and_seam(BENT[name], 8.0), 8.0) < 0.03


def test_the_check_of_distances_can_fail():
    """Oracle: a cut 0.1 mm to the side."""
    cut, seam = cut_and_seam(BENT["L"], 8.0)
    assert farthest(shapely.affinity.translate(cut, 0.1), seam, 8.0) > 0.05
