"""Winches that are not there: emulated servos that pull at springs, on a link."""

from collections.abc import Sequence

import numpy as np

from hydrostat.control.bus_link import BusLink
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.dynamixel_bus import DynamixelBus
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo
from hydrostat.control.feetech_bus import FeetechBus
from hydrostat.control.guard import TensionGuard
from hydrostat.robot import Winch

NAMES = ("index flexor", "index extensor", "thumb")
RADIUS, CONSTANT, SPRING = 0.008, 0.35, 200.0  # [m], [N m/A], of what each cable pulls at [N/m]
CURRENT = 0.3  # of the motors, at most [A]


def tensions(contractions: np.ndarray) -> np.ndarray:
    """What a spring pulls with [N]."""
    return SPRING * np.maximum(contractions, 0.0)


class Rig:
    """A link to three emulated winches, and what has happened to them."""

    def __init__(self, *, models: tuple[int, ...] = (1200, 1220, 1060), guarded: bool = True) -> None:
        def load(angle: float) -> float:
            return RADIUS * SPRING * max(RADIUS * (angle - 1.0), 0.0)

        if models[0] == 777:
            self.servos = [EmulatedSts(n + 1, angle=1.0, load=load, constant=CONSTANT) for n in range(3)]
            self.chain = EmulatedFeetechChain(self.servos)
            bus = FeetechBus
        else:
            self.servos = [
                EmulatedServo(n + 1, model=model, angle=1.0, load=load, constant=CONSTANT)
                for n, model in enumerate(models)
            ]
            self.chain, bus = EmulatedChain(self.servos), DynamixelBus
        self.log = list[str]()
        self.bus = bus(self.chain, [1, 2, 3], clock=self.chain.clock, wait=self.chain.wait)
        winches = [Winch(name=name, at=(0.0, 0.0), spool_radius=RADIUS, travel=0.04, release=0.002) for name in NAMES]
        spools = [
            WinchMotor(winch=name, number=n + 1, zero=1.0, radius=RADIUS, current=CURRENT)
            for n, name in enumerate(NAMES)
        ]
        guard = TensionGuard(tensions, np.full(3, CONSTANT), NAMES) if guarded else None
        self.link = BusLink(
            self.bus,
            winches,
            Calibration(tuple(spools)),
            guard=guard,
            log=self.log.append,
            clock=self.chain.clock,
        )

    def begin(self) -> None:
        """Identify and arm."""
        self.link.identify()
        self.link.arm()

    def go(self, goal: object, seconds: float, *, speed: float = 0.05) -> np.ndarray:
        """Tell a goal [m] 50 times a second; returns where the link says that they are."""
        end, places = self.chain.now + seconds, np.zeros(3)
        goal = np.broadcast_to(np.asarray(goal, dtype=float), 3)
        while self.chain.now < end:
            begin = self.chain.now
            self.link.send(goal, begin, speed=speed)
            places = self.link.read(begin)
            self.chain.wait(max(0.0, 0.02 - (self.chain.now - begin)))
        return places

    @property
    def places(self) -> np.ndarray:
        """Where they are in truth [m]."""
        return np.array([RADIUS * (servo.angle - 1.0) for servo in self.servos])


def together(chains: Sequence[EmulatedChain]) -> None:
    """Let lines live in the same time: what passes on one passes on all."""
    waits = [chain.wait for chain in chains]

    def wait(seconds: float) -> None:
        for each in waits:
            each(seconds)

    for chain in chains:
        chain.wait = wait  # type: ignore[method-assign]
