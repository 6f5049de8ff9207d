"""Whether printed spools take in as much cable a turn as the robot file says."""

from collections.abc import Iterable

import numpy as np

from hydrostat.fabrication.parts.winch_unit import WinchUnit
from hydrostat.fabrication.self_check import Check
from hydrostat.robot import Robot

RADIUS = 0.1
"""How far the radius at which a cable is wound may be from that of the robot file [mm]."""


def spool_checks(robot: Robot, units: Iterable[WinchUnit]) -> tuple[Check, ...]:
    """Each groove cut across its middle: the floor that is measured there, and half a cable, against the robot file."""
    gaps = [gap for unit in units for gap in _gaps(robot, unit)]
    if not gaps:
        return ()
    worst = max(gaps)
    return (
        Check(
            what=f"the {len(gaps)} grooves of the printed spools have the radius that was simulated",
            measured=f"at most {worst:.3f} mm off",
            allowed=f"{RADIUS:g} mm",
            passed=worst <= RADIUS,
        ),
    )


def _gaps(robot: Robot, unit: WinchUnit) -> Iterable[float]:
    solid = next(part.solid for part in unit.printed if part.name.startswith("spool"))
    usual = robot.winch(unit.winch).spool_radius
    for cable, middle in zip(unit.cables, unit.spool.middles, strict=True):
        rings = solid.slice(middle).to_polygons()
        floor = max(float(np.linalg.norm(ring, axis=1).max()) for ring in rings)
        yield abs(floor + unit.spool.cable / 2 - 1e3 * (robot.cables[cable].spool_radius or usual))
