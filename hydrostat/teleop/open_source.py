"""`open_source`, `open_hand`: what drives a robot, by words such as keys, midi:nano@16 or glove:/dev/ttyUSB0."""

import time
from collections.abc import Callable, Mapping
from pathlib import Path

from hydrostat.control import EMULATED, open_line
from hydrostat.errors import InputError
from hydrostat.teleop.camera_hand import MODEL, CameraHand, HandLandmarks
from hydrostat.teleop.cyber_glove import BAUD, CyberGlove, EmulatedPerson
from hydrostat.teleop.gamepad import Gamepad
from hydrostat.teleop.hand_map import HandMap
from hydrostat.teleop.keys import Keys
from hydrostat.teleop.mapped_hand import USUAL_SMOOTHING, MappedHand, Smoothing
from hydrostat.teleop.midi_osc import HERE, PORT, USUAL, MidiKnobs, Osc
from hydrostat.teleop.source import DriveChannels, DriveSource, HandReading, HandSource


def open_source(
    text: str,
    channels: DriveChannels,
    known: HandMap | None = None,
    person: "EmulatedHand | None" = None,
    *,
    smoothing: Smoothing | None = USUAL_SMOOTHING,
) -> DriveSource:
    """Open the input source that drives a robot.

    Args:
        text: KIND or KIND:PLACE, with a kind of `SOURCES`.
        channels: channels that the source may move.
        known: map of a hand; required for gloves and cameras.
        person: hand in an emulated glove.
        smoothing: smoothing of hand readings; None for none.

    Raises:
        InputError: an unknown kind, or an invalid place.
        HydrostatError: the device or its package is missing.
    """
    kind, _, place = text.partition(":")
    if kind not in (*SOURCES, *HANDS):
        raise InputError(f"--source {text}: unknown source. Available: {', '.join(SHOWN)}.")
    if kind not in HANDS:
        return SOURCES[kind](place, channels)
    if known is None:
        raise InputError(f"--source {text}: needs --map FILE; `hydrostat mimic` makes it")
    return MappedHand(channels, open_hand(place if kind == "glove" else text, person), known, smoothing=smoothing)


def open_hand(text: str, person: "EmulatedHand | None" = None) -> HandSource:
    """Open a glove or a camera.

    Args:
        text: serial port of a glove; camera:FILE.task for the first camera, with @1 for the second; camera:PORT for
            landmarks from another program; or emulated.
        person: hand in an emulated glove.

    Raises:
        InputError: an invalid port, or a missing file.
        HydrostatError: the device cannot be opened, or its package is missing.
    """
    kind, _, place = text.partition(":")
    if kind == "camera" and not place.isdecimal():
        path, at, number = place.rpartition("@") if "@" in place else (place, "", "")
        if not path.endswith(".task"):
            raise InputError(f"{text}: a camera needs MediaPipe's model file, camera:{MODEL}, or a port, camera:9001")
        return CameraHand(Path(path), _number(number, text) if at else 0)
    if kind == "camera":
        return HandLandmarks(_number(place, text))
    if text == EMULATED and person is not None:
        return person
    if not text or text == EMULATED:
        raise InputError("a glove needs its port, such as glove:/dev/ttyUSB0, or glove:emulated")
    return CyberGlove(open_line(text, BAUD))


class EmulatedHand(HandSource):
    """Emulated hand in an emulated glove: it closes and opens by itself, or mimics given contractions."""

    names = CyberGlove.names

    def __init__(self, channels: DriveChannels, clock: Callable[[], float] = time.monotonic) -> None:
        """A hand like that of a robot with these winches."""
        self.person, self._clock, self._begin = EmulatedPerson(channels.low, channels.high), clock, clock()
        self._glove, self.waves = CyberGlove(self.person.glove, clock=clock), True

    def read(self) -> HandReading:
        """Return the glove's reading, 90 times a second as a real glove would."""
        if self.waves:
            self.person.wave(self._clock() - self._begin)
        time.sleep(1 / 90)
        return self._glove.read()

    def close(self) -> None:
        """Close the glove."""
        self._glove.close()


def _keys(place: str, channels: DriveChannels) -> DriveSource:
    if place:
        raise InputError("--source keys: has no place; write keys")
    return Keys(channels)


def _gamepad(place: str, channels: DriveChannels) -> DriveSource:
    return Gamepad(channels, _number(place or "0", f"gamepad:{place}"))


def _midi(place: str, channels: DriveChannels) -> DriveSource:
    name, at, first = place.rpartition("@") if "@" in place else (place, "", "")
    return MidiKnobs(channels, name, _number(first, f"midi:{place}") if at else USUAL)


def _osc(place: str, channels: DriveChannels) -> DriveSource:
    host, _, port = place.rpartition(":")
    return Osc(channels, host or HERE, _number(port or str(PORT), f"osc:{place}"))


def _number(text: str, whole: str) -> int:
    if not text.isascii() or not text.isdecimal() or int(text) > 65535:
        raise InputError(f"--source {whole}: must end with a number, such as {', '.join(SHOWN)}")
    return int(text)


HANDS = ("glove", "camera")
"""Kinds that tell a hand, which a map brings to the robot."""
SOURCES: Mapping[str, Callable[[str, DriveChannels], DriveSource]] = {
    "keys": _keys,
    "gamepad": _gamepad,
    "midi": _midi,
    "osc": _osc,
}
"""Factory of each kind of source, called with a place and channels."""
SHOWN = (
    "keys",
    "gamepad:0",
    "midi:NAME@1",
    f"osc:{PORT}",
    "glove:/dev/ttyUSB0",
    "glove:emulated",
    f"camera:{MODEL}",
    "camera:9001",
)
