"""Risks of pins."""

from collections.abc import Iterator

import numpy as np

from hydrostat.geometry.thickness import spacings
from hydrostat.robot.risks.words import Found, mm, told_together
from hydrostat.robot.robot import Robot
from hydrostat.units import counted


def pin_risks(robot: Robot) -> Iterator[str]:
    """Pins that hold all or hardly anything. None at all is an error, which `Robot` raises."""
    mesh = robot.body.mesh
    held = [pin.holds(mesh) for pin in robot.pins]
    if np.any(held, axis=0).all():
        yield "pin: every node of the body is held, nothing can move; make a radius or a box smaller"
    reach = 1.5 * float(np.median(spacings(mesh)))
    found = []
    for index, nodes in enumerate(held):
        count = int(nodes.sum())
        if count < mesh.dim:
            grip = f"holds only {counted(count, 'node')}" if count else "reaches no node and holds a single point"
            text = f"{grip}, about which the body can turn and tear; a radius of {mm(reach)} would grip it"
            found.append(Found(f"pin[{index}]", -count, text))
    yield from told_together(found)
