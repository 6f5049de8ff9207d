"""Channels of cables on a skin. Oracles: lengths by hand."""

import pytest

from hydrostat.fabrication.patterns.channels import WIDTH, channel_strips
from hydrostat.fabrication.patterns.shape import LaserLine, PatternPart


def test_strips_are_as_long_as_their_cables_and_marked_at_each_point() -> None:
    """C1 is 100 mm from its first point to its last; C2 of 220 mm is in two pieces of 110 mm, each with its points."""
    points = {"C1": [("2", 30.0), ("3", 75.0), ("4", 130.0)], "C2": [("2", 10.0), ("3", 90.0), ("4", 230.0)]}
    strips = channel_strips("glove", points)
    assert [panel.name for panel in strips.panels] == ["C1", "C2 a", "C2 b"]
    found = []
    for panel in strips.panels:
        lines = [line for line in panel.shapes if isinstance(line, LaserLine)]
        edge = next(line for line in lines if line.part is PatternPart.EDGE)
        left, low, right, high = edge.geometry.bounds
        assert high - low == pytest.approx(WIDTH)
        marks = [line.points[0][0] - left - 12 for line in lines if line.part is PatternPart.NOTCH]
        found.append((right - left - 24, *marks))
    assert found == [
        pytest.approx((100.0, 0.0, 45.0, 100.0)),
        pytest.approx((110.0, 0.0, 80.0)),
        pytest.approx((110.0, 110.0)),
    ]
    assert strips.width < 190  # one page wide
