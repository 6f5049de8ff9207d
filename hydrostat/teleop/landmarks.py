"""`HandLandmarks`: a hand before a camera, as landmarks that another program sends as lines of JSON over UDP."""

import json
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import HydrostatError
from hydrostat.teleop.source import HandReading, HandSource

COUNT = 21
"""Landmarks: the wrist, then from root to tip those of thumb, index, middle, ring and little finger (MediaPipe)."""
FINGERS = ("thumb", "index", "middle", "ring", "little")


class HandLandmarks(HandSource):
    """Bends of the joints, and angles between fingers, from 21 landmarks; where and how large the hand is, is nothing.

    Each datagram is {"landmarks": [[x, y, z], ...]}, in any unit that all axes share. Hands that are not seen need
    not be told.
    """

    names = (
        *(f"{finger} {joint}" for finger in FINGERS for joint in ("root", "middle", "end")),
        *(f"{one}-{other}" for one, other in pairwise(FINGERS)),
    )

    def __init__(self, port: int, host: str = "127.0.0.1", *, clock: Callable[[], float] = time.monotonic) -> None:
        """Hear a port of an address of this computer (HydrostatError: it is taken)."""
        self._clock, self._socket = clock, socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise HydrostatError(f"port {port} of {host} cannot be heard ({error}); choose another") from None
        self.address = self._socket.getsockname()

    def read(self) -> HandReading:
        """The newest landmarks (HydrostatError: none come, or what comes is none)."""
        wait = 0.2  # So long is waited for a picture with a hand [s]
        try:
            self._socket.settimeout(wait)
            data = self._socket.recv(65536)
            self._socket.setblocking(False)
            with suppress(BlockingIOError):
                while True:
                    data = self._socket.recv(65536)
        except TimeoutError:
            raise HydrostatError(f"no landmarks come to {self.address[0]}:{self.address[1]}") from None
        except OSError as error:
            raise HydrostatError(f"the port for landmarks is gone ({error})") from None
        try:
            places = np.array(json.loads(data)["landmarks"], dtype=float)
        except (ValueError, KeyError, TypeError):
            raise HydrostatError('what comes are no landmarks; send {"landmarks": [[x, y, z], ...]}') from None
        if places.shape != (COUNT, 3) or not np.isfinite(places).all():
            raise HydrostatError(f"what comes are not {COUNT} landmarks of three finite coordinates")
        return HandReading(bends(places), self._clock())

    def close(self) -> None:
        """Let the port go."""
        with suppress(Exception):
            self._socket.close()


def bends(places: Points) -> Vector:
    """Angles of a hand as shares of half a turn: three bends a finger, then those between neighbouring fingers."""
    places = places / max(float(np.abs(places).max()), np.finfo(float).tiny)  # whatever the unit, products stay finite
    fingers = [np.vstack([places[:1], places[1 + 4 * index : 5 + 4 * index]]) for index in range(len(FINGERS))]
    bones = [np.diff(finger, axis=0) for finger in fingers]
    angles = [_angle(one, other) for bone in bones for one, other in pairwise(bone)]
    ways = [finger[2] - finger[1] for finger in fingers]
    angles += [_angle(one, other) for one, other in pairwise(ways)]
    return np.array(angles) / np.pi


def _angle(one: Vector, other: Vector) -> float:
    """Angle between two directions [rad]; 0 where one has no length."""
    return float(np.arctan2(np.linalg.norm(np.cross(one, other)), one @ other))
