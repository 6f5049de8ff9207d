"""`arm_motors`: the motors of a robot on a port, identified, guarded and armed."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus_link import BusLink
from hydrostat.control.calibration import Calibration
from hydrostat.control.corrected_link import CorrectedLink
from hydrostat.control.guard import TensionGuard
from hydrostat.control.link import Link
from hydrostat.control.motors import Motors
from hydrostat.control.open_bus import EMULATED, open_bus
from hydrostat.identification import ContractionMap
from hydrostat.robot import Robot

Pulls = Callable[[Vector], Vector]


def arm_motors(
    folder: Path,
    robot: Robot,
    port: str,
    pulls: Pulls,
    *,
    known: Pulls | None = None,
    motor: str | None = None,
    log: Callable[[str], None] = lambda _: None,
) -> Motors:
    """Return armed motors that follow commands, monitored by a deadline and a guard.

    A correction.json in the folder, written by `hydrostat identify`, corrects their commands.

    Args:
        folder: robot folder with motors.toml; emulated motors need none.
        robot: robot whose winches the motors turn.
        port: motor connection, as for `open_bus`.
        pulls: total cable tension of each winch [N] as a function of contractions [m].
        known: the same function for the guard, with NaN to skip its check; `pulls` if left out.
        motor: key of the emulated motors; that of the robot if left out.
        log: callback for each message about the motors.

    Raises:
        InputError: an invalid port or calibration.
        HydrostatError: a motor is silent, or the wrong model.
    """
    correction = ContractionMap.read(folder, robot)
    found = Calibration.emulate if port == EMULATED else Calibration.read
    emulated = robot if motor is None else replace(robot, motor=motor)
    calibration = found(folder, emulated)
    felt, known = pulls, known or pulls
    if correction is not None:
        felt, known = (_follow(correction, each) for each in (pulls, known))
        log("correction.json corrects contractions")
    bus = open_bus(port, emulated, calibration, felt)
    link = BusLink(bus, robot.winches, calibration, log=log)
    try:
        facts = link.identify()
        if port == EMULATED:
            models = ", ".join(sorted({fact.model for fact in facts}))
            source = "in robot.toml" if motor in (None, robot.motor) else "of motors.toml or its design"
            log(f'{port}: motors are {models} (motor = "{emulated.motor}" {source})')
        constants = np.array([fact.constant for fact in facts])
        link.guard = TensionGuard(known, constants, calibration.labels)
        link.arm()
        places = link.read(time.monotonic())
    except BaseException:
        link.close()
        raise
    outer: Link = link
    if correction is not None:
        outer, places = CorrectedLink(link, correction), correction.effective(places)
    clock = bus.clock if port == EMULATED else time.monotonic
    return Motors(robot.winches, outer, places=places, fastest=link.limits.speed, clock=clock)


def _follow(correction: ContractionMap, pulls: Pulls) -> Pulls:
    """Pulls of winches by commanded contractions [m]."""
    return lambda commands: pulls(correction.effective(commands))
