"""`MidiKnobs`, `Osc`: knobs of a MIDI controller, and messages of Open Sound Control, as sources of drive."""

import socket
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from math import inf, isfinite
from typing import Any

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish
from hydrostat.version import install_command

USUAL = 1
"""Controller number of the first knob unless told otherwise."""


class MidiKnobs(DriveSource):
    """A knob for each channel, which goes where its knob is, from its least to its largest value.

    A knob that was not turned yet asks for nothing.
    """

    def __init__(
        self,
        channels: DriveChannels,
        name: str = "",
        first: int = USUAL,
        *,
        port: Any = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Knobs of a MIDI port.

        Args:
            channels: channels that the messages move.
            name: part of the name of the port; any port if it is empty.
            first: controller number of the knob of the first channel; the others follow.
            port: an open port of mido, in place of a name.
            clock: monotonic clock [s].

        Raises:
            InputError: more channels than controller numbers.
            HydrostatError: no such port, or no mido.
        """
        if not 0 <= first <= 128 - len(channels.names):
            raise InputError(f"--source midi: knobs {first} to {first + len(channels.names) - 1}: MIDI has 0 to 127")
        self._channels, self._first, self._clock = channels, first, clock
        self._named = port is None
        self._port = _open(name) if port is None else port
        self._unknown, self._looked = "", clock()

    def read(self) -> DriveWish:
        """Return the positions of the knobs turned since the previous read."""
        now, places = self._clock(), dict[str, float]()
        look = 1.0  # Interval between checks that the port still exists [s]
        try:
            messages = list(self._port.iter_pending())
            gone = self._port.closed or (self._named and now - self._looked > look and not self._there(now))
        except OSError as error:
            raise HydrostatError(f"MIDI port lost ({error}); motors holding") from None
        if gone:
            raise HydrostatError("MIDI port lost; motors holding")
        for message in messages:
            if message.type == "control_change":
                self._turn(message.control, message.value, places)
        return DriveWish(stamp=now, places=places, words=self._unknown or "Ctrl-C: end")

    def close(self) -> None:
        """Let it go."""
        with suppress(Exception):
            self._port.close()

    def _turn(self, knob: int, value: int, places: dict[str, float]) -> None:
        index = knob - self._first
        if not 0 <= index < len(self._channels.names):
            self._unknown = f"knob {knob} turns nothing; where it is the first: --source midi:NAME@{knob}"
            return
        low, high = float(self._channels.low[index]), float(self._channels.high[index])
        places[self._channels.names[index]] = low + (high - low) * value / 127

    def _there(self, now: float) -> bool:
        import mido

        self._looked = now
        return self._port.name in mido.get_input_names()  # type: ignore[attr-defined]


def _open(name: str) -> Any:
    try:
        import mido

        names = list(mido.get_input_names())  # type: ignore[attr-defined]
    except ModuleNotFoundError:
        words = "" if sys.version_info < (3, 13) else ", then pip install python-rtmidi (needs ALSA headers)"
        raise InputError(f"MIDI needs mido and python-rtmidi: {install_command('teleop')}{words}") from None
    except Exception as error:  # noqa: BLE001 (each system of sound has errors of its own)
        raise HydrostatError(f"MIDI is not to be had here: {error}") from None
    found = [each for each in names if name.lower() in each.lower()]
    if not found:
        raise HydrostatError(f'unknown MIDI port "{name}". Available: {", ".join(names) or "none"}.')
    return mido.open_input(found[0])  # type: ignore[attr-defined]


HERE, PORT = "127.0.0.1", 9000
"""Only this computer is heard unless told otherwise."""


class Osc(DriveSource):
    """Messages over UDP, in millimeters: /winch/index_flexor 12.5, /marker/index 30 -50 120, /hold 1, /rest, /end.

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
            raise InputError(f"OSC needs python-osc; install it: {install_command('teleop')}") from None
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
        most = 500  # Datagrams that are heard in one look, at most
        for _ in range(most):
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
        alive = 0.5  # Who once said /alive must say something so often [s]
        if kind == "alive":
            self.silence = alive
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
