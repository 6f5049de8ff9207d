"""`Osc`: a robot driven by messages of Open Sound Control, as phones, Max, Pure Data and scripts send them."""

import socket
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from math import inf, isfinite
from typing import Any

from hydrostat.errors import HydrostatError
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish

HERE, PORT = "127.0.0.1", 9000
"""Only this computer is heard unless told otherwise."""
ALIVE = 0.5
"""Who once said /alive must say something so often [s]."""
_MOST = 500
"""Datagrams that are heard in one look, at most."""


class Osc(DriveSource):
    """Messages over UDP, in millimetres: /winch/index_flexor 12.5, /marker/index 30 -50 120, /hold 1, /rest, /end.

    A word holds until the next, as that of a knob. A program that streams says /alive: from then on its silence of half
    a second makes motors hold.
    """

    def __init__(
        self,
        channels: DriveChannels,
        host: str = HERE,
        port: int = PORT,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Hear a port of an address of this computer (HydrostatError: it is taken, or no python-osc)."""
        try:
            from pythonosc.osc_packet import OscPacket
        except ModuleNotFoundError:
            raise HydrostatError('OSC needs python-osc; install it: pip install "hydrostat[teleop]"') from None
        self._packet: Any = OscPacket
        self._channels, self._clock, self._heard, self._hold, self._wrong = channels, clock, clock(), False, ""
        self._known = {name.replace(" ", "_"): name for name in channels.names}
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise HydrostatError(f"port {port} of {host} cannot be heard ({error}); choose another") from None
        self._socket.setblocking(False)
        self.address = self._socket.getsockname()

    def read(self) -> DriveWish:
        """Return the commands received since the previous read."""
        places, over = dict[str, float](), False
        for _ in range(_MOST):
            try:
                data = self._socket.recv(65536)
            except BlockingIOError:
                break
            except OSError as error:
                raise HydrostatError(f"OSC port lost ({error}); motors holding") from None
            with suppress(Exception):  # what is no OSC is nothing
                for timed in self._packet(data).messages:
                    self._heard = self._clock()
                    over = self._take(timed.message.address, timed.message.params, places) or over
        words = self._wrong or f"hears {self.address[0]}:{self.address[1]}; Ctrl-C: end"
        stamp = self._heard if self.silence < inf else self._clock()
        return DriveWish(stamp=stamp, places=places, hold=self._hold, over=over, words=words)

    def close(self) -> None:
        """Let the port go."""
        with suppress(Exception):
            self._socket.close()

    def _take(self, address: str, values: Sequence[Any], places: dict[str, float]) -> bool:
        """Hear a message; tell whether it ends."""
        kind, _, name = address.strip("/").partition("/")
        if kind == "alive":
            self.silence = ALIVE
        elif kind == "hold":
            self._hold = bool(values[0]) if values else True
        elif kind == "rest":
            places |= dict(zip(self._channels.names, self._channels.rest.tolist(), strict=True))
        elif kind in ("winch", "marker"):
            self._place(kind, name, values, places)
        return kind == "end"

    def _place(self, kind: str, name: str, values: Sequence[Any], places: dict[str, float]) -> None:
        axes = [""] if kind == "winch" else [f"_{axis}" for axis in "xyz"[: len(values)]]
        keys = [self._known.get(name.replace(" ", "_").replace("%20", "_") + axis) for axis in axes]
        numbers = [1e-3 * float(value) for value in values]
        if None in keys or len(numbers) != len(keys) or not all(map(isfinite, numbers)):
            self._wrong = f"/{kind}/{name} with {len(values)} numbers is not understood here"
            return
        self._wrong = ""
        places |= {str(key): number for key, number in zip(keys, numbers, strict=True)}
