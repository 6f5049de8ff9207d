"""`CameraHand`: a hand before a camera of this computer, found by MediaPipe with a model file of the user's."""

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.errors import HydrostatError, InputError
from hydrostat.teleop.landmarks import COUNT, HandLandmarks, bends
from hydrostat.teleop.source import HandReading, HandSource

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
            words = f'a camera needs mediapipe ({error}): pip install "hydrostat[camera]"'
            raise HydrostatError(words) from None
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
