"""Faults injected into one or more of several boards, joined as one bus."""

from dataclasses import replace
from typing import Any

import numpy as np
from emulated_board import BoardMotor, EmulatedBoard
from emulation import CONSTANT, CURRENT, RADIUS, cut, jam, let_pull, spring_guard, together
from fault_campaign import GUARDED, HIGH, LOW, WORDS, Campaign, Noise

from hydrostat.control.bus_link import BusLink, LinkState
from hydrostat.control.calibration import Calibration, WinchMotor
from hydrostat.control.dynamixel_bus import MODELS, DynamixelBus
from hydrostat.control.emulated_feetech import EmulatedFeetechChain, EmulatedSts
from hydrostat.control.emulated_servos import EmulatedChain, EmulatedServo, InjectedFaults
from hydrostat.control.feetech_bus import FeetechBus
from hydrostat.control.firmware_bus import FirmwareBus
from hydrostat.control.joined_bus import JoinedBus
from hydrostat.errors import HydrostatError
from hydrostat.robot import Winch

ZERO = 4.0  # angle of servos with nothing taken in, so that a turn ends on their way [rad]
COUNTS = 2000.0
KINDS = ("dynamixel", "feetech", "firmware")
HARMS = ("deaf", "mute", "stuck", "hot", "again", "unplugged", *GUARDED)
TOLD = WORDS | {"mute": ("has not answered",), "again": (*WORDS["again"], "switched off or reset", "has not answered")}
FIRMWARE = TOLD | {"deaf": TOLD["mute"], "hot": TOLD["mute"], "stuck": ("stall",)}  # a board is heard as a whole


