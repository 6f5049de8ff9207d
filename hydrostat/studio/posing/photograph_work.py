"""`compare_photographs`, `fit_photographs`: work on photographs of the built robot, in a process of its own."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from hydrostat.camera import Photo, measure_photos
from hydrostat.errors import InputError
from hydrostat.identification import Measurements, identify, rms
from hydrostat.plot import draw_photo_overlay, save_png
from hydrostat.robot import Robot
from hydrostat.studio.jobs import Report


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseFile:
    """A photograph as a file, and the contractions [m] that were shown when it was dropped."""

    name: str
    content: bytes
    contractions: Mapping[str, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class ComparedPhotograph:
    """A photograph with the simulated robot drawn in (PNG), and the distance of each marker from it [m]."""

    name: str
    overlay: bytes
    errors: Mapping[str, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """Photographs of a robot, compared with its simulation.

    Attributes:
        photographs: each of them.
        measurements: places of the markers.
        warnings: texts of what is likely to be wrong.
    """

    photographs: tuple[ComparedPhotograph, ...]
    measurements: Measurements
    warnings: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class FittedValue:
    """A parameter with its interval of 95 %, and whether the photographs show it."""

    name: str
    unit: str
    assumed: float
    value: float
    low: float
    high: float
    is_shown: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class PhotographFit:
    """Robot fitted to photographs.

    Attributes:
        robot: fitted robot.
        values: its parameters.
        before: root mean square distance of the markers before the fit [m].
        after: the same after it.
    """

    robot: Robot
    values: tuple[FittedValue, ...]
    before: float
    after: float


def compare_photographs(report: Report, robot: Robot, files: tuple[PoseFile, ...]) -> Comparison:
    """Measure photographs and draw the simulated robot into each.

    Raises:
        InputError: see `measure_photos`.
    """
    with TemporaryDirectory() as scratch:
        photos = []
        for number, file in enumerate(files):
            folder = Path(scratch) / str(number)
            folder.mkdir()
            path = folder / Path(file.name).name
            path.write_bytes(file.content)
            photos.append(_read_photo(path, robot, file.contractions))
        photos.sort(key=lambda photo: photo.step or 0)
        report.progress("Finding tags", 0, 2)
        try:
            found = measure_photos(robot, photos)
        except InputError as error:  # names are those of the person's files
            raise InputError(re.sub(rf"{re.escape(scratch)}[/\\]\d+[/\\]", "", str(error))) from None
        drawn = []
        for index, measured in enumerate(found.photos):
            report.progress("Drawing", len(photos) + index, 2 * len(photos))
            path = save_png(draw_photo_overlay(found, index), Path(scratch) / "overlay.png", dpi=70)
            drawn.append(
                ComparedPhotograph(name=measured.photo.name, overlay=path.read_bytes(), errors=dict(measured.errors))
            )
    return Comparison(photographs=tuple(drawn), measurements=found.measurements, warnings=tuple(found.warnings))


def _read_photo(path: Path, robot: Robot, contractions: Mapping[str, float]) -> Photo:
    """Photograph with the pose that its name holds, or else the given contractions."""
    if "=" in path.stem or re.fullmatch(r"(\d+ +)?rest", path.stem):
        return Photo.read_all([path], robot)[0]
    return Photo(file=path, contractions=contractions, masses={})


def fit_photographs(report: Report, robot: Robot, measurements: Measurements) -> PhotographFit:
    """Fit the robot to measured photographs, as `hydrostat identify` does.

    Raises:
        InputError: see `identify`.
    """
    report.progress("Fitting", 0, 0)
    found = identify(robot, measurements, progress=report.progress)
    fitted = found.fitted
    values = []
    for parameter in fitted.model.parameters:
        low, high = fitted.intervals[parameter.name]
        values.append(
            FittedValue(
                name=parameter.name,
                unit=parameter.unit,
                assumed=parameter.start,
                value=fitted.values[parameter.name],
                low=low,
                high=high,
                is_shown=parameter.name not in found.unknown,
            )
        )
    if not np.isfinite(found.after).any():
        raise InputError("the fitted robot reaches no equilibrium. Check the contractions of the photographs.")
    return PhotographFit(
        robot=found.robot,
        values=tuple(values),
        before=rms(found.before),
        after=rms(found.after),
    )
