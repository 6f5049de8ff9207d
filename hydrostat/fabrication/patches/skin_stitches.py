"""`skin_stitches`: how each cable of a body in space is sewn, as seen from the front."""

import numpy as np

from hydrostat.fabrication.patches.skin_holes import SkinHole
from hydrostat.fabrication.patches.view import FrontView
from hydrostat.fabrication.patterns.stitches import CableStitches, Side, Stitch
from hydrostat.robot import Mount, Robot


def skin_stitches(robot: Robot, holes: tuple[SkinHole, ...], view: FrontView) -> tuple[CableStitches, ...]:
    """How each cable is sewn; points deep inside stay on the side of the one before."""
    sewn = []
    for number, cable in enumerate(robot.cables, start=1):
        begins = Side.OUTSIDE if robot.winch(cable.winch).mount is Mount.WORLD else Side.INSIDE
        own = {hole.point: hole for hole in holes if hole.cable == number}
        stitches, side = [], begins
        for point, (x, y) in enumerate(view.on_paper(1e3 * np.array(cable.points)).tolist(), start=1):
            hole = own.get(point)
            side = hole.after if hole else side
            stitches.append(Stitch(number=point, place=(x, y), passes=bool(hole and hole.passes), after=side))
        sewn.append(CableStitches(cable=number, winch=cable.winch, begins=begins, stitches=tuple(stitches)))
    return tuple(sewn)
