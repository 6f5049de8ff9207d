"""Faults injected into one or more of several boards, joined as one bus."""

from dataclasses import replace

import numpy as np
from emulated_board import BoardMotor, EmulatedBoard
from emulation import CONSTANT, CURRENT, RADIUS, SPRING, together
from fault_campaign import HIGH, LOW, STANDS, WORDS, Campaign, Noise

from hydrostat.control.bus_link import BusLink, LinkState
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.dynamixel_bus import DynamixelBus
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_servos import Ails, EmulatedChain, EmulatedServo
from hydrostat.control.feetech_bus import FeetechBus
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.control.guard import TensionGuard
from hydrostat.control.joined_bus import JoinedBus
from hydrostat.errors import HydrostatError
from hydrostat.robot import Winch

ZERO = 4.0  # angle of servos with nothing taken in, so that a turn ends on their way [rad]
COUNTS = 2000.0
KINDS = ("dynamixel", "feetech", "firmware")
HARMS = ("deaf", "mute", "stuck", "hot", "anew", "unplugged")
TOLD = WORDS | {
    "mute": ("has not answered",),
    "stuck": (*WORDS["stuck"], "stall"),
    "anew": (*WORDS["anew"], "switched off or reset", "has not answered"),
}


def load(angle: float) -> float:
    """Torque of a spring from the zero on [N m]."""
    return RADIUS * SPRING * max(RADIUS * (angle - ZERO), 0.0)


class Boards:
    """A link to emulated motors on several lines of one kind, in a random order of their winches."""

    def __init__(self, random: np.random.Generator, kind: str) -> None:
        counts = random.integers(1, 4, int(random.integers(2, 5))).tolist()
        self.kind, self.count = kind, sum(counts)
        order = random.permutation(self.count).tolist()
        self.chains, self.lines, parts = list[EmulatedChain](), list[list[int]](), []
        for count in counts:
            self.lines.append([order.pop() for _ in range(count)])
            self.chains.append(self._line(random, count))
        together(self.chains)
        self.chain = self.chains[0]
        for chain, places in zip(self.chains, self.lines, strict=True):
            parts.append((self._bus(chain, random), places))
        found = {place: (board, n) for board, each in enumerate(self.lines, 1) for n, place in enumerate(each, 1)}
        self.servos = [self.chains[found[place][0] - 1].servos[found[place][1] - 1] for place in range(self.count)]
        first = Winch(name="0", at=(0.0, 0.0), spool_radius=RADIUS, travel=HIGH, release=-LOW)
        winches = [replace(first, name=f"winch {place}") for place in range(self.count)]
        zero = 0.0 if kind == "firmware" else ZERO
        spools = [
            WinchMotor(winch=w.name, board=found[n][0], number=found[n][1], zero=zero, radius=RADIUS, current=CURRENT)
            for n, w in enumerate(winches)
        ]
        names = tuple(winch.name for winch in winches)
        constant = np.nan if kind == "firmware" else CONSTANT
        guard = TensionGuard(lambda taken: SPRING * np.maximum(taken, 0.0), np.full(self.count, constant), names)
        self.bus = JoinedBus(parts)
        self.link = BusLink(self.bus, winches, Calibration(tuple(spools)), guard=guard, clock=self.chain.clock)

    def begin(self) -> None:
        """Identify and arm."""
        self.bus.identify()
        self.bus.mark()
        self.link.identify()
        self.link.arm()

    def go(self, goal: np.ndarray, seconds: float, *, speed: float) -> None:
        """Tell a goal [m] 50 times a second."""
        end = self.chain.now + seconds
        while self.chain.now < end:
            begin = self.chain.now
            self.link.send(goal[: self.count], begin, speed=speed)
            self.link.read(begin)
            self.chain.wait(max(0.0, 0.02 - (self.chain.now - begin)))

    @property
    def places(self) -> np.ndarray:
        """Where they are in truth [m]."""
        return np.array([RADIUS * (servo.angle - ZERO) for servo in self.servos])

    def harm(self, kind: str, board: int, random: np.random.Generator) -> None:
        """Do something to a board, or to one motor on it."""
        chain = self.chains[board]
        servo = chain.servos[int(random.integers(len(chain.servos)))]
        if kind == "unplugged":
            chain.gone = True
        elif isinstance(chain, EmulatedBoard):
            if kind == "anew":
                chain.begin_anew()
            elif kind == "stuck":
                servo.ails = Ails(stuck=True)
            else:
                chain.deaf = True
        elif kind == "anew":
            servo.begin_anew()
        else:
            for each in chain.servos if kind == "mute" else [servo]:
                kept = each.ails.deaf_watchdog
                each.ails = Ails(**{"deaf" if kind == "mute" else kind: True, "deaf_watchdog": kept})

    def heal(self) -> None:
        """All that can be heard again is: what was forgotten stays forgotten."""
        for chain in self.chains:
            chain.gone = chain.deaf = False  # type: ignore[attr-defined]
            for servo in chain.servos:
                servo.ails = Ails(deaf_watchdog=servo.ails.deaf_watchdog)

    def _line(self, random: np.random.Generator, count: int) -> EmulatedChain:
        if self.kind == "firmware":
            scale = COUNTS / (2 * np.pi * RADIUS)
            limits = {"low": round(scale * (LOW - 3e-4)), "high": round(scale * (HIGH + 3e-4))}
            each = {"angle": ZERO, "load": load, "constant": CONSTANT, "counts": COUNTS} | limits
            return EmulatedBoard([BoardMotor(**each) for _ in range(count)])
        if self.kind == "feetech":
            return EmulatedFeetechChain(
                [EmulatedSts(n, angle=ZERO, load=load, constant=CONSTANT) for n in range(1, count + 1)]
            )
        models = random.choice([1200, 1220, 1060], count).tolist()
        return EmulatedChain(
            [
                EmulatedServo(n, model=model, angle=ZERO, load=load, constant=CONSTANT)
                for n, model in enumerate(models, 1)
            ]
        )

    def _bus(self, chain: EmulatedChain, random: np.random.Generator) -> DynamixelBus | FeetechBus | FirmwareBus:
        times = {"clock": chain.clock, "wait": chain.wait}
        numbers = list(range(1, len(chain.servos) + 1))
        if self.kind == "firmware":
            return FirmwareBus(chain, [COUNTS] * len(numbers), numbers, **times)
        return (FeetechBus if self.kind == "feetech" else DynamixelBus)(chain, numbers, **times)


