"""Faults injected into emulated motors, and what is watched meanwhile."""

from collections import Counter

import numpy as np
from emulation import CURRENT, NAMES, RADIUS, REACH, Rig, cut, jam

from hydrostat.control.bus_link import RANGE_TOLERANCE, LinkState
from hydrostat.control.emulated_servos import EmulatedChain, InjectedFaults
from hydrostat.errors import HydrostatError

LOW, HIGH = -0.002, 0.04  # limits of the winches [m]
STANDS = 0.25  # [s]
MOVED = 5e-5  # steps of a servo and its rounding are less [m]
BYTES = ("drop", "flip", "double", "delay", "half")
GUARDED = ("cut", "jammed")
"""Only a guard can tell of these, where motors tell the torque of their current."""
HARD = ("deaf", "stuck", "hot", "again", "unplugged", "host dies", "host sleeps", *GUARDED)
WORDS = {
    "deaf": ("has not answered",),
    "stuck": ("does not follow",),
    "hot": ("too hot",),
    "again": ("lost power",),
    "unplugged": ("is gone",),
    "host dies": ("",),
    "host sleeps": ("no command for",),
    "cut": ("slack or broken",),
    "jammed": ("measured tension",),
}
WHOSE = {"deaf", "stuck", "hot", "again", *GUARDED}  # words name the winch


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
        models = (777,) * 3 if feetech else tuple(self.random.choice([1200, 1220, 1060], 3).tolist())
        return Rig(models=models, reaches=self.reaches(3))

    def reaches(self, count: int) -> list[float]:
        """Where the bound of their current holds motors [m]: a third at half of their travel, the others nowhere."""
        return self.random.choice([HIGH / 2, REACH, REACH], count).tolist()

    def run(self) -> None:
        """Let motors run through noise, then one hard fault."""
        self.runs += 1
        rig, random = self.rig(), self.random
        rig.chain.STEP = 4e-3
        for servo in rig.servos:
            servo.ails.deaf_watchdog = bool(random.random() < 0.5)
        rig.begin()
        self._begin_watch(rig)
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
        """Noise on its line."""
        rig.chain.towards, rig.chain.back = noises = [Noise(self.random, self.share) for _ in range(2)]
        return noises

    def quiet(self, rig: Rig) -> None:
        """No noise any more."""
        rig.chain.towards = rig.chain.back = lambda data: data

    def within(self, rig: Rig, low: float = -0.05, high: float = 1.0) -> np.ndarray:
        """Where to go, between shares of what motors can pull [m]."""
        return self.random.uniform(low, high, len(rig.servos)) * np.minimum(0.9 * rig.reaches, HIGH)

    def _drive(self, rig: Rig, seconds: float, goal: np.ndarray | None = None) -> str:
        """Tell goals, sometimes beyond the limits if they are left out; give the words of what ended it."""
        goal = self.random.uniform(-0.01, 0.05, len(rig.servos)) if goal is None else goal
        try:
            rig.go(goal, seconds, speed=float(self.random.uniform(0.01, 0.06)))
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
            if rig.link.state is LinkState.ARMED and not self._drive(rig, 0.3, self.within(rig)):
                break
            self._again(rig)
        self._drive(rig, float(self.random.uniform(0.02, 0.3)), self.within(rig))

    def _hard(self, rig: Rig) -> None:
        guarded = np.isfinite([fact.constant for fact in rig.link.facts]).all()
        kinds = HARD if guarded else [kind for kind in HARD if kind not in GUARDED]
        kind, index = kinds[self.random.integers(len(kinds))], int(self.random.integers(3))
        servo = rig.servos[index]
        self._settle(rig)
        if kind == "jammed":  # where the spring itself pulls little
            self._drive(rig, 1.2, self.within(rig, 0.2, 0.25))
        self.count[kind] += 1
        self.late = 0.0
        if kind in ("deaf", "stuck", "hot"):
            servo.ails = InjectedFaults(**{kind: True, "deaf_watchdog": servo.ails.deaf_watchdog})
        elif kind == "again":
            servo.begin_anew()
        elif kind == "unplugged":
            rig.chain.gone = True
        elif kind in GUARDED:
            (cut if kind == "cut" else jam)(servo)
        words = self._words(rig, [kind])
        named = kind not in WHOSE or NAMES[index] in words
        if not (named and any(word in words for word in WORDS[kind])):
            self.wrong[f"{kind}: told as {words!r}"] += 1
        self._stand(rig, kind)

    def _words(self, rig: Rig, kinds: list[str]) -> str:
        """Goals that motors are far from, one after another, until something is told of what has gone wrong."""
        if "host dies" in kinds:
            return ""
        if "host sleeps" in kinds:
            rig.chain.wait(float(self.random.uniform(0.3, 2.0)))
        low = 0.5 if set(kinds) & set(GUARDED) else -0.05  # there springs pull
        for _ in range(12):
            if words := self._drive(rig, 0.25, self.within(rig, low)):
                return words
        return ""

    def _stand(self, rig: Rig, kind: str) -> None:
        """See that all have stood from 250 ms after the last goal on."""
        rig.chain.wait(STANDS + 0.5)
        if self.late > STANDS:
            self.wrong[f"still turning {self.late:.2f} s after the last command, {kind}"] += 1

    zero = 1.0  # angle of motors with nothing taken in [rad]
    late = 0.0  # longest from the last goal to a motion since something went wrong [s]

    def _begin_watch(self, rig: Rig) -> None:
        """Look at each motor at each step, by the time of its own line."""
        self._places, self._weak = dict[int, float](), dict[int, float]()
        for chain in getattr(rig, "chains", [rig.chain]):
            chain.watch = lambda chain=chain: self._watch(rig, chain)

    def _watch(self, rig: Rig, chain: EmulatedChain) -> None:
        for servo in chain.servos:
            place, key = RADIUS * (servo.angle - self.zero), id(servo)
            if not LOW - RANGE_TOLERANCE <= place <= HIGH + RANGE_TOLERANCE:
                self.wrong["beyond limits"] += 1
            if abs(place - self._places.setdefault(key, place)) > MOVED:
                self._places[key], self.late = place, max(self.late, chain.now - rig.commanded)
            if servo.speed <= 0 or servo.torque <= 1.05 * CURRENT * servo.constant:
                self._weak[key] = chain.now
            elif chain.now - self._weak.get(key, -np.inf) > rig.grace:
                self.wrong["pulls too hard"] += 1

    def told(self) -> list[str]:
        """What was injected, and what was wrong."""
        lines = [f"{self.injected:,} faults in {self.runs:,} runs: " + _listed(self.count)]
        return [*lines, f"wrong: {_listed(self.wrong) or 'nothing'}"]


def _listed(count: Counter[str]) -> str:
    return ", ".join(f"{name} {number:,}" for name, number in sorted(count.items()))
