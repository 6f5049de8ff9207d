"""Pieces for the bed: oracles are volumes and boolean intersection."""

import numpy as np
import pytest
from manifold3d import Manifold

from hydrostat.fabrication.moulds.split import DOWEL, DOWEL_DEPTH, cuts, grid, split_solid


def test_cuts_are_as_few_as_can_be() -> None:
    assert cuts(0, 220, 220) == ()
    assert cuts(0, 221, 220) == pytest.approx([110.5])
    assert cuts(-10, 890, 300) == pytest.approx([290, 590])


def test_a_long_piece_is_turned_on_the_bed() -> None:
    assert grid((0, 0, 0), (100, 300, 10), (310, 110, 50)) == ((), ())


def test_pieces_of_a_block_are_whole_and_joined_by_dowels() -> None:
    block = Manifold.cube((300, 300, 40)) - Manifold.sphere(60, 32).translate((150, 150, 40))
    pieces = split_solid(block, (150.0,), (150.0,))
    assert len(pieces.solids) == 4
    assert pieces.dowels == 8
    assert pieces.lost == pytest.approx(8 * np.pi * DOWEL**2 * 2 * DOWEL_DEPTH, rel=0.02)
    assert sum(piece.volume() for piece in pieces.solids) + pieces.lost == pytest.approx(block.volume(), rel=1e-9)
    for place, one in enumerate(pieces.solids):
        assert one.genus() == 0
        for other in pieces.solids[place + 1 :]:
            assert (one ^ other).volume() < 1e-6


def test_thin_joints_are_butted_and_crumbs_are_left_out() -> None:
    ring = Manifold.cube((300, 100, 30)) - Manifold.cube((294, 94, 40)).translate((3, 3, -1))
    pieces = split_solid(ring, (150.0,), ())
    assert pieces.dowels == 0
    assert len(pieces.solids) == 2
    crumbed = split_solid(ring + Manifold.cube((2, 0.5, 1)).translate((149.9, 50, 0)), (150.0,), ())
    assert len(crumbed.solids) == 2
    assert crumbed.lost == pytest.approx(1.0)
