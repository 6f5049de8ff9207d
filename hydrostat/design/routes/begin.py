"""`layout_of`: the network of a robot as a layout, to be kept or improved."""

import numpy as np

from hydrostat.design.constraints import Constraints
from hydrostat.design.routes.layout import Layout, Line, Stand
from hydrostat.robot import Cable, Robot


def layout_of(robot: Robot, constraints: Constraints) -> Layout:
    """Winches and cables of a robot; those that are locked stay as they are.

    A cable sheathed anywhere but from its winch on is kept as it is too: what is sheathed in the middle is not moved.
    """
    names = [winch.name for winch in robot.winches]
    stands, lines = [], []
    for winch in robot.winches:
        kept = any(robot.cables[number].winch == winch.name for number in constraints.locked_cables)
        stands.append(Stand(winch, fixed=kept or winch.name in constraints.locked_winches))
    for number, cable in enumerate(robot.cables):
        lead = _lead(cable)
        kept = number in constraints.locked_cables or lead is None
        winch = robot.winch(cable.winch)
        ratio = 1.0 if cable.spool_radius is None else cable.spool_radius / winch.spool_radius
        lines.append(
            Line(
                names.index(cable.winch),
                np.array(cable.points),
                lead=lead or 0,
                slack=cable.slack,
                ratio=ratio,
                kept=cable if kept else None,
            )
        )
    return Layout(robot, constraints, tuple(stands), tuple(lines))


def _lead(cable: Cable) -> int | None:
    """How many segments from the winch on are sheathed; None if others are."""
    sheathed = ~cable.bare
    count = int(np.argmin(sheathed)) if sheathed.any() else 0
    return None if sheathed[count:].any() else count
