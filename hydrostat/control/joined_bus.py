"""`JoinedBus`: motors on several lines as one bus."""

from collections.abc import Sequence
from contextlib import suppress
from typing import TypeVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, MotorFacts, Reading

_Item = TypeVar("_Item")


class JoinedBus(Bus):
    """Motors on several boards or lines, in the order of the winches.

    Each part keeps its own watchdog. What one part raises is raised by the whole, and a `BusLink` then stops all.
    """

    def __init__(self, parts: Sequence[tuple[Bus, Sequence[int]]]) -> None:
        """Buses, each with the places of its motors in the whole; all places once."""
        self._parts = [(bus, np.asarray(places)) for bus, places in parts]
        self._count = sum(len(places) for _, places in self._parts)
        self.kind, self.forgot = parts[0][0].kind, False  # type: ignore[misc]  # that of its parts

    def identify(self) -> tuple[MotorFacts, ...]:
        """Facts of the motors of all parts; each part tries its own watchdogs."""
        told = [bus.identify() for bus, _ in self._parts]
        self.forgot = any(bus.forgot for bus, _ in self._parts)
        return self._whole(told)

    def mark(self) -> None:
        """Let each part remember that its motors are calibrated."""
        for bus, _ in self._parts:
            bus.mark()
        self.forgot = False

    def arm(self, currents: Vector) -> None:
        """Switch torque on in all parts, one after the other; all stop if one does not take it."""
        try:
            for bus, places in self._parts:
                bus.arm(currents[places])
        except BaseException:
            self.stop()
            raise

    def read(self) -> Reading:
        """What was last heard of all motors."""
        told = [bus.read() for bus, _ in self._parts]

        def joined(name: str) -> Vector:
            return np.array(self._whole([getattr(reading, name) for reading in told]))

        return Reading(
            angles=joined("angles"),
            currents=joined("currents"),
            temperatures=joined("temperatures"),
            volts=joined("volts"),
            stamps=joined("stamps"),
            faults=self._whole([reading.faults for reading in told]),
        )

    def write(self, angles: Vector, speeds: Vector) -> None:
        """Send goals and speeds to all parts."""
        for bus, places in self._parts:
            bus.write(angles[places], speeds[places])

    def stop(self) -> None:
        """Let the motors of all parts stand."""
        for bus, _ in self._parts:
            with suppress(Exception):
                bus.stop()

    def close(self) -> None:
        """Stop all, then let their lines go."""
        self.stop()
        for bus, _ in self._parts:
            with suppress(Exception):
                bus.close()

    def _whole(self, told: Sequence[Sequence[_Item]]) -> tuple[_Item, ...]:
        """What the parts tell of their motors, in the order of the whole."""
        found: dict[int, _Item] = {}
        for (_, places), items in zip(self._parts, told, strict=True):
            found |= zip(places.tolist(), items, strict=True)
        return tuple(found[place] for place in range(self._count))
