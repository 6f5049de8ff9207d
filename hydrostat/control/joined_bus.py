"""`JoinedBus`: motors on several lines as one bus."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TypeVar

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.bus import Bus, MotorFacts, Reading
from hydrostat.errors import HydrostatError

_Item = TypeVar("_Item")


class JoinedBus(Bus):
    """Motors on several boards or lines, in the order of the winches.

    Each part keeps its own watchdog. What one part raises is raised by the whole, with the number of its board, and a
    `BusLink` then stops all.
    """

    def __init__(self, parts: Sequence[tuple[Bus, Sequence[int]]]) -> None:
        """Buses, each with the places of its motors in the whole; all places once."""
        self._parts = [(bus, np.asarray(places)) for bus, places in parts]
        self._count = sum(len(places) for _, places in self._parts)
        self.kind = parts[0][0].kind  # type: ignore[misc]  # that of its parts

    @property
    def lost_position(self) -> bool:  # type: ignore[override]
        """True if motors of any part have lost their turn count."""
        return any(bus.lost_position for bus, _ in self._parts)

    @property
    def silence(self) -> float:  # type: ignore[override]
        """Shortest of its parts [s]."""
        return min(bus.silence for bus, _ in self._parts)

    def identify(self) -> tuple[MotorFacts, ...]:
        """Facts of the motors of all parts; each part tries its own watchdogs."""
        return self._whole(self._each(lambda bus, _: bus.identify()))

    def mark(self, zeros: Vector | None = None) -> None:
        """Let each part remember that its motors are calibrated."""
        self._each(lambda bus, places: bus.mark(None if zeros is None else zeros[places]))

    def arm(self, currents: Vector) -> None:
        """Switch torque on in all parts, one after the other; all stop if one does not take it."""
        try:
            self._each(lambda bus, places: bus.arm(currents[places]))
            self.restart_watchdog()  # those of the first may have fired while the last were armed
        except BaseException:
            self.stop()
            raise

    def restart_watchdog(self) -> None:
        """Let the watchdogs of all parts begin again."""
        self._each(lambda bus, _: bus.restart_watchdog())

    def find_restarted(self) -> tuple[int, ...]:
        """Return the places of motors of all parts whose torque is off."""
        return tuple(int(places[index]) for bus, places in self._parts for index in bus.find_restarted())

    def restart(self, place: int) -> None:
        """Restart a motor of one part."""
        for bus, places in self._parts:
            if place in places:
                bus.restart(places.tolist().index(place))

    def read(self) -> Reading:
        """Return the latest reading of all motors."""
        told = self._each(lambda bus, _: bus.read())

        def join_readings(name: str) -> Vector:
            return np.array(self._whole([getattr(reading, name) for reading in told]))

        return Reading(
            angles=join_readings("angles"),
            currents=join_readings("currents"),
            temperatures=join_readings("temperatures"),
            volts=join_readings("volts"),
            stamps=join_readings("stamps"),
            faults=self._whole([reading.faults for reading in told]),
        )

    def write(self, angles: Vector, speeds: Vector) -> None:
        """Send goals and speeds to all parts."""
        self._each(lambda bus, places: bus.write(angles[places], speeds[places]))

    def halt(self) -> None:
        """Send a stop to all parts once."""
        for bus, _ in self._parts:
            with suppress(Exception):
                bus.halt()

    def stop(self) -> None:
        """Let the motors of all parts stand: a line that does not answer keeps no other waiting."""
        self.halt()
        for bus, _ in self._parts:
            with suppress(Exception):
                bus.stop()

    def close(self) -> None:
        """Stop all, then let their lines go."""
        self.stop()
        for bus, _ in self._parts:
            with suppress(Exception):
                bus.close()

    def _each(self, ask: Callable[[Bus, np.ndarray], _Item]) -> list[_Item]:
        """Answers of all parts, each asked with the places of its motors; errors carry the number of the part."""
        told = []
        for number, (bus, places) in enumerate(self._parts, 1):
            try:
                told.append(ask(bus, places))
            except HydrostatError as error:
                raise HydrostatError(f"board {number}: {error}") from None
        return told

    def _whole(self, told: Sequence[Sequence[_Item]]) -> tuple[_Item, ...]:
        """Items that the parts report of their motors, in the order of the whole bus."""
        found: dict[int, _Item] = {}
        for (_, places), items in zip(self._parts, told, strict=True):
            found |= zip(places.tolist(), items, strict=True)
        return tuple(found[place] for place in range(self._count))
