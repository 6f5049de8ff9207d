"""`Keys`: a robot driven from the keyboard of a terminal."""

import os
import select
import sys
import time
from collections.abc import Callable
from contextlib import suppress

from hydrostat.errors import HydrostatError
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish

HELP = "tab next; arrows out, in; Shift+A, D further; r rest; space hold; q end"
_ARROWS = {b"\x1b[A": "w", b"\x1b[B": "s", b"\x1b[C": "d", b"\x1b[D": "a", b"\x1b[5~": "D", b"\x1b[6~": "A"}
_BACK = b"\x1b[Z"


class Keys(DriveSource):
    """Keys of a terminal; nothing moves but by a press, so silence is no danger.

    Tab and digits choose a winch or marker; left and right let it out and take it in. Of a marker left and right are
    its x, up and down its z (y in the plane), and < and > its y. Space holds, r rests, q ends.
    """

    def __init__(
        self, channels: DriveChannels, *, file: int | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Keys of a terminal that is open already, the standard input if left out (HydrostatError: it is none)."""
        self._channels, self._file, self._clock = channels, sys.stdin.fileno() if file is None else file, clock
        self._chosen, self._hold, self._before = 0, False, None
        try:
            import termios
            import tty

            self._before = termios.tcgetattr(self._file)
            tty.setcbreak(self._file, termios.TCSANOW)
        except Exception:  # noqa: BLE001 (no such module on Windows, and errors of its own elsewhere)
            raise HydrostatError("--source keys needs a terminal (of Linux or macOS); choose another source") from None

    def read(self) -> DriveWish:
        """Return the commands of the keys pressed since the previous read."""
        steps, places, over = dict[str, float](), dict[str, float](), False
        for key in self._pressed_keys():
            if key == "q":
                over = True
            elif key == " ":
                self._hold = not self._hold
            elif key in ("\t", "backtab"):
                self._chosen = (self._chosen + (1 if key == "\t" else -1)) % len(self._channels.groups)
            elif key.isdigit():
                self._chosen = min((int(key) - 1) % 10, len(self._channels.groups) - 1)
            elif key == "r":
                places, steps = dict(zip(self._channels.names, self._channels.rest.tolist(), strict=True)), {}
            elif (move := self._move(key)) is not None:
                steps[move[0]] = steps.get(move[0], 0.0) + move[1]
        words = f"{self._channels.title(self._chosen)}; {HELP}"
        return DriveWish(stamp=self._clock(), steps=steps, places=places, hold=self._hold, over=over, words=words)

    def close(self) -> None:
        """Give the terminal back as it was."""
        with suppress(Exception):
            import termios

            termios.tcsetattr(self._file, termios.TCSADRAIN, self._before or [])

    def _move(self, key: str) -> tuple[str, float] | None:
        """Channel that a key moves, and how far [m]."""
        group = self._channels.groups[self._chosen]
        last = len(group) - 1
        ways = {"a": (0, -1), "d": (0, 1), "s": (last, -1), "w": (last, 1), "<": (min(1, last), -1)}
        ways |= {">": (min(1, last), 1)}
        if key.lower() not in ways:
            return None
        which, sign = ways[key.lower()]
        # Step of a channel per key press [m], and with a capital letter or page up and down [m]
        fine, coarse = 0.5e-3, 3e-3
        return self._channels.names[group[which]], sign * (coarse if key.isupper() else fine)

    def _pressed_keys(self) -> list[str]:
        data = b""
        while select.select([self._file], [], [], 0.0)[0]:
            try:
                more = os.read(self._file, 1024)
            except OSError:
                more = b""
            if not more:
                raise HydrostatError("terminal closed; motors holding")
            data += more
        keys = []
        while data:
            known = next((code for code in (*_ARROWS, _BACK) if data.startswith(code)), data[:1])
            keys.append(_ARROWS.get(known, "backtab" if known == _BACK else known.decode("latin-1")))
            data = data[len(known) :]
        return keys
