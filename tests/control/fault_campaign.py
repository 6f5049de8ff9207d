"""Faults injected into emulated motors, and what is watched meanwhile."""

from collections import Counter

import numpy as np
from emulation import CONSTANT, CURRENT, RADIUS, Rig

from hydrostat.control.bus_link import BEYOND, LinkState
from hydrostat.control.emulated_servos import Ails
from hydrostat.errors import HydrostatError

LOW, HIGH = -0.002, 0.04  # limits of the winches [m]
STANDS = 0.25  # [s]
BYTES = ("drop", "flip", "double", "delay", "half")
HARD = ("deaf", "stuck", "hot", "anew", "unplugged", "host dies", "host sleeps")
WORDS = {
    "deaf": ("has not answered",),
    "stuck": ("does not follow", "pulls by", "slack or broken"),
    "hot": ("too hot",),
    "anew": ("has lost its power", "does not follow", "slack or broken", "beyond its limits"),
    "unplugged": ("is gone",),
    "host dies": ("",),
    "host sleeps": ("nothing was told for",),
}


class Noise:
    """A line on which some packets are damaged."""

    def __init__(self, random: np.random.Generator, share: float) -> None:
        self.random, self.share, self.count, self.kept = random, share, Counter[str](), b""

    def __call__(self, data: bytes) -> bytes:
        data, self.kept = self.kept + data, b""
        if not data or self.random.random() > self.share:
            return data
        kind = BYTES[self.random.integers(len(BYTES))]
        self.count[kind] += 1
        place = int(self.random.integers(len(data)))
        if kind == "drop":
            return data[:place] + data[place + 1 :]
        if kind == "flip":
            return data[:place] + bytes([data[place] ^ (1 << int(self.random.integers(8)))]) + data[place + 1 :]
        if kind == "double":
            return data + data
        if kind == "delay":
            self.kept = data
            return b""
        return data[:place]


class Campaign:
    """Runs, each with damaged bytes and at last one hard fault; what should never be is counted."""

    def __init__(self, random: np.random.Generator, *, seconds: float = 3.0, share: float = 0.15) -> None:
        self.random, self.seconds, self.share = random, seconds, share
        self.count, self.wrong, self.runs = Counter[str](), Counter[str](), 0

    @property
    def injected(self) -> int:
        """Faults so far."""
        return sum(self.count.values())

    def rig(self) -> Rig:
        """Motors of a run."""
        feetech = self.random.random() < 0.3
        return Rig(models=(777,) * 3 if feetech else tuple(self.random.choice([1200, 1220, 1060], 3).tolist()))

    def run(self) -> None:
        """Let motors run through noise, then one hard fault."""
        self.runs += 1
        rig, random = self.rig(), self.random
        rig.chain.STEP = 4e-3
        for servo in rig.servos:
            servo.ails.deaf_watchdog = bool(random.random() < 0.5)
        rig.begin()
        noises = self.noises(rig)
        end = rig.chain.now + self.seconds
        while rig.chain.now < end:
            self._drive(rig, min(0.4, end - rig.chain.now))
            if rig.link.state is not LinkState.ARMED:
                self._again(rig)
        self.quiet(rig)
        for noise in noises:
            self.count.update(noise.count)
        self._hard(rig)

    def noises(self, rig: Rig) -> list[Noise]:
        """Noise on its line, and a look at it at each step."""
        rig.chain.towards, rig.chain.back = noises = [Noise(self.random, self.share) for _ in range(2)]
        rig.chain.watch = lambda: self._watch(rig)
        return noises

    def quiet(self, rig: Rig) -> None:
        """No noise any more."""
        rig.chain.towards = rig.chain.back = lambda data: data

    def goal(self, rig: Rig) -> np.ndarray:
        """Where to go, sometimes beyond the limits [m]."""
        del rig
        return self.random.uniform(-0.01, 0.05, 3)

    def _drive(self, rig: Rig, seconds: float) -> str:
        """Tell goals; give the words of what ended it."""
        try:
            rig.go(self.goal(rig), seconds, speed=float(self.random.uniform(0.01, 0.06)))
        except HydrostatError as error:
            return str(error)
        return ""

    def _again(self, rig: Rig) -> None:
        for _ in range(5):
            try:
                rig.link.arm()
            except HydrostatError:
                rig.chain.wait(0.05)
                continue
            return

    def _settle(self, rig: Rig) -> None:
        """What noise has left behind is over before something else goes wrong."""
        for _ in range(5):
            if rig.link.state is LinkState.ARMED and not self._drive(rig, 0.3):
                break
            self._again(rig)
        self._drive(rig, float(self.random.uniform(0.02, 0.3)))

    def _hard(self, rig: Rig) -> None:
        kind, servo = HARD[self.random.integers(len(HARD))], rig.servos[int(self.random.integers(3))]
        self._settle(rig)
        self.count[kind] += 1
        words, last = "", rig.chain.now
        if kind in ("deaf", "stuck", "hot"):
            servo.ails = Ails(**{kind: True, "deaf_watchdog": servo.ails.deaf_watchdog})
        elif kind == "anew":
            servo.begin_anew()
        elif kind == "unplugged":
            rig.chain.gone = True
        if kind == "host sleeps":
            rig.chain.wait(float(self.random.uniform(0.3, 2.0)))
        if kind != "host dies":
            for _ in range(12):  # goals that motors are far from, one after another
                last = rig.chain.now
                words = words or self._drive(rig, 0.25)
                if words:
                    break
            if not any(word in words for word in WORDS[kind]):
                self.wrong[f"{kind}: told as {words!r}"] += 1
        rig.chain.wait(STANDS)
        before = rig.places
        rig.chain.wait(0.5)
        if np.abs(rig.places - before).max() > 1e-6:
            self.wrong[f"still turning {rig.chain.now - last - 0.5:.2f} s after the last command, {kind}"] += 1

    zero = 1.0  # angle of motors with nothing taken in [rad]

    def _watch(self, rig: Rig) -> None:
        for servo in rig.servos:
            if not LOW - BEYOND <= RADIUS * (servo.angle - self.zero) <= HIGH + BEYOND:
                self.wrong["beyond limits"] += 1
            if servo.speed > 0 and servo.torque > 1.05 * CURRENT * CONSTANT:
                self.wrong["pulls too hard"] += 1

    def told(self) -> list[str]:
        """What was injected, and what was wrong."""
        lines = [f"{self.injected:,} faults in {self.runs:,} runs: " + _listed(self.count)]
        return [*lines, f"wrong: {_listed(self.wrong) or 'nothing'}"]


def _listed(count: Counter[str]) -> str:
    return ", ".join(f"{name} {number:,}" for name, number in sorted(count.items()))
