"""`Motors`: commanded and measured contractions of the winches."""

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control.link import WATCHDOG_TIMEOUT, Link
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import Winch
from hydrostat.simulation import ProfileTable

LEVER = 1e-3 * math.degrees(1.0)
"""Spool radius [m] at which a degree of a drive that turns counts as a millimeter of a winch."""


@dataclass(frozen=True, kw_only=True)
class DriveAxis(Winch):
    """Motor of a drive of pins, as a winch without cables.

    Attributes:
        turns: True if it turns its pins: its meters are the angle [rad] times `LEVER`.
    """

    turns: bool


DEFAULT_MAX_SPEED = 0.15
"""Default speed limit of the cables [m/s]: fast for a small motor, and direct under a knob."""
SPEEDS = (1e-3, 1.0)  # slowest and fastest that motors may be told to turn [m/s]
CONTRACTION_TOLERANCE = 1e-7  # contractions this close [m] are the same


class Motors:
    """Winches of a robot behind a link: commands stay within their limits, and on any error or silence the motors hold.

    Use it from one thread at a time: call `drive` repeatedly while motors may move, and `hold` when they must not.

    Attributes:
        names: winch names.
        units: unit of each winch in messages: mm, or deg for a rotary drive (one millimeter for each degree).
        low: least contraction of each winch [m]; below 0 it pays out.
        high: largest contraction of each winch [m].
        command: commanded contractions [m].
        places: contractions at the last reading [m].
        fastest: maximum speed of the cables [m/s].
        link: link to the motors.
        command_timeout: time between two calls of `drive` after which motors hold [s].
        clock: monotonic clock for `drive` [s].
    """

    def __init__(
        self,
        winches: Sequence[Winch],
        link: Link,
        *,
        places: Vector | None = None,
        fastest: float = DEFAULT_MAX_SPEED,
        command_timeout: float = WATCHDOG_TIMEOUT,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Motors that stand still where they are [m], at 0 if that is left out.

        The timeout is infinite where gaps are usual, and the watch of the link itself is enough [s].
        """
        self.names = tuple(winch.name for winch in winches)
        self.units = tuple("deg" if isinstance(winch, DriveAxis) and winch.turns else "mm" for winch in winches)
        self.low = np.array([-winch.release for winch in winches], dtype=float)
        self.high = np.array([winch.travel for winch in winches], dtype=float)
        self.places = np.zeros(len(winches)) if places is None else places.copy()
        self.command = self._within(self.places)
        self.link, self.fastest, self.command_timeout = link, fastest, command_timeout
        self.clock = clock
        self._driven: float | None = None

    @property
    def is_moving(self) -> bool:
        """True if the motors have not yet reached their command."""
        return bool(np.abs(self.places - self.command).max(initial=0.0) > self.link.near)

    def set_fastest(self, speed: float) -> None:
        """Set the maximum cable speed [m/s] (InputError: too slow or too fast)."""
        if not SPEEDS[0] <= speed <= SPEEDS[1]:
            low, high = 1e3 * SPEEDS[0], 1e3 * SPEEDS[1]
            raise InputError(f"motors may turn from {low:g} to {high:g} mm/s, not {1e3 * speed:g}")
        self.fastest = speed

    def check(self, table: ProfileTable, *, speed: float = 1.0) -> None:
        """Reject a table that these motors cannot play at a multiple of its own speed.

        The InputError names the line and the column that exceeds the limits of its winch or is too fast.
        """
        times, values = table.profile.times, table.profile.values
        if times[0] < 0:
            raise InputError(f"{table.place(0)}, column time_s: times count from 0 s, not from {times[0]:g}")
        for row, winch in np.argwhere(
            (values < self.low - CONTRACTION_TOLERANCE) | (values > self.high + CONTRACTION_TOLERANCE)
        ).tolist():
            low, high, unit = 1e3 * self.low[winch] + 0.0, 1e3 * self.high[winch], self.units[winch]
            raise InputError(
                f"{table.place(row)}, column {self.names[winch]}: {1e3 * values[row, winch]:g} {unit} is "
                f"beyond what the winch can take in, {low:g} to {high:g} {unit}"
            )
        speeds = speed * np.abs(np.diff(values, axis=0)) / np.diff(times)[:, None]
        for row, winch in np.argwhere(speeds > self.fastest * (1 + 1e-6)).tolist():
            unit = self.units[winch]
            slower = math.floor(100 * speed * self.fastest / speeds.max()) / 100
            raise InputError(
                f"{table.place(row + 1)}, column {self.names[winch]}: moves at {1e3 * speeds[row, winch]:.4g} "
                f"{unit}/s, the motors at {1e3 * self.fastest:g} {unit}/s at most; play it at {slower:g} times its "
                "speed or slower"
            )

    def ask(self, contractions: Vector) -> str:
        """Command contractions [m] within limits; return those beyond (InputError: not finite; command unchanged)."""
        self.command = self._within(contractions)
        beyond = np.abs(contractions - self.command)
        if beyond.max(initial=0.0) <= CONTRACTION_TOLERANCE:
            return ""
        index = int(beyond.argmax())
        limit, wanted = 1e3 * self.command[index], 1e3 * contractions[index]
        unit = self.units[index]
        return f"{self.names[index]} is at its limit of {limit:.1f} {unit} and was asked for {wanted:.1f} {unit}"

    def turn(self, name: str, contraction: float) -> None:
        """Command one winch [m], within its limits (InputError: not a finite number; command unchanged)."""
        command = self.command.copy()
        command[self.names.index(name)] = contraction
        self.command = self._within(command)

    def drive(self, now: float, *, look: bool = True) -> bool:
        """Send the command, read the motors by a monotonic clock [s]; return True if any moved.

        Reading all motors of a line takes milliseconds: with `look=False` the command is sent without a reading.

        Raises:
            HydrostatError: an error of the link, or no `drive` for too long; the motors hold until the next request.
        """
        before = self.places
        try:
            gap = 0.0 if self._driven is None else now - self._driven
            if gap > self.command_timeout:
                silence = f"told nothing for {gap:.1f} s, longer than {self.command_timeout:g} s"
                raise HydrostatError(f"this computer is late: the motors were {silence}, and hold; begin again")
            self.link.send(self.command, now, speed=self.fastest)
            if look:
                self.places = self._read(now)
            self._driven = now
        except BaseException:
            self.hold()
            raise
        return bool(np.abs(self.places - before).max(initial=0.0) > CONTRACTION_TOLERANCE)

    def hold(self) -> None:
        """Stop the motors at their present positions."""
        with suppress(Exception):
            self.link.stop()
        self.command, self._driven = self.places.copy(), None

    def _read(self, now: float) -> Vector:
        """Contractions [m] that the link has read; one that is no number is an error of the motors."""
        places = self.link.read(now)
        if places.shape != self.command.shape or not np.isfinite(places).all():
            raise HydrostatError("the motors do not tell where each of them is; look at their wires, then begin again")
        return places

    def _within(self, contractions: Vector) -> Vector:
        for name, value in zip(self.names, contractions, strict=True):
            if not np.isfinite(value):
                raise InputError(f"{name}: the contraction must be a finite number")
        return np.clip(contractions, self.low, self.high)
