"""`EmulatedLine`: emulated servos at the other end of a pseudo-terminal, in real time, for whatever opens its path."""

import os
import select
import threading
import time
from contextlib import suppress
from typing import Self

from hydrostat.control.emulated_servos import EmulatedChain


class EmulatedLine:
    """A serial line with emulated servos that a program of its own may open; nothing turns but numbers.

    Attributes:
        chain: the servos.
        path: what to open in place of a serial port.
        moved: when each servo last moved, by the time of the chain [s].
    """

    def __init__(self, chain: EmulatedChain) -> None:
        """A line that is open until it is closed (OSError: no pseudo-terminals here)."""
        import tty

        self.chain, self._over = chain, threading.Event()
        self._inner, self._outer = os.openpty()
        tty.setraw(self._outer)
        self.path = os.ttyname(self._outer)
        self.moved = [0.0] * len(chain.servos)
        self._angles = [servo.angle for servo in chain.servos]
        chain.watch = self._look
        self._thread = threading.Thread(target=self._run, name="emulated servos", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        """Give the line itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()

    def unplug(self) -> None:
        """Pull the cable out: the servos keep their power."""
        for end in (self._outer, self._inner):
            with suppress(OSError):
                os.close(end)

    def close(self) -> None:
        """End it."""
        self._over.set()
        self._thread.join(5.0)
        self.unplug()

    def _look(self) -> None:
        for index, servo in enumerate(self.chain.servos):
            if servo.angle != self._angles[index]:
                self._angles[index], self.moved[index] = servo.angle, self.chain.now

    def _run(self) -> None:
        begin, plugged = time.monotonic() - self.chain.now, True
        while not self._over.is_set():
            try:
                if plugged and select.select([self._inner], [], [], 0.002)[0]:
                    self.chain.write(os.read(self._inner, 4096))
                    while waiting := self.chain.in_waiting:
                        os.write(self._inner, self.chain.read(waiting))
            except (OSError, ValueError):
                plugged = False
            if not plugged:
                self._over.wait(0.002)
            self.chain.wait(max(0.0, time.monotonic() - begin - self.chain.now))
