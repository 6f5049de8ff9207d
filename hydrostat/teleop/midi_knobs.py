"""`MidiKnobs`: a robot driven by the knobs or faders of a MIDI controller."""

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish

USUAL = 1
"""Controller number of the first knob unless told otherwise."""
LOOK = 1.0
"""Interval between checks that the port still exists [s]."""


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
            channels: what they turn.
            name: part of the name of the port; any port if it is empty.
            first: controller number of the knob of the first channel; the others follow.
            port: an open port of mido, in place of a name.
            clock: that only runs forward [s].

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
        try:
            messages = list(self._port.iter_pending())
            gone = self._port.closed or (self._named and now - self._looked > LOOK and not self._there(now))
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
        raise HydrostatError('MIDI needs mido and python-rtmidi: pip install "hydrostat[teleop]"') from None
    except Exception as error:  # noqa: BLE001 (each system of sound has errors of its own)
        raise HydrostatError(f"MIDI is not to be had here: {error}") from None
    found = [each for each in names if name.lower() in each.lower()]
    if not found:
        raise HydrostatError(f'unknown MIDI port "{name}". Available: {", ".join(names) or "none"}.')
    return mido.open_input(found[0])  # type: ignore[attr-defined]
