"""Pieces that need the same place are found, pieces that touch are not."""

import math

import numpy as np
import pytest
from manifold3d import Manifold

from hydrostat.fabrication.solids.assembly import PartAssembly, Placed, interferences
from hydrostat.fabrication.solids.body_solid import closed_solid
from hydrostat.fabrication.solids.construct import Box, Cylinder, solid_of
from hydrostat.fabrication.solids.printed import triangles_of


def put_together(*solids: Manifold) -> PartAssembly:
    pieces = tuple(Placed(name=f"piece{k}", title="Piece", solid=solid) for k, solid in enumerate(solids))
    return PartAssembly(name="whole", pieces=pieces)


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
    loose = solid_of(Box((20, 20, 10)).move(-10, -10, 0) - Cylinder(10, 3))
    assert interferences(put_together(shaft, loose)) == ()
    tight = solid_of(Box((20, 20, 10)).move(-10, -10, 0) - Cylinder(10, 2.8))
    (found,) = interferences(put_together(shaft, tight))
    assert found.volume == pytest.approx(10 * math.pi * (3**2 - 2.8**2), rel=0.05)


def test_what_is_less_than_asked_for_is_not_told():
    """Oracle: two boxes that share 0.1 x 4 x 4 mm."""
    box = solid_of(Box((4, 4, 4)))
    lapped = put_together(box, box.translate((3.9, 0, 0)))
    assert interferences(lapped, least=2.0) == ()
    assert len(interferences(lapped, least=0.09)) == 1


def bumpy(turn: float) -> tuple[Manifold, Manifold]:
    """A ball with bumps, and the upper half of a block round it with a hole above."""

    def bumped(places: np.ndarray) -> np.ndarray:
        x, y, z = np.asarray(places).T
        return places * (1 + 0.12 * np.sin(x / 4 + turn) * np.sin(y / 3 - turn) * np.cos(z / 5))[:, None]

    ball = Manifold.sphere(30, 48).warp_batch(bumped)
    for k in range(6):
        dent = Manifold.cylinder(3, 2, 1, 16).rotate((60 * k, 30, 20 * k))
        spot = np.array([[30 * np.cos(k), 24 * np.sin(k), 18]])
        ball = ball - dent.translate(tuple(bumped(spot)[0].tolist()))
    block = Manifold.cube((90, 90, 90), True) - ball - Manifold.cylinder(60, 6)
    half = block.trim_by_plane((0, 0, 1), 0.0)
    return closed_solid(*triangles_of(ball)), closed_solid(*triangles_of(half))


@pytest.mark.parametrize("turn", [1 + 1 / 7, 1 + 22 / 7])
def test_what_is_cut_out_of_a_block_shares_nothing_with_it(turn: float):
    """Oracle: sets; and drawn together by 0.01 mm, what the hole of the half is wide, less the one above."""
    ball, half = bumpy(turn)
    assert interferences(put_together(ball, half)) == ()
    assert interferences(put_together(half, ball)) == ()
    (found,) = interferences(put_together(ball, half.translate((0, 0, -0.01))))
    disc = half.slice(0.005)
    shadow = 90**2 - disc.area() - math.pi * 6**2
    assert found.volume == pytest.approx(0.01 * shadow, rel=0.06)
