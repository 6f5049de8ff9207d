"""Repeatability of zeros: range of six, on emulated servos of each make with 2 mA of noise, by stiffness of the cable.

Usage: python lab/motors/homing.py [MAKE ...]   (all makes: about 5 minutes of CPU on one core)
"""

import sys
import time

import numpy as np
from machine import machine

from hydrostat.control import (
    DynamixelBus,
    EmulatedChain,
    EmulatedFeetechChain,
    EmulatedScs,
    EmulatedServo,
    EmulatedSts,
    FeetechBus,
    ScsBus,
    WinchMotor,
    WinchPull,
    find_cable_zeros,
)
from hydrostat.errors import HydrostatError

MAKES = {
    "XL330": (1200, 0.52 / 1.47),
    "XC330": (1240, 0.93 / 1.8),
    "XL430": (1060, 1.5 / 1.4),
    "STS3215": (777, 1.912 / 2.7),
    "STS3215-12V": (777, 2.942 / 2.7),
    "SCS0009": (1284, 0.226 / 1.0),
}
"""Number of the model, and torque by current [N m/A]."""

RADIUS, EDGE, NOISE = 0.008, 2.5, 2e-3  # spool [m], where the cable goes taut [rad], noise of the current [A]
STIFF = (700.0, 400.0, 200.0)  # of what the cable pulls at [N/m]


def find_zero(model: int, constant: float, stiff: float, seed: int) -> tuple[float, float]:
    """Error of one zero [m], and the time that it took on the clock of the servo [s]."""
    kinds = {777: (EmulatedSts, EmulatedFeetechChain, FeetechBus), 1284: (EmulatedScs, EmulatedFeetechChain, ScsBus)}
    make, chain, kind = kinds.get(model, (EmulatedServo, EmulatedChain, DynamixelBus))
    rng = np.random.default_rng(seed)
    servo = make(1, model=model, angle=float(rng.uniform(1.75, 2.25)))
    servo.constant = constant

    def load(angle: float) -> float:
        pull = stiff * max(RADIUS * (angle - EDGE), 0.0)
        return RADIUS * pull + constant * (0.01 + NOISE * float(rng.normal()))

    servo.load = load
    port = chain([servo])
    port.STEP = 4e-3
    bus = kind(port, [1], clock=port.clock, wait=port.wait)
    bus.identify()
    model_pull = WinchPull(taut=0.0, places=np.array([-1.0, 0.0, 1.0]), pulls=np.array([0.0, 0.0, 100.0]))
    motor = WinchMotor(winch="flexor", number=1, radius=RADIUS)
    (taken,) = find_cable_zeros(bus, [motor], [model_pull], lambda _: None, clock=port.clock, wait=port.wait)
    return RADIUS * ((taken.motor.zero or 0.0) - EDGE), taken.seconds


def main() -> None:
    """Print a row for each make and stiffness."""
    print(machine())
    print(
        "| servo | cable [N/m] | range of six [mm] | mean error [mm] | time [s] | refused |\n|---|---|---|---|---|---|"
    )
    for name in sys.argv[1:] or MAKES:
        for stiff in STIFF:
            found, refused = [], 0
            for seed in range(6):
                try:
                    found.append(find_zero(*MAKES[name], stiff, seed))
                except HydrostatError as error:
                    refused += 1
                    print(error, file=sys.stderr)
            errors, seconds = np.array(found).T
            row = f"{1e3 * np.ptp(errors):.2f} | {1e3 * errors.mean():.2f} | {seconds.mean():.0f}"
            print(f"| {name} | {stiff:.0f} | {row} | {refused} |", flush=True)


if __name__ == "__main__":
    began = time.process_time()
    main()
    print(f"{time.process_time() - began:.0f} s of CPU")
