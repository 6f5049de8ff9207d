"""A program that turns motors on a serial line until something happens to it; `test_processes` starts it.

Its last argument says how many times slower than the clock its time passes, as that of the servos does then.
"""

import itertools
import sys
import time
from typing import cast

import numpy as np
import serial

SLOW = float(sys.argv[-1])
_monotonic, _gettime, _sleep = time.monotonic, time.clock_gettime, time.sleep
time.monotonic = lambda: _monotonic() / SLOW
time.clock_gettime = lambda which: _gettime(which) / SLOW
time.sleep = lambda seconds: _sleep(seconds * SLOW)

from emulation import NAMES, RADIUS  # noqa: E402

from hydrostat.cli import one_interrupt  # noqa: E402
from hydrostat.control import BusLink, Calibration, DynamixelBus, Motors, Player, Port, WinchMotor  # noqa: E402
from hydrostat.control.feetech_bus import FeetechBus  # noqa: E402
from hydrostat.errors import HydrostatError  # noqa: E402
from hydrostat.robot import Winch  # noqa: E402
from hydrostat.simulation import ContractionProfile  # noqa: E402


def main(path: str, kind: str, event: str) -> None:
    """Play one slow pull, and say how it ended."""
    line = cast(Port, serial.Serial(path, 57600, timeout=0.02 * SLOW, write_timeout=0.1 * SLOW))
    bus = (FeetechBus if kind == "feetech" else DynamixelBus)(line, [1, 2, 3], answer=0.1)
    winches = [Winch(name=name, at=(0.0, 0.0), spool_radius=RADIUS, travel=0.04, release=0.002) for name in NAMES]
    spools = [WinchMotor(winch=name, number=n, zero=1.0, radius=RADIUS, current=0.3) for n, name in enumerate(NAMES, 1)]
    link = BusLink(bus, winches, Calibration(tuple(spools)))
    link.identify()
    link.arm()
    link.watch()
    motors = Motors(winches, link, places=link.read(time.monotonic()), fastest=0.012)
    if event == "clock jumps":
        jumps = itertools.cycle((0.0, 3.15e7, -3.15e7))
        real = time.time
        time.time = lambda: real() + next(jumps)
    ticks, player = itertools.count(), Player()
    player.rounds = 1

    def tell() -> None:
        if event == "crash" and next(ticks) > 40:
            raise ZeroDivisionError

    far = 0.0096 if event == "clock jumps" else 0.03  # goals far ahead, which the link must not pass on as they are
    profile = ContractionProfile(times=np.array([0.0, 0.2]), values=np.full((2, 3), far))
    try:
        with one_interrupt(""):
            player.run(motors, profile, tell=tell)
    finally:
        link.close()
    sys.stdout.write("played\n")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:4])
    except HydrostatError as error:
        sys.exit(str(error))
