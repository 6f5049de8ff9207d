"""`measure_film`: places of a robot's markers in a film of a fixed camera."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.camera.find_tags import Gray, load_opencv
from hydrostat.camera.marker_view import MarkerView
from hydrostat.camera.measure_photos import PhotoOptions
from hydrostat.camera.tags import marker_tags
from hydrostat.errors import InputError
from hydrostat.files import csv_text
from hydrostat.given import check_not_negative, check_positive
from hydrostat.identification import Measurements
from hydrostat.progress import Progress, no_progress
from hydrostat.robot import PinDrive, Robot
from hydrostat.simulation import ContractionProfile, Simulation

FILMS = (".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm")
"""File extensions of films."""

MAX_FRAMES = 10_000
"""Frames that a table takes."""

FAST_WINCH_SPEED = 20e-3
"""Speed of a winch [m/s] above which a frame is far from an equilibrium."""


@dataclass(frozen=True, kw_only=True)
class FilmOptions:
    """Options for measuring a film.

    Attributes:
        every: time between two measured frames [s].
        start: time in the film at which the table of contractions starts [s].
        photo: options for its frames.
    """

    every: float = 0.2
    start: float = 0.0
    photo: PhotoOptions = field(default_factory=PhotoOptions)

    def __post_init__(self) -> None:
        check_positive("every", self.every, "s")
        check_not_negative("start", self.start, "s")


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmMeasurements:
    """Measured frames of a film.

    Attributes:
        times: time of each frame in the table of contractions [s].
        measurements: a row for each frame with a marker in sight.
        warnings: texts of what is likely to be wrong.
    """

    times: Vector
    measurements: Measurements
    warnings: list[str]

    def text(self, robot: Robot) -> bytes:
        """CSV with the columns time_s, left_mm per winch, tip_x_mm ... per marker."""
        measured, axes = self.measurements, "xyz"[: robot.body.mesh.dim]
        head = ["time_s", *(f"{winch.name}_mm" for winch in robot.winches)]
        head += [f"{name}_{axis}_mm" for name in measured.markers for axis in axes]
        rows = [
            [
                f"{time:.3f}",
                *(f"{1e3 * value:.6g}" for value in command),
                *("" if np.isnan(value) else f"{1e3 * value:.3f}" for value in places.ravel()),
            ]
            for time, command, places in zip(self.times, measured.commands, measured.places, strict=True)
        ]
        return csv_text(head, rows)


def measure_film(
    robot: Robot,
    film: Path,
    profile: ContractionProfile,
    options: FilmOptions | None = None,
    progress: Progress = no_progress,
) -> FilmMeasurements:
    """Measure marker positions in a film.

    The first frame locates board and robot; in it the robot must be in the first pose of the table.

    Args:
        robot: model of the robot, as designed.
        film: film from a fixed camera.
        profile: contractions in time.
        options: options of the measurement.
        progress: callback for progress, after each frame.

    Raises:
        InputError: a file that is not a film, no board or too few markers in its first frame, a camera that moved, or a
            robot with drives.
        HydrostatError: OpenCV is not installed.
    """
    PinDrive.require_none(robot.drives, "films that are measured")
    options = options or FilmOptions()
    seconds = float(profile.times[-1] - profile.times[0])
    times, found, blind = list[float](), list[dict[str, Vector]](), 0
    view: MarkerView | None = None
    for time, pixels in _read_frames(film, options):
        if time > seconds + options.every / 2:
            break
        if view is None:
            view = _place_board(robot, film, profile, options, pixels)
        try:
            places = view.find(pixels)
        except InputError as error:
            text = str(error).removeprefix(f"{film.name}: ")
            raise InputError(f"{film.name}, {time + options.start:.2f} s: {text}") from None
        if places:
            times.append(float(profile.times[0]) + time)
            found.append(places)
        blind += not places
        progress("frames", round(time / options.every), round(seconds / options.every))
        if len(times) > MAX_FRAMES:
            raise InputError(f"{film}: more than {MAX_FRAMES} frames. Take fewer by --every.")
    if not times:
        raise InputError(f"{film}: has no frame after {options.start:g} s. Check --start.")
    commands = np.array([profile.at(time) for time in times])
    names = tuple(name for name in marker_tags(robot) if any(name in each for each in found))
    nowhere = np.full(robot.body.mesh.dim, np.nan)
    return FilmMeasurements(
        times=np.array(times),
        measurements=Measurements(
            commands=commands,
            markers=names,
            places=np.array([[each.get(name, nowhere) for name in names] for each in found]),
        ),
        warnings=_find_warnings(film, np.array(times), commands, blind),
    )


def _place_board(
    robot: Robot, film: Path, profile: ContractionProfile, options: FilmOptions, pixels: Gray
) -> MarkerView:
    """Calibrate the camera by the first frame."""
    names = [winch.name for winch in robot.winches]
    pose = Simulation(robot).solve(dict(zip(names, profile.values[0].tolist(), strict=True)))
    return MarkerView([pixels], pose, options.photo, name=film.name)


def _find_warnings(film: Path, times: Vector, commands: np.ndarray, blind: int) -> list[str]:
    """Texts of what is likely to be wrong."""
    texts = []
    if blind:
        texts.append(f"{film.name}: {blind} of {blind + len(times)} frames show no marker. The table leaves them out.")
    speeds = np.abs(np.diff(commands, axis=0)) / np.diff(times)[:, None]
    if speeds.size and speeds.max() > FAST_WINCH_SPEED:
        texts.append(
            f"{film.name}: winches move at up to {1e3 * speeds.max():.0f} mm/s. Rows count as poses at rest: play more "
            f"slowly, below {1e3 * FAST_WINCH_SPEED:.0f} mm/s."
        )
    return texts


def _read_frames(film: Path, options: FilmOptions) -> Iterator[tuple[float, Gray]]:
    """Frames to measure with their times from the start [s]."""
    cv2 = load_opencv()
    if not film.is_file():
        raise InputError(f"{film}: no such file")
    with suppress(AttributeError):  # its own lines would stand before ours
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    video = cv2.VideoCapture(str(film))
    try:
        if not video.isOpened():
            raise InputError(f"{film}: cannot be read as a film. Save it as MP4.")
        due = 0.0
        while video.grab():
            time = 1e-3 * video.get(cv2.CAP_PROP_POS_MSEC) - options.start
            if time < due - 1e-3:
                continue
            is_read, pixels = video.retrieve()
            if is_read:
                yield time, cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
            due = options.every * (np.floor((time + 1e-3) / options.every) + 1)
    finally:
        video.release()
