"""`MappedHand`: a robot driven by a hand, as a glove or a camera tells it."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np

from hydrostat.errors import HydrostatError
from hydrostat.teleop.hand_map import HandMap
from hydrostat.teleop.hand_source import HandReading, HandSource
from hydrostat.teleop.one_euro import OneEuro, Smoothing
from hydrostat.teleop.source import DriveChannels, DriveSource, DriveWish

SILENCE = 0.25
"""A hand that is not heard for so long is not there [s]."""
USUAL_SMOOTHING = Smoothing()
"""Smoothing of hand readings: each is one byte, and trembles."""
PATIENCE = 5.0
"""Errors of the source in a row end the drive after so long [s]."""


class MappedHand(DriveSource):
    """A hand whose sensors are read all the time, in a thread of their own, and mapped to the channels of a robot."""

    silence = SILENCE

    def __init__(
        self,
        channels: DriveChannels,
        hand: HandSource,
        known: HandMap,
        *,
        smoothing: Smoothing | None = USUAL_SMOOTHING,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Read a hand from now on, smoothed if that is not None (InputError: the map is of another hand or robot)."""
        known.check(hand.names, channels.names)
        self._hand, self._map, self._clock = hand, known, clock
        self._reading: HandReading | None = None
        self._smooth = None if smoothing is None else OneEuro(smoothing)
        self._error, self._well = "", clock()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="hand", daemon=True)
        self._thread.start()

    def read(self) -> DriveWish:
        """Return the command of the newest reading."""
        reading, error = self._reading, self._error
        if error and self._clock() - self._well > PATIENCE:
            raise HydrostatError(error)
        if reading is None:
            return DriveWish(stamp=-inf, words=error or "the hand was not heard yet")
        return DriveWish(stamp=reading.stamp, places=self._map(reading.values), words=error or "Ctrl-C: end")

    def close(self) -> None:
        """End the thread, and let the hand go."""
        self._over.set()
        self._thread.join(1.0)
        self._hand.close()

    def _run(self) -> None:
        while not self._over.is_set():
            try:
                reading = self._hand.read()
                if not np.isfinite(reading.values).all():
                    raise HydrostatError("what the hand tells is no number")
                if self._smooth is not None:
                    reading = replace(reading, values=self._smooth(reading.values, reading.stamp))
                self._reading = reading
                self._error, self._well = "", self._clock()
            except Exception as error:  # noqa: BLE001 - of whatever kind: nobody is heard, and why is told
                self._error = str(error) or type(error).__name__
                self._over.wait(0.05)
            if self.updated is not None:
                self.updated.set()
            self._over.wait(1e-3)