class Boards:
    """A link to emulated motors on several lines of one kind, in a random order of their winches."""

    def __init__(self, random: np.random.Generator, kind: str) -> None:
        counts = random.integers(1, 4, int(random.integers(2, 5))).tolist()
        self.commanded, self.grace = 0.0, 0.06 if kind == "firmware" else 0.0  # a board stops after 50 ms of too much
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
        self.bus, calibration = JoinedBus(parts), Calibration(tuple(spools))
        self._names = calibration.labels
        self.link = BusLink(self.bus, winches, calibration, clock=self.chain.clock)

    def pull(self, reaches: list[float]) -> None:
        """Let springs pull, as hard as the bounds of currents at their reaches [m]."""
        self.reaches = np.array(reaches)
        let_pull(self.servos, reaches, ZERO)

    def begin(self) -> None:
        """Identify, guard and arm."""
        self.bus.identify()
        self.bus.mark()
        facts = self.link.identify()
        self.guarded = bool(np.isfinite([fact.constant for fact in facts]).all())
        self.link.guard = spring_guard(facts, self.servos, self.reaches, self._names)
        self.link.arm()

    def go(self, goal: np.ndarray, seconds: float, *, speed: float) -> None:
        """Tell a goal [m] 50 times a second."""
        end = self.chain.now + seconds
        while self.chain.now < end:
            begin = self.chain.now
            self.link.send(goal, begin, speed=speed)
            self.commanded = begin
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
        elif kind in GUARDED:
            (cut if kind == "cut" else jam)(servo)
        elif isinstance(chain, EmulatedBoard):
            if kind == "again":
                chain.begin_anew()
            elif kind == "stuck":
                servo.ails = InjectedFaults(stuck=True)
            else:
                chain.deaf = True
        elif kind == "again":
            servo.begin_anew()
        else:
            for each in chain.servos if kind == "mute" else [servo]:
                kept = each.ails.deaf_watchdog
                each.ails = InjectedFaults(**{"deaf" if kind == "mute" else kind: True, "deaf_watchdog": kept})

    def heal(self) -> None:
        """All that can be heard again is: what was forgotten stays forgotten."""
        for chain in self.chains:
            chain.gone = chain.deaf = False  # type: ignore[attr-defined]
            for servo in chain.servos:
                servo.ails = InjectedFaults(deaf_watchdog=servo.ails.deaf_watchdog)

    def _line(self, random: np.random.Generator, count: int) -> EmulatedChain:
        if self.kind == "firmware":
            scale = COUNTS / (2 * np.pi * RADIUS)
            limits = {"low": round(scale * (LOW - 3e-4)), "high": round(scale * (HIGH + 3e-4))}
            each: dict[str, Any] = {"angle": ZERO, "constant": CONSTANT, "counts": COUNTS} | limits
            return EmulatedBoard([BoardMotor(**each) for _ in range(count)])
        if self.kind == "feetech":
            return EmulatedFeetechChain([EmulatedSts(n, angle=ZERO, constant=CONSTANT) for n in range(1, count + 1)])
        models = random.choice([1200, 1220, 1060], count).tolist()
        return EmulatedChain(
            [
                EmulatedServo(n, model=model, angle=ZERO, constant=MODELS[model].torque / MODELS[model].stall)
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
        rig = Boards(self.random, str(self.random.choice(KINDS, p=(0.4, 0.2, 0.4))))
        rig.pull(self.reaches(rig.count))
        return rig

    def noises(self, rig: Boards) -> list[Noise]:  # type: ignore[override]
        """Noise on all lines; less on those of boards, which a single bad line stops."""
        found = list[Noise]()
        for chain in rig.chains:
            chain.STEP = 4e-3
            chain.towards, chain.back = (
                Noise(self.random, self.share / 5 if rig.kind == "firmware" else self.share) for _ in range(2)
            )
            found += [chain.towards, chain.back]
        return found

    def quiet(self, rig: Boards) -> None:  # type: ignore[override]
        """No noise any more."""
        for chain in rig.chains:
            chain.towards = chain.back = lambda data: data

    zero = ZERO

    def _settle(self, rig: Boards) -> None:  # type: ignore[override]
        """What noise has left behind is over: a watchdog that has fired is told after half a second."""
        for attempt in range(5):
            if rig.link.state is LinkState.ARMED:
                goal = self.within(rig)  # type: ignore[arg-type]
                near = np.abs(goal - rig.places) < 3e-3  # a motor that stands at its goal hides that it does not move
                goal += np.where(near, np.where(goal > HIGH / 4, -6e-3, 6e-3), 0.0)
                words = self._drive(rig, 0.8, goal)  # type: ignore[arg-type]
                if not words:
                    return
                if attempt:
                    self.wrong[f"{rig.kind}: without cause: {words}"] += 1
            self._again(rig)  # type: ignore[arg-type]

    def _hard(self, rig: Boards) -> None:  # type: ignore[override]
        self._settle(rig)  # type: ignore[arg-type]
        random = self.random
        if rig.link.state is not LinkState.ARMED:
            self.wrong[f"{rig.kind}: not armed without noise: {rig.link.why}"] += 1
        harms = [harm for harm in HARMS if rig.guarded or harm not in GUARDED]
        kind = str(random.choice([*harms, "host dies", "host sleeps"]))
        harmed = dict[int, str]()
        if kind in HARMS:
            for board in random.permutation(len(rig.chains))[: int(random.integers(1, len(rig.chains) + 1))].tolist():
                harmed[board] = str(random.choice(harms)) if harmed else kind
        if "jammed" in harmed.values():  # where the springs themselves pull little
            self._drive(rig, 1.2, self.within(rig, 0.2, 0.25))  # type: ignore[arg-type]
        self.late, kinds = 0.0, list(harmed.values()) or [kind]
        for board, harm in harmed.items():
            rig.harm(harm, board, random)
        self.count.update(kinds)
        words = self._words(rig, kinds)  # type: ignore[arg-type]
        if not (self._named(words, harmed, rig) if harmed else TOLD[kind][0] in words):
            self.wrong[f"{rig.kind}: {harmed or kind}: told as {words!r}"] += 1
        self._stand(rig, kind)  # type: ignore[arg-type]
        self._once_more(rig)

    def _named(self, words: str, harmed: dict[int, str], rig: Boards) -> bool:
        """Whether words name a board that was harmed, and what was done to it."""
        told = FIRMWARE if rig.kind == "firmware" else TOLD
        for board, harm in harmed.items():
            if f"board {board + 1}" in words and any(each in words for each in told[harm]):
                return True
        return False

    def _once_more(self, rig: Boards) -> None:
        """A person who arms them again, come what may: nothing may leave its limits by that."""
        rig.heal()
        self._again(rig)  # type: ignore[arg-type]
        if rig.link.state is LinkState.ARMED:
            self._drive(rig, 1.0, np.minimum(0.9 * rig.reaches, 0.05))  # type: ignore[arg-type]
        try:
            rig.link.close()
        except HydrostatError:
            self.wrong["raised on closing"] += 1
