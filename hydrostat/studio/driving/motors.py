"""`Motors`: what the winches shall take in, and what they have."""

from contextlib import suppress

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.studio.driving.link import Link
from hydrostat.studio.driving.simulated_link import FASTEST, SimulatedLink

SPEEDS = (1e-3, 1.0)
"""Slowest and fastest that simulated motors may be [m/s]."""

NEAR = 1e-7
"""Contractions this close [m] are the same."""


class Motors:
    """The winches of the open robot behind a link; no command leaves their limits.

    Attributes:
        names: of the winches.
        command: what each shall take in [m].
        places: what each had taken in when it was last read [m].
        fastest: largest speed of their cables, while they are simulated [m/s].
        link: that turns them.
    """

    def __init__(self) -> None:
        self.names: tuple[str, ...] = ()
        self.command = self.places = np.zeros(0)
        self.fastest = FASTEST
        self.link: Link = SimulatedLink(self.places)
        self._robot: Robot | None = None
        self._low = self._high = np.zeros(0)

    @property
    def moving(self) -> bool:
        """Whether they are not yet where they shall be."""
        return bool(np.abs(self.places - self.command).max(initial=0.0) > NEAR)

    def meet(self, robot: Robot) -> bool:
        """The robot may be another one: winches of the same name keep what they have taken in. Whether it is."""
        if robot is self._robot:
            return False
        known = dict(zip(self.names, self.places.tolist(), strict=True))
        wanted = dict(zip(self.names, self.command.tolist(), strict=True))
        names = tuple(winch.name for winch in robot.winches)
        self._robot = robot
        self._low = np.array([-winch.release for winch in robot.winches], dtype=float)
        self._high = np.array([winch.travel for winch in robot.winches], dtype=float)
        if names != self.names:
            self.link.close()
            self.names = names
            self.places = self._within(np.array([known.get(name, 0.0) for name in names], dtype=float))
            self.link = SimulatedLink(self.places, speed=self.fastest)
        self.command = self._within(np.array([wanted.get(name, 0.0) for name in names], dtype=float))
        return True

    def set_fastest(self, speed: float) -> None:
        """Let simulated motors be so fast [m/s].

        Raises:
            InputError: that is too slow or too fast.
        """
        if not SPEEDS[0] <= speed <= SPEEDS[1]:
            low, high = 1e3 * SPEEDS[0], 1e3 * SPEEDS[1]
            raise InputError(f"motors may turn from {low:g} to {high:g} mm/s, not {1e3 * speed:g}")
        self.fastest = speed
        if isinstance(self.link, SimulatedLink):
            self.link.speed = speed

    def ask(self, contractions: Vector) -> str:
        """Command as much of these contractions [m] as the winches can; says which cannot, "" if all can."""
        self.command = self._within(contractions)
        beyond = np.abs(contractions - self.command)
        if beyond.max(initial=0.0) <= NEAR:
            return ""
        index = int(beyond.argmax())
        limit, wanted = 1e3 * self.command[index], 1e3 * contractions[index]
        return f"{self.names[index]} is at its limit of {limit:.1f} mm and was asked for {wanted:.1f} mm"

    def turn(self, name: str, contraction: float) -> None:
        """Command one winch [m], within its limits."""
        command = self.command.copy()
        command[self.names.index(name)] = contraction
        self.command = self._within(command)

    def drive(self, now: float) -> bool:
        """Send the command and read where they are; whether any has moved. After any error they must `hold`.

        Raises:
            HydrostatError: of the link.
        """
        before = self.places
        self.link.send(self.command, now)
        self.places = self.link.read(now)
        return bool(np.abs(self.places - before).max(initial=0.0) > NEAR)

    def hold(self) -> None:
        """Stop where they are."""
        with suppress(Exception):
            self.link.stop()
        self.command = self.places.copy()

    def _within(self, contractions: Vector) -> Vector:
        return np.clip(contractions, self._low, self._high)
