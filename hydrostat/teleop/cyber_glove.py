"""`CyberGlove`: a glove with 22 bend sensors on a serial line; `EmulatedGlove`, `EmulatedPerson`: its emulation."""

import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.control import Port
from hydrostat.errors import HydrostatError
from hydrostat.teleop.source import HandReading, HandSource

BAUD = 115200
SENSORS = 22
_FINGERS = ("index", "middle", "ring", "pinky")
_THUMB = ("thumb roll", "thumb inner", "thumb outer", "thumb abduction")
_SPREADS = {"middle": "middle-index abduction", "ring": "ring-middle abduction", "pinky": "pinky-ring abduction"}


def _names() -> tuple[str, ...]:
    """Return sensor names in the order of the glove."""
    names = list(_THUMB)
    for finger in _FINGERS:
        names += [f"{finger} inner", f"{finger} middle", f"{finger} outer"]
        names += [_SPREADS[finger]] if finger in _SPREADS else []
    return (*names, "palm arch", "wrist pitch", "wrist yaw")


class CyberGlove(HandSource):
    """CyberGlove data glove: sends G; the glove answers G, a byte from 1 to 255 for each of its 22 sensors, and a zero.

    Open-source programs use the same protocol. Not yet tested on a physical glove.
    """

    names = _names()

    def __init__(self, port: Port, *, clock: Callable[[], float] = time.monotonic) -> None:
        """A glove on an open serial line, of 115200 baud."""
        self._port, self._clock = port, clock
        self._port.timeout = 0.05

    def read(self) -> HandReading:
        """Return the latest values; an incomplete or corrupt answer is requested again."""
        asks = 3  # Number of queries before the glove counts as silent
        try:
            for _ in range(asks):
                if waiting := getattr(self._port, "in_waiting", 0):  # what is left of an answer that came late
                    self._port.read(waiting)
                self._port.write(b"G")
                answer = self._port.read(SENSORS + 2)
                if len(answer) == SENSORS + 2 and answer[:1] == b"G" and answer[-1] == 0 and 0 not in answer[1:-1]:
                    values = (np.frombuffer(answer[1:-1], np.uint8) - 1.0) / 254.0
                    return HandReading(values, self._clock())
        except OSError as error:
            raise HydrostatError(f"the glove is gone ({error}); look at its cable") from None
        raise HydrostatError(f"the glove does not answer with {SENSORS} sensors; look at its power and its port")

    def close(self) -> None:
        """Close the serial line."""
        with suppress(Exception):
            self._port.close()


class EmulatedGlove:
    """The other end of a line to a glove that is not there.

    Attributes:
        values: sensor values of the hand, each from 0 to 1.
        spoil: function that alters each answer.
    """

    timeout: float | None = 0.0

    def __init__(self, values: Vector, *, noise: float = 0.0, seed: int = 0) -> None:
        """A glove on a hand, whose sensors are noisy by a standard deviation."""
        self.values = values
        self.spoil: Callable[[bytes], bytes] = lambda answer: answer
        self._noise, self._random, self._told = noise, np.random.default_rng(seed), b""

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        return len(self._told)

    def write(self, data: bytes, /) -> int:
        """Handle a request."""
        for _ in range(data.count(b"G")):
            shown = self.values + self._noise * self._random.normal(size=len(self.values))
            told = np.clip(np.rint(1 + 254 * shown), 1, 255).astype(np.uint8)
            self._told += self.spoil(b"G" + told.tobytes() + b"\0")
        return len(data)

    def read(self, size: int, /) -> bytes:
        """Bytes of its answers."""
        taken, self._told = self._told[:size], self._told[size:]
        return taken

    def close(self) -> None:
        """Nothing is let go."""


class EmulatedPerson:
    """Hand in an emulated glove; its sensor values are a fixed mixture of the contractions of a robot.

    Attributes:
        glove: emulated glove.
    """

    def __init__(
        self, low: Vector, high: Vector, *, noise: float = 0.5 / 254, bent: float = 0.0, seed: int = 7
    ) -> None:
        """A hand that can do what winches do from their least to their largest contractions [m].

        Args:
            low: least contractions [m].
            high: largest [m].
            noise: standard deviation of the sensors; default half a step of the glove.
            bent: nonlinearity of the sensors.
            seed: random seed of the mixture.
        """
        random = np.random.default_rng(seed)
        self._low, self._span, self._bent = low, np.maximum(high - low, 1e-9), bent
        mixture = random.normal(scale=0.05, size=(len(low), SENSORS))
        for winch in range(len(low)):  # each moves two sensors of its own, or shares them where winches are many
            own = [(2 * winch) % SENSORS, (2 * winch + 1) % SENSORS]
            mixture[winch, own] += random.choice([-0.5, 0.5], size=2) * random.uniform(0.8, 1.2, size=2)
        self._mixture = mixture / np.maximum(np.abs(mixture).sum(0), 1.0)
        self.glove = EmulatedGlove(np.full(SENSORS, 0.5), noise=noise, seed=seed)
        self.mimic(np.clip(np.zeros(len(low)), low, high))

    def mimic(self, contractions: Vector) -> None:
        """Mimic the pose of the robot at contractions [m]."""
        wanted = 2 * (contractions - self._low) / self._span - 1
        straight = wanted @ self._mixture
        self.glove.values = 0.5 + 0.45 * (straight + self._bent * straight**2)

    def wave(self, seconds: float) -> None:
        """Close and open one finger after the other, for tests without a robot."""
        phases = np.linspace(0.0, 2.0, len(self._low), endpoint=False)
        share = 0.25 * (1 - np.cos(seconds + phases)) * (np.arange(len(phases)) % 2 == 0)
        self.mimic(self._low + share * self._span)
