"""`FirmwareBus`: motors on an Arduino that runs our own firmware (`firmware/winches.c`)."""

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import ClassVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, MotorFacts, Port, Reading, steady
from hydrostat.errors import HydrostatError

PROOF = 0.05  # current at which the watchdog is tried [A]
STOPS = {
    "current": "overloaded: too much current, stopped by its board",
    "stall": "stalled: it does not follow its goal",
    "encoder": "encoder fault. Check its plug and cable, then calibrate again",
    "beyond": "beyond its limits. Calibrate again",
    "heat": "too hot, stopped by its board",
    "unheard": "silent or without its bound of torque. Check its power and cable",
    "restarted": "lost power and restarted: its torque is off. Check its plug and cable",
}
"""Stops of a board in words that `restart_motors` knows; other stops are words already."""
REFUSALS = {
    "supply": "the motors' supply was too low. Charge or feed it, then reset the board",
    "servo": "servo {} does not answer the board. Check its power, its cable and its number",
    "model": "servo {} is of another model than the board was built for. Run hydrostat firmware with its --motor",
    "mode": "servo {} is not in position mode. Set its register of the mode to 0",
    "memory": "servo {} allows no supply: its registers of greatest and least voltage are reversed",
    "range": "servo {} turns less than its winch. Set its limits of angle to 0 and 0, of an SCS0009 to 0 and 1023",
    "voltage": "servo {} measures a supply that it is not for. Switch the power off and read its label",
    "fault": "servo {} is hot, overloaded or out of its supply. Free its cable and let it cool",
}
"""Reasons for which a board arms no motor, with the number of the servo."""
ANEW = "it was switched off or reset, and its motors count again; calibrate them again"


