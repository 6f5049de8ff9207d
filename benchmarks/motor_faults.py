"""Faults that are injected into emulated motors: do they stay within limits, stop in time, and is each told?

    python benchmarks/motor_faults.py [--count 10000] [--seed 0] [--seconds 600] [--boards]

Three winches with emulated servos pull at springs, in seven runs of ten those of Dynamixel, else those of Feetech,
while a host tells them goals 50 times a second. Bytes are dropped, flipped, doubled and delayed both ways; servos fall
silent, get stuck, run hot, begin again; lines are unplugged, hosts die or sleep; cables are cut or jammed, where motors
tell the torque of their current, so that a guard can know. A third of the springs pull as hard as the bounds of current
allow half-way already. Half of the servos have a watchdog that does not stop them, as those of the 330 series, and
Feetech's have none.
With --boards two to four lines with one to three motors each are joined as one bus, four runs of ten of Dynamixel, two
of Feetech, four of boards with our firmware, emulated too; what is hard befalls one or more of them, and somebody arms
them again afterwards.
Time is that of the emulation. Counted are motions beyond limits, pulls more than 5 % above what the bound of the
current allows (of boards: for longer than 60 ms), motors that move later than 250 ms after the last goal they were
told, and faults that are told in other words than their own or, where there is one bus, of another winch.
"""

import argparse
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "control"))

from fault_campaign import Campaign
from machine import machine
from several_boards import BoardsCampaign


def main() -> None:
    """Print what was injected, and what came of it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="of CPU, at most")
    parser.add_argument("--boards", action="store_true", help="several boards as one bus")
    given = parser.parse_args()
    print(machine())
    kind = BoardsCampaign if given.boards else Campaign
    campaign, began = kind(np.random.default_rng(given.seed), seconds=2.0, share=0.25), time.process_time()
    with suppress(KeyboardInterrupt):
        while campaign.injected < given.count and time.process_time() - began < given.seconds:
            campaign.run()
    for line in campaign.told():
        print(line)
    print(f"seed {given.seed}, {time.process_time() - began:.0f} s of CPU")


if __name__ == "__main__":
    main()
