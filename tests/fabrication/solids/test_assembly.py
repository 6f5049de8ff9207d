"""Pieces that need the same place are found, pieces that touch are not."""

import math

import pytest
from manifold3d import Manifold

from hydrostat.fabrication.solids.assembly import Assembly, Placed, interferences
from hydrostat.fabrication.solids.construct import Box, Cylinder, solid_of


def put_together(*solids: Manifold) -> Assembly:
    pieces = tuple(Placed(name=f"piece{k}", title="Piece", solid=solid) for k, solid in enumerate(solids))
    return Assembly(name="whole", pieces=pieces)


def test_an_overlap_is_found_with_its_volume():
    """Oracle: two boxes that share 1 x 2 x 3 mm, a third far away."""
    box = solid_of(Box((4, 4, 4)))
    (found,) = interferences(put_together(box, box.translate((50, 0, 0)), box.translate((3, 2, 1))))
    assert (found.one, found.other) == ("piece0", "piece2")
    assert found.volume == pytest.approx(6.0, rel=1e-9)


def test_faces_that_touch_are_no_overlap():
    box = solid_of(Box((4, 4, 4)))
    assert interferences(put_together(box, box.translate((4, 0, 0)), box.translate((4, 4, 4)))) == ()


def test_a_shaft_needs_a_bore_as_wide():
    """Oracle: a ring of closed-form area; a bore of the shaft's very radius has none."""
    shaft = solid_of(Cylinder(10, 3))
    loose = solid_of(Box((20, 20, 10)).moved(-10, -10, 0) - Cylinder(10, 3))
    assert interferences(put_together(shaft, loose)) == ()
    tight = solid_of(Box((20, 20, 10)).moved(-10, -10, 0) - Cylinder(10, 2.8))
    (found,) = interferences(put_together(shaft, tight))
    assert found.volume == pytest.approx(10 * math.pi * (3**2 - 2.8**2), rel=0.05)


def test_what_is_less_than_asked_for_is_not_told():
    """Oracle: two boxes that share 0.1 x 4 x 4 mm."""
    box = solid_of(Box((4, 4, 4)))
    lapped = put_together(box, box.translate((3.9, 0, 0)))
    assert interferences(lapped, least=2.0) == ()
    assert len(interferences(lapped, least=0.09)) == 1
