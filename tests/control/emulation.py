"""Winches that are not there: emulated servos that pull at springs, on a link."""

from collections.abc import Callable, Sequence

import numpy as np

from hydrostat.control.bus import MotorFacts
from hydrostat.control.bus_link import BusLink
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.dynamixel_bus import MODELS, DynamixelBus
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo
from hydrostat.control.feetech_bus import FeetechBus
from hydrostat.control.guard import TensionGuard
from hydrostat.robot import Winch

NAMES = ("index flexor", "index extensor", "thumb")
RADIUS, CONSTANT = 0.008, 0.35  # [m], of motors that do not tell theirs [N m/A]
CURRENT = 0.3  # of the motors, at most [A]
REACH = 0.065  # contraction at which the spring of a cable pulls as hard as that current does [m]


def let_pull(servos: Sequence[EmulatedServo], reaches: Sequence[float], zero: float) -> None:
    """Let springs pull at servos from an angle on [rad], each as hard as the bound of its current at its reach [m]."""

    def spring(servo: EmulatedServo, reach: float) -> Callable[[float], float]:
        return lambda angle: CURRENT * servo.constant * max(RADIUS * (angle - zero), 0.0) / reach

    for servo, reach in zip(servos, reaches, strict=True):
        servo.load = spring(servo, reach)


def send_goal(link: BusLink, chain: EmulatedChain, goal: float, seconds: float) -> np.ndarray:
    """Tell two winches a goal [m] 50 times a second; returns where the link says that they are."""
    end, places = chain.now + seconds, np.zeros(2)
    while chain.now < end:
        begin = chain.now
        link.send(np.full(2, goal), begin, speed=0.05)
        places = link.read(begin)
        chain.wait(max(0.0, 0.02 - (chain.now - begin)))
    return places


def spring_guard(
    facts: Sequence[MotorFacts], servos: Sequence[EmulatedServo], reaches: np.ndarray, names: tuple[str, ...]
) -> TensionGuard:
    """A guard that knows the springs, and of motors what these told; emulated ones are as they tell."""
    constants = np.array([fact.constant for fact in facts])
    for servo, constant in zip(servos, constants.tolist(), strict=True):
        servo.constant = constant if np.isfinite(constant) else servo.constant
    stiff = np.array([CURRENT * servo.constant for servo in servos]) / (RADIUS * reaches)
    return TensionGuard(lambda taken: stiff * np.maximum(taken, 0.0), constants, names)


def jam(servo: EmulatedServo) -> None:
    """Let something hold a cable from here on: within 2.4 mm it pulls as hard as the bound of its current."""
    before, place = servo.load, servo.angle
    servo.load = lambda angle: before(angle) + CURRENT * servo.constant * max(angle - place, 0.0) / 0.3


def cut(servo: EmulatedServo) -> None:
    """Let nothing pull at a servo any more."""
    servo.load = lambda _: 0.0


class Rig:
    """A link to three emulated winches, and what has happened to them."""

    grace = 0.0  # for which a motor may pull harder than the bound of its current [s]

    def __init__(
        self,
        *,
        models: tuple[int, ...] = (1200, 1220, 1060),
        guarded: bool = True,
        reaches: Sequence[float] = (REACH, REACH, REACH),
    ) -> None:
        if models[0] == 777:
            self.servos = [EmulatedSts(n + 1, angle=1.0, constant=CONSTANT) for n in range(3)]
            self.chain = EmulatedFeetechChain(self.servos)
            bus = FeetechBus
        else:
            self.servos = [
                EmulatedServo(n + 1, model=model, angle=1.0, constant=MODELS[model].torque / MODELS[model].stall)
                for n, model in enumerate(models)
            ]
            self.chain, bus = EmulatedChain(self.servos), DynamixelBus
        let_pull(self.servos, reaches, 1.0)
        self.reaches, self.commanded, self._guarded = np.asarray(reaches), 0.0, guarded
        self.log = list[str]()
        self.bus = bus(self.chain, [1, 2, 3], clock=self.chain.clock, wait=self.chain.wait)
        winches = [Winch(name=name, at=(0.0, 0.0), spool_radius=RADIUS, travel=0.04, release=0.002) for name in NAMES]
        spools = [
            WinchMotor(winch=name, number=n + 1, zero=1.0, radius=RADIUS, current=CURRENT)
            for n, name in enumerate(NAMES)
        ]
        self.link = BusLink(
            self.bus,
            winches,
            Calibration(tuple(spools)),
            log=self.log.append,
            clock=self.chain.clock,
        )

    def begin(self) -> None:
        """Identify, guard and arm."""
        facts = self.link.identify()
        self.link.guard = spring_guard(facts, self.servos, self.reaches, NAMES) if self._guarded else None
        self.link.arm()

    def go(self, goal: object, seconds: float, *, speed: float = 0.05) -> np.ndarray:
        """Tell a goal [m] 50 times a second; returns where the link says that they are."""
        end, places = self.chain.now + seconds, np.zeros(3)
        goal = np.broadcast_to(np.asarray(goal, dtype=float), 3)
        while self.chain.now < end:
            begin = self.chain.now
            self.link.send(goal, begin, speed=speed)
            self.commanded = begin
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
