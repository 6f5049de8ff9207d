"""`tube_holder`: a block that pinches the tubes of a winch outside the body, where they leave its base."""

from collections.abc import Sequence

from hydrostat.fabrication.parts.part_options import PartOptions
from hydrostat.fabrication.solids.construct import Box, Construction, Cylinder

WIDE = 10.0
DEEP = 8.0
"""Of a block, across and along the tubes [mm]."""

PASSAGE = 3.4
_PILOT = 2.6
_INTO = 8.0
"""Hole in the base for the M3 screw that holds the block, its pilot in the block, and how deep that is [mm]."""

_SLOT = 1.0
"""Width of the slot that closes when the block is screwed together [mm]."""

_ABOVE = 3.0
"""From the highest tube to the screw that pinches [mm]."""


def tube_holder(heights: Sequence[float], options: PartOptions) -> Construction:
    """A block on the plane z = 0 with a bore along y for a tube at each height [mm], x = y = 0 in its middle.

    The bores have the size of the tube; a slot goes down through all of them from the top, and a screw M2 across it
    closes the block on the tubes.
    """
    lowest, highest = min(heights), max(heights)
    screw = highest + options.tube / 2 + _ABOVE
    top = screw + 3.0
    body: Construction = Box((WIDE, DEEP, top)).moved(-WIDE / 2, -DEEP / 2, 0)
    for height in heights:
        body = body - Cylinder(DEEP + 2, options.tube / 2).turned(x=90).moved(0, DEEP / 2 + 1, height)
    deep = lowest - options.tube / 2 - 0.5
    body = body - Box((_SLOT, DEEP + 2, top)).moved(-_SLOT / 2, -DEEP / 2 - 1, deep)
    body = body - Cylinder(WIDE, 1.2).turned(y=90).moved(0, 0, screw)
    body = body - Cylinder(WIDE, 0.85).turned(y=-90).moved(0, 0, screw)
    depth = min(_INTO, deep - 1.2)
    return body - Cylinder(depth + 1, _PILOT / 2).moved(0, 0, -1)