class BoardsCampaign(Campaign):
    """The same with several boards: noise on all their lines, then something hard for one or more of them."""

    def rig(self) -> Boards:  # type: ignore[override]
        """Motors of a run."""
        return Boards(self.random, str(self.random.choice(KINDS, p=(0.4, 0.2, 0.4))))

    def noises(self, rig: Boards) -> list[Noise]:  # type: ignore[override]
        """Noise on all lines; less on those of boards, which a single bad line stops."""
        found = list[Noise]()
        for chain in rig.chains:
            chain.STEP = 4e-3
            chain.towards, chain.back = (
                Noise(self.random, self.share / 5 if rig.kind == "firmware" else self.share) for _ in range(2)
            )
            chain.watch = lambda: self._watch(rig)  # type: ignore[arg-type]
            found += [chain.towards, chain.back]
        return found

    def quiet(self, rig: Boards) -> None:  # type: ignore[override]
        """No noise any more."""
        for chain in rig.chains:
            chain.towards = chain.back = lambda data: data

    def goal(self, rig: Boards) -> np.ndarray:  # type: ignore[override]
        """Where to go, sometimes beyond the limits [m]."""
        return self.random.uniform(-0.01, 0.05, rig.count)

    zero = ZERO

    def _settle(self, rig: Boards) -> None:  # type: ignore[override]
        """What noise has left behind is over: a watchdog that has fired is told after half a second."""
        for attempt in range(5):
            if rig.link.state is LinkState.ARMED:
                words = self._drive(rig, 0.8)  # type: ignore[arg-type]
                if not words:
                    return
                if attempt:
                    self.wrong[f"{rig.kind}: without cause: {words}"] += 1
            self._again(rig)  # type: ignore[arg-type]

    def _hard(self, rig: Boards) -> None:  # type: ignore[override]
        self._settle(rig)  # type: ignore[arg-type]
        random, last, words = self.random, rig.chain.now, ""
        if rig.link.state is not LinkState.ARMED:
            self.wrong[f"{rig.kind}: not armed without noise: {rig.link.why}"] += 1
        kind = str(random.choice([*HARMS, "host dies", "host sleeps"], p=[0.14] * 6 + [0.08] * 2))
        harmed = dict[int, str]()
        if kind in HARMS:
            for board in random.permutation(len(rig.chains))[: int(random.integers(1, len(rig.chains) + 1))].tolist():
                harmed[board] = str(random.choice(HARMS)) if harmed else kind
                rig.harm(harmed[board], board, random)
        self.count.update(harmed.values() if harmed else [kind])
        if kind == "host sleeps":
            rig.chain.wait(float(random.uniform(0.3, 2.0)))
        if kind != "host dies":
            for _ in range(12):
                last = rig.chain.now
                words = self._drive(rig, 0.25)  # type: ignore[arg-type]
                if words:
                    break
            if not self._named(words, harmed, rig.kind) and not (kind == "host sleeps" and TOLD[kind][0] in words):
                self.wrong[f"{rig.kind}: {harmed or kind}: told as {words!r}"] += 1
        rig.chain.wait(STANDS)
        before = rig.places
        rig.chain.wait(0.5)
        if np.abs(rig.places - before).max() > 1e-6:
            self.wrong[f"still turning {rig.chain.now - last - 0.5:.2f} s after the last command, {kind}"] += 1
        self._once_more(rig)

    def _named(self, words: str, harmed: dict[int, str], kind: str) -> bool:
        """Whether words name a board that was harmed, and what was done to it."""
        for board, harm in harmed.items():
            told = TOLD["mute" if kind == "firmware" and harm in ("deaf", "hot") else harm]
            if f"board {board + 1}" in words and any(each in words for each in told):
                return True
        return False

    def _once_more(self, rig: Boards) -> None:
        """A person who arms them anew, come what may: nothing may leave its limits by that."""
        rig.heal()
        self._again(rig)  # type: ignore[arg-type]
        if rig.link.state is LinkState.ARMED:
            self._drive(rig, 1.0)  # type: ignore[arg-type]
        try:
            rig.link.close()
        except HydrostatError:
            self.wrong["raised on closing"] += 1
