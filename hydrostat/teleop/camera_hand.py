"""`HandLandmarks`, `CameraHand`: a hand before a camera, as landmarks over UDP or found by MediaPipe."""

import json
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.arrays import Points, Vector
from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop.source import HandReading, HandSource
from hydrostat.version import install_command

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
    """Angles of a hand as shares of half a turn: three bends a finger, then those between neighboring fingers."""
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


MODEL = "hand_landmarker.task"
"""File name of MediaPipe's hand landmarker; hydrostat neither ships nor downloads it."""


class CameraHand(HandSource):
    """Bends of joints and angles between fingers, as `HandLandmarks` tells them, of the first hand in each picture."""

    names = HandLandmarks.names

    def __init__(self, model: Path, camera: int = 0, *, clock: Callable[[], float] = time.monotonic) -> None:
        """Look through a camera, counted from 0, with a model file.

        Raises:
            InputError: there is no such file.
            HydrostatError: MediaPipe is not there, does not take the file, or the camera gives no pictures.
        """
        if not model.is_file():
            raise InputError(f"camera:{model}: file not found. Download MediaPipe's {MODEL} yourself.")
        try:
            import cv2  # pyright: ignore[reportMissingImports] (an extra)
            import mediapipe  # pyright: ignore[reportMissingImports]
            from mediapipe.tasks.python import BaseOptions, vision  # pyright: ignore[reportMissingImports]
        except (ImportError, OSError) as error:
            raise InputError(f"a camera needs mediapipe ({error}): {install_command('camera')}") from None
        self._clock, self._begin, self._told = clock, clock(), -1
        self._cv2, self._mediapipe = cv2, mediapipe
        options = vision.HandLandmarkerOptions(
            base_options=BaseOptions(model_asset_path=str(model)), running_mode=vision.RunningMode.VIDEO, num_hands=1
        )
        try:
            self._finder: Any = vision.HandLandmarker.create_from_options(options)
        except Exception as error:  # noqa: BLE001 (of whatever kind the library has)
            raise HydrostatError(f"MediaPipe does not take {model} ({_first(error)}); is it its {MODEL}?") from None
        self._camera: Any = cv2.VideoCapture(camera)
        self._camera.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # the newest picture, not those that waited
        if not self._camera.isOpened():
            self.close()
            raise HydrostatError(f"camera {camera} cannot be opened; another is named after @: camera:{model}@1")

    def read(self) -> HandReading:
        """The hand in the next picture, as of when it was taken (HydrostatError: no picture, or no hand in it)."""
        found, picture = self._camera.read()
        stamp = self._clock()
        if not found:
            raise HydrostatError("the camera gives no picture; look at its plug")
        self._told = max(self._told + 1, round(1e3 * (stamp - self._begin)))  # MediaPipe wants times that rise [ms]
        rgb = np.ascontiguousarray(self._cv2.cvtColor(picture, self._cv2.COLOR_BGR2RGB))
        image = self._mediapipe.Image(image_format=self._mediapipe.ImageFormat.SRGB, data=rgb)
        try:
            hands = self._finder.detect_for_video(image, self._told).hand_world_landmarks
        except Exception as error:  # noqa: BLE001 (of whatever kind the library has)
            raise HydrostatError(f"MediaPipe finds nothing in a picture ({_first(error)})") from None
        if not hands:
            raise HydrostatError("no hand is seen")
        places = np.array([(point.x, point.y, point.z) for point in hands[0]], dtype=float)
        if places.shape != (COUNT, 3) or not np.isfinite(places).all():
            raise HydrostatError(f"MediaPipe tells no {COUNT} landmarks of the hand")
        return HandReading(bends(places), stamp)

    def close(self) -> None:
        """Let camera and model go."""
        with suppress(Exception):
            self._camera.release()
        with suppress(Exception):
            self._finder.close()


def _first(error: Exception) -> str:
    """The first line of what a library says."""
    return (str(error).strip().splitlines() or [type(error).__name__])[0]
