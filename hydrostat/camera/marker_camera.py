"""`MarkerCamera`: places of a robot's markers in the frames of a camera, while the robot plays."""

import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Protocol, runtime_checkable

from hydrostat.arrays import Vector
from hydrostat.camera.find_tags import Gray, load_opencv
from hydrostat.camera.marker_view import MarkerView
from hydrostat.camera.measure_photos import PhotoOptions
from hydrostat.errors import HydrostatError, InputError
from hydrostat.simulation import Equilibrium

FRAMES = 5
"""Frames whose corners are averaged before the robot moves."""


@runtime_checkable
class FrameSource(Protocol):
    """Frames of a camera."""

    def read(self) -> Gray | None:
        """Wait for the next frame; return None when there are no more."""
        ...

    def close(self) -> None:
        """Release the camera."""
        ...


class CameraFrames:
    """Frames of a camera of this computer, from OpenCV."""

    def __init__(self, name: str) -> None:
        """Open a camera by its number, device or address.

        Raises:
            InputError: no such number.
            HydrostatError: it gives no pictures.
        """
        cv2 = load_opencv()
        if name.isdecimal() and len(name) > 2:
            raise InputError(f"--camera {name}: must be the number of a camera, 0 to 99, its device or its address")
        with suppress(AttributeError):  # its own lines would stand before ours
            cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
        self._gray = cv2.COLOR_BGR2GRAY
        self._cv2, self._camera = cv2, cv2.VideoCapture(int(name) if name.isdecimal() else name)
        self._camera.set(cv2.CAP_PROP_BUFFERSIZE, 1)
        if not self._camera.isOpened():
            raise HydrostatError(f"--camera {name}: gives no pictures. Check its number, plug and permissions.")

    def read(self) -> Gray | None:
        """Wait for the next frame; return None after the last."""
        is_read, pixels = self._camera.read()
        return self._cv2.cvtColor(pixels, self._gray) if is_read else None

    def close(self) -> None:
        """Release the camera."""
        self._camera.release()


class MarkerCamera:
    """Camera that a separate thread reads, so that motors never wait for it.

    Attributes:
        trouble: reason why the last frame shows no marker; "" if it shows one.
    """

    def __init__(
        self,
        frames: FrameSource,
        pose: Equilibrium,
        sight: Callable[[float, Mapping[str, Vector]], Any],
        options: PhotoOptions | None = None,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Calibrate by the first frames, then begin to look.

        Args:
            frames: frames of the camera.
            pose: simulated pose in which the robot stands.
            sight: record to make of a time [s] and places [m], such as `control.MarkerSight`.
            options: numbers that frames do not show.
            clock: clock of the motors [s].

        Raises:
            InputError: too few tags in sight.
            HydrostatError: the camera gives no pictures.
        """
        self._frames, self._sight, self._clock = frames, sight, clock
        self._newest: Any = None
        self.trouble, self._is_open = "", True
        first = [pixels for _ in range(FRAMES) if (pixels := frames.read()) is not None]
        if len(first) < FRAMES:
            raise HydrostatError("--camera: gives no pictures. Check its number, plug and permissions.")
        self._view = MarkerView(first, pose, options)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def look(self) -> Any:
        """Return the latest sight of markers; None before the first."""
        return self._newest

    def close(self) -> None:
        """Stop the thread and release the camera. You can call this twice."""
        self._is_open = False
        self._thread.join(timeout=1.0)
        self._frames.close()

    def _run(self) -> None:
        try:
            self._watch()
        except Exception as error:  # noqa: BLE001 - the line about a lost marker ends with it
            self.trouble = f"the camera fails: {error!r:.80}"

    def _watch(self) -> None:
        while self._is_open:
            pixels = self._frames.read()
            now = self._clock()
            if pixels is None:
                self.trouble = "the camera gives no more pictures"
                return
            try:
                places = self._view.find(pixels)
                self.trouble = "" if places else "no tag of a marker in sight"
                if places:
                    self._newest = self._sight(now, places)
            except InputError as error:
                self.trouble = str(error)
