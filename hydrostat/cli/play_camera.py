"""`open_camera`: the camera of `hydrostat play --camera`."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hydrostat.errors import InputError

if TYPE_CHECKING:
    from hydrostat.camera import MarkerCamera, PhotoOptions
    from hydrostat.control import LostAction, MarkerFeedback, Motors
    from hydrostat.robot import Robot
    from hydrostat.simulation import ContractionProfile


@dataclass(frozen=True, kw_only=True)
class CameraOptions:
    """Options of a camera that corrects contractions."""

    name: str
    lag: float
    lost: "LostAction"
    options: "PhotoOptions"

    @classmethod
    def read(cls, name: str, port: str | None, lag: str, lost: str, options: "PhotoOptions") -> "CameraOptions":
        """Check the options (InputError: no motors, or no such value)."""
        from hydrostat.cli.options import positive
        from hydrostat.closed_set import parse_choice
        from hydrostat.control import LostAction
        from hydrostat.units import TIME

        if port is None:
            raise InputError("--camera: simulated motors move no robot. Add --motors.")
        most, seconds = 0.5, positive("--lag", lag, TIME, zero=True)
        if seconds > most:
            raise InputError(f"--lag {lag}: must be {1e3 * most:g} ms or less")
        return cls(name=name, lag=seconds, lost=parse_choice(LostAction, lost, what="--lost"), options=options)


@dataclass(frozen=True, kw_only=True)
class CameraFeedback:
    """Camera, and the feedback that it gives."""

    camera: "MarkerCamera"
    feedback: "MarkerFeedback"

    def report(self) -> list[str]:
        """Lines on errors and rate, and warnings."""
        import numpy as np

        found, slow = self.feedback, 15.0
        if not found.errors:
            return ["warning: the camera saw no marker, so nothing was corrected. " + self.camera.trouble]
        half = len(found.errors) // 2
        text = (
            f"markers {1e3 * np.mean(found.errors[half:]):.1f} mm from the simulation in the second half, about "
            f"{1e3 * np.mean(found.open_errors[half:]):.1f} mm without correction; {found.rate:.0f} frames a second"
        )
        warning = f"warning: fewer than {slow:g} frames a second. Take smaller pictures or more light"
        return [text] if found.rate >= slow else [text, warning]


@contextmanager
def open_camera(
    asked: CameraOptions | None, robot: "Robot", profile: "ContractionProfile", say: Callable[[str], None]
) -> Iterator[CameraFeedback | None]:
    """Calibrate a camera by the robot at rest; None without a camera.

    Armed motors wait for nobody, so that everything slow is done before.
    """
    if asked is None:
        yield None
        return
    from hydrostat import camera, control
    from hydrostat.simulation import Simulation

    frames = camera.CameraFrames(asked.name)
    try:
        path = control.MarkerPath.along(robot, profile)
        source = camera.MarkerCamera(frames, Simulation(robot).rest, control.MarkerSight, asked.options)
    except BaseException:
        frames.close()
        raise

    def log(text: str) -> None:
        say(f"{text} ({source.trouble})" if source.trouble else text)

    try:
        feedback = control.MarkerFeedback(robot, path, source, lag=asked.lag, lost=asked.lost, log=log)
        yield CameraFeedback(camera=source, feedback=feedback)
    finally:
        source.close()


def require_rest(motors: "Motors") -> None:
    """Check that the robot was at rest when the camera was calibrated (InputError: a winch has contracted)."""
    import numpy as np

    index, most = int(np.abs(motors.places).argmax()), 2e-3
    if abs(motors.places[index]) > most:
        raise InputError(
            f"--camera: {motors.names[index]} stands at {1e3 * motors.places[index]:.1f} mm. Begin at rest: pay its "
            "cable out first."
        )