class FirmwareBus(Bus):
    """Motors of one board, numbered from 1 in the order of its settings.

    The board measures how much a motor draws; which way it pulls follows from power and speed, as `winches.c` has it.
    How much torque that is nobody knows, since gears rub as hard as soft cables pull. What the board refuses is told
    with the next reading, as a fault of all its motors.
    """

    kind: ClassVar[str] = "firmware"

    def __init__(
        self,
        port: Port,
        counts: Sequence[float],
        numbers: Sequence[int] = (),
        *,
        robot: str = "",
        clock: Callable[[], float] = steady,
        wait: Callable[[float], None] = time.sleep,
        answer: float = 0.05,
    ) -> None:
        """A board on a port.

        Args:
            port: an open serial line, at 250,000 baud.
            counts: encoder counts per spool turn of each motor.
            numbers: motor numbers on the board, each once from 1 on; default in order.
            robot: identity in the settings of the board's firmware; default any.
            clock: monotonic clock [s].
            wait: lets so much time pass [s].
            answer: longest time for an answer [s].
        """
        self._port, self._clock, self._wait, self._answer = port, clock, wait, answer
        self._scale = np.asarray(counts, dtype=np.float64) / (2 * np.pi)  # counts by radian
        self._order = np.argsort(numbers) if numbers else np.arange(len(self._scale))  # motors as the board has them
        self._lock, self._number, self._heard, self._refused = threading.RLock(), 0, b"", ""
        self._known = self._closed = False
        self._bounds = ""  # of the currents of armed motors; empty where none are
        self._stood = True  # whether they were told to stand since they were armed
        self._robot, self.lost_position = robot, False
        nothing = np.full(len(self._scale), np.nan)
        self._last = Reading(
            angles=nothing,
            currents=nothing,
            temperatures=nothing,
            volts=nothing,
            stamps=np.full(len(self._scale), -np.inf),
            faults=("",) * len(self._scale),
        )

    def identify(self) -> tuple[MotorFacts, ...]:
        """Facts of the board's motors, torque off; its deadline is tried by a moment of silence."""
        with self._lock:
            told = self._surely("I").split()
            if told[:2] != ["ok", "hydrostat"] or len(told) < 7:
                raise HydrostatError("what answers on this port is not hydrostat's firmware; flash it first")
            if self._robot not in ("", told[4]):
                raise HydrostatError(
                    f"the board was built for {told[4]}, not for {self._robot} as it is now; "
                    "write it again by `hydrostat firmware`, or mind the order of the ports"
                )
            if int(told[5]) != len(self._scale):
                raise HydrostatError(f"the board was built for {told[5]} motors, and {len(self._scale)} are asked for")
            self.lost_position, self._bounds = told[-1] == "new", ""
            proved = self._stops_by_itself(1e-3 * float(told[6]))
            self._must("O", "to let go")
            self._known = True
            facts = {"model": f"{told[3]} ({told[4]})", "firmware": int(told[2]), "watchdog": proved}
            return tuple(MotorFacts(number=slot + 1, **facts) for slot in np.argsort(self._order).tolist())

    def mark(self, zeros: Vector | None = None) -> None:
        """Let the board remember, until its power goes, that the zeros of its motors are known, and where they are."""
        told = [] if zeros is None else np.rint(zeros * self._scale)[self._order].astype(int).tolist()
        with self._lock:
            self._must(" ".join(["M", *map(str, told)]), "that it is calibrated")
            self.lost_position = False

    def arm(self, currents: Vector) -> None:
        """Switch torque on where they stand; the board refuses more current than its settings allow."""
        with self._lock:
            marked = self._surely("I").endswith(" marked")  # numbers of lines begin again with this one
            self._see_that_it_counts_on(marked)
            bounds = " ".join(str(max(1, round(1e3 * most))) for most in currents[self._order].tolist())
            self._must(f"A {bounds}", "its bounds of current")
            self._bounds, self._stood = bounds, False

    def restart_watchdog(self) -> None:
        """Arm them once more where they stand, if the board has stopped them for silence meanwhile."""
        with self._lock:
            self._must(f"A {self._bounds}", "its bounds of current")

    def read(self) -> Reading:
        """Return the latest reading of each motor."""
        with self._lock:
            told = (self._ask("R") or "").split()
            end = 3 + 2 * len(self._scale)
            if len(told) in (end, end + 1) and told[0] == "ok":  # with a divider, millivolts of the supply come last
                slots = np.argsort(self._order)
                numbers = np.array(told[3:end], dtype=np.float64).reshape(-1, 2)[slots]
                volts = 1e-3 * float(told[end]) if told[end:] else np.nan
                faults = [f"refused: {self._refused}" if self._refused else ""] * len(self._scale)
                stopped = told[1] not in ("armed", "off") and not self._stood  # who stands falls silent, too
                if stopped:
                    why = "supply voltage too low" if told[1] == "supply" else f"board stopped: {told[1]}"
                    faults = [why] * len(faults)
                if stopped and told[2] != "0":  # whose fault it was, so that no other one is named
                    faults = [""] * len(faults)
                    faults[int(self._order[int(told[2]) - 1])] = STOPS.get(told[1], told[1])
                if told[1] == "off" and self._bounds:
                    self.lost_position, faults = True, [f"board: {ANEW}"] * len(faults)
                self._refused = ""
                self._last = Reading(
                    angles=numbers[:, 0] / self._scale,
                    currents=1e-3 * numbers[:, 1],
                    temperatures=self._last.temperatures,
                    volts=np.full(len(self._scale), volts),
                    stamps=np.full(len(self._scale), self._clock()),
                    faults=tuple(faults),
                )
            return self._last

    def write(self, angles: Vector, speeds: Vector) -> None:
        """Send goals and speeds; the answer is looked at with the next reading."""
        goals, rates = np.rint(angles * self._scale), np.maximum(1, np.rint(np.abs(speeds) * self._scale))
        pairs = np.stack([goals, rates], axis=1)[self._order].astype(int).tolist()
        with self._lock:
            self._send("G " + " ".join(f"{goal} {rate}" for goal, rate in pairs))

    def stop(self) -> None:
        """Stop them, with the command sent three times."""
        with suppress(Exception), self._lock:
            if self._known and not self._closed:
                self._stood = True
                for _ in range(3):
                    self._send("S")

    def close(self) -> None:
        """Stop; they hold until the power is off."""
        with self._lock:  # nobody tells it anything between the two
            self.stop()
            self._closed = True
            with suppress(Exception):
                self._port.close()

    def _see_that_it_counts_on(self, marked: bool) -> None:
        """Raise that the board was reset since it was identified, as it begins to count at 0 then, wherever it is."""
        off = self._bounds and (self._ask("R") or "").startswith("ok off ")
        if off or (not marked and not self.lost_position):
            self.lost_position = True
            raise HydrostatError(f"the board does not arm its motors: {ANEW}")

    def _stops_by_itself(self, deadline: float) -> bool:
        """True if the board, armed at its present position, reports that silence stopped it."""
        self._must("A" + f" {round(1e3 * PROOF)}" * len(self._scale), "a small current")
        self._wait(deadline + 0.05)
        return (self._ask("R") or "").startswith("ok silent ")

    def _must(self, words: str, name: str) -> None:
        told = self._surely(words)
        no, _, rest = told.partition(" ")
        word, _, number = rest.partition(" ")
        if no == "no" and word in REFUSALS:
            raise HydrostatError(REFUSALS[word].format(number))
        if told != "ok":
            raise HydrostatError(f"the board did not take {name}; it says: {told}")

    def _surely(self, words: str) -> str:
        """The answer to a line, asked up to three times (HydrostatError: none); earlier refusals no longer count."""
        for _ in range(3):
            if (told := self._ask(words)) is not None:
                self._refused = ""
                return told
        raise HydrostatError("the board does not answer; look at its power, its cable and the baud rate, 250000")

    def _send(self, words: str) -> int:
        self._number = (self._number + 1) % 256
        try:
            self._port.write(line_of(f"{self._number} {words}"))
        except (OSError, ValueError, TypeError) as error:
            raise HydrostatError(f"the line to the motors is gone ({error}); plug it in and begin again") from None
        return self._number

    def _ask(self, words: str) -> str | None:
        """The answer to a line, None after the time."""
        number, until = self._send(words), self._clock() + self._answer
        left = self._answer
        while True:
            while b"\n" in self._heard:
                text, _, self._heard = self._heard.partition(b"\n")
                told = text.decode("ascii", "replace").rpartition("*")[0]
                if line_of(told) != text + b"\n":
                    continue
                mark, _, rest = told.partition(" ")
                if mark == str(number):
                    return rest
                if rest.startswith("no "):
                    self._refused = rest[3:]
            if left <= 0:
                return None
            left, late = until - self._clock(), 5e-3  # from so many seconds on the computer was held up
            if -late < left <= 0:
                return None
            self._port.timeout = max(left, 0.0)  # 0: a late computer reads what has come
            try:
                self._heard += self._port.read(1) + self._port.read(getattr(self._port, "in_waiting", 0))
            except (OSError, ValueError, TypeError) as error:
                raise HydrostatError(f"the line to the motors is gone ({error}); plug it in and begin again") from None


def line_of(text: str) -> bytes:
    """A line of the firmware's, with its checksum: CRC-16 of Modbus."""
    check = 0xFFFF
    for byte in text.encode():
        check ^= byte
        for _ in range(8):
            check = check >> 1 ^ (0xA001 if check & 1 else 0)
    return f"{text}*{check:04X}\n".encode()
