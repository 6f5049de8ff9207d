"""`measure_photos`: places of a robot's markers from photographs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median

import numpy as np

from hydrostat.arrays import Float
from hydrostat.camera.calibrate_camera import CameraCalibration, calibrate_camera
from hydrostat.camera.find_tags import Corners, find_tags, load_opencv
from hydrostat.camera.lens import LensFile, View
from hydrostat.camera.locate_tags import align_places, locate_in_space, locate_on_plane, pairs_of
from hydrostat.camera.photo import Photo, read_pixels
from hydrostat.camera.photo_warnings import (
    LIMITS,
    check_sheets,
    find_missing,
    warn_of_board,
    warn_of_frame,
    warn_of_sizes,
    warn_of_tags,
)
from hydrostat.camera.tags import MARKER_SIDE, marker_tags, sheet_of
from hydrostat.errors import InputError
from hydrostat.files import csv_text
from hydrostat.given import check_not_negative, check_positive
from hydrostat.identification import Measurements
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation
from hydrostat.units import plural

MIN_TAGS = 4
"""Tags of the board that a photograph must show."""


@dataclass(frozen=True, kw_only=True)
class PhotoOptions:
    """Options for measuring photographs.

    Attributes:
        side: side of the black square of the markers' tags [m].
        height: height of these tags above the board [m], for flat robots; the thickness of the body if left out.
        lens: lens from other photographs of this camera; estimated from the given ones if left out.
    """

    side: float = MARKER_SIDE
    height: float | None = None
    lens: LensFile | None = None

    def __post_init__(self) -> None:
        check_positive("side", self.side, "m")
        if self.height is not None:
            check_not_negative("height", self.height, "m")


@dataclass(frozen=True, eq=False)
class MeasuredPhoto:
    """Markers in one photograph.

    Attributes:
        photo: the photograph.
        view: frame of the board in it.
        corners: corners of the tag of each marker in sight [pixels].
        places: places of these markers in the frame of the robot [m].
        pose: simulated pose; None where no equilibrium was found.
    """

    photo: Photo
    view: View
    corners: dict[str, Corners]
    places: dict[str, np.ndarray]
    pose: Equilibrium | None

    @property
    def errors(self) -> dict[str, float]:
        """Distance of each measured marker from the simulated one [m]."""
        if self.pose is None:
            return {}
        return {name: float(np.linalg.norm(at - self.pose.markers[name])) for name, at in self.places.items()}


@dataclass(frozen=True, eq=False)
class PhotoMeasurements:
    """Measurements from photographs.

    Attributes:
        measurements: one row for each photograph; in space one for each pose.
        rows: photographs of each row, by index.
        photos: measured photographs.
        camera: camera model, with the size of its pictures.
        height: height of the tags above the board [m]; 0 in space.
        turn: rotation from the frame of the board to that of the robot, (dim, dim).
        shift: position of the board's origin in the frame of the robot [m].
        error: root-mean-square distance of the board's corners [pixels].
        scale: size of a pixel on the board [m].
        warnings: warnings, one text each.
    """

    measurements: Measurements
    rows: list[list[int]]
    photos: list[MeasuredPhoto]
    camera: LensFile
    height: float
    turn: Float[np.ndarray, "dim dim"]
    shift: Float[np.ndarray, " dim"]
    error: float
    scale: float
    warnings: list[str]

    def project(self, index: int, points: Float[np.ndarray, "points dim"]) -> Float[np.ndarray, "points 2"]:
        """Project points in the robot's frame [m] to pixels of a photograph."""
        board = (points - self.shift) @ self.turn
        if board.shape[1] == 2:
            board = np.column_stack([board, np.full(len(board), self.height)])
        return self.camera.lens.project(self.photos[index].view.to_camera(board))


def measure_photos(robot: Robot, photos: Sequence[Photo], options: PhotoOptions | None = None) -> PhotoMeasurements:
    """Measure marker positions in photographs of a robot on its board.

    Positions are in the frame of the robot: the board's frame is moved rigidly to fit the simulated markers best.

    Args:
        robot: model of the robot, as designed.
        photos: photographs of one camera with its zoom fixed; the board does not move.
        options: options of the measurement.

    Raises:
        InputError: a file that is not a picture, no board or no visible marker, duplicate tags or tags of another
            robot, a mirrored photograph, or a board that moved.
        HydrostatError: OpenCV is not installed.
    """
    load_opencv()
    options = options or PhotoOptions()
    names = marker_tags(robot)
    tags, size, focal = _read(photos)
    markers = [_markers_in(found, names, photo.name) for found, photo in zip(tags, photos, strict=True)]
    calibration = calibrate_camera(tags, size, focal=focal, known=options.lens and options.lens.scale_to(size))
    check_sheets(photos, calibration)
    flat = robot.body.mesh.dim == 2
    height = (options.height if options.height is not None else robot.body.thickness or 0.0) if flat else 0.0
    rows = [[index] for index in range(len(photos))] if flat else _same_poses(photos)
    scale = median(_scale(calibration, index, height) for index in range(len(photos)))
    warnings = find_missing(photos, markers, names, rows)
    warnings += warn_of_board(photos, calibration, scale)
    if flat:
        found, sides, misfits = _on_plane(markers, calibration, height)
        warnings += warn_of_sizes(sides, options.side, height, calibration)
        misfits = [{name: misfit / scale for name, misfit in each.items()} for each in misfits]
    else:
        found, misfits = _in_space(markers, rows, calibration, options.side)
    warnings += warn_of_tags([photos[row[0]] for row in rows], misfits)
    poses = _simulate(robot, [photos[row[0]] for row in rows])
    turn, shift = _align(robot, found, poses)
    warnings += warn_of_frame(robot, [photos[row[0]] for row in rows], found, poses, (turn, shift))
    places = [{name: turn @ at + shift for name, at in each.items()} for each in found]
    row_of = {index: row for row, members in enumerate(rows) for index in members}
    measured = [
        MeasuredPhoto(photo, calibration.views[index], markers[index], places[row_of[index]], poses[row_of[index]])
        for index, photo in enumerate(photos)
    ]
    return PhotoMeasurements(
        measurements=_table(robot, [photos[row[0]] for row in rows], places),
        rows=rows,
        photos=measured,
        camera=LensFile(lens=calibration.lens, size=size),
        height=height,
        turn=turn,
        shift=shift,
        error=float(np.sqrt(np.mean(np.square(calibration.errors)))),
        scale=scale,
        warnings=warnings,
    )


def _read(photos: Sequence[Photo]) -> tuple[list[dict[int, Corners]], tuple[int, int], float | None]:
    """Tags in each photograph, the size of all [pixels], and the focal length if all say it [pixels]."""
    tags, focals = [], []
    size = None
    for photo in photos:
        pixels, focal = read_pixels(photo.file)
        own = (pixels.shape[1], pixels.shape[0])
        if size is not None and own != size:
            raise InputError(
                f"{photo.name}: {own[0]} x {own[1]} pixels, but {photos[0].name} has {size[0]} x {size[1]}. Use one "
                "camera in one position, and do not crop."
            )
        size = own
        found = find_tags(pixels, photo.name)
        on_board = sum(sheet_of(number) is not None for number in found)
        if on_board < MIN_TAGS:
            raise InputError(
                f"{photo.name}: {plural(on_board, 'tag')} of the board in sight. Show at least {MIN_TAGS} whole tags, "
                "in focus."
            )
        tags.append(found)
        focals.append(focal)
    if size is None:
        raise InputError("no photographs. Name at least one file.")
    known = [focal for focal in focals if focal]
    return tags, size, float(np.mean(known)) if len(known) == len(photos) and np.ptp(known) < 1 else None


def _markers_in(tags: Mapping[int, Corners], names: Mapping[str, int], where: str) -> dict[str, Corners]:
    """Corners of the tags of markers (InputError: there are none)."""
    found = {name: tags[number] for name, number in names.items() if number in tags}
    others = [number for number in tags if sheet_of(number) is None and number not in names.values()]
    if found:
        return found
    if others:
        raise InputError(
            f"{where}: tag {others[0]} is of another robot (these are {min(names.values())} to "
            f"{max(names.values())}). Print tags for this one."
        )
    raise InputError(f"{where}: no tag of a marker in sight. Stick them where the sheet of tags says.")


def _scale(calibration: CameraCalibration, index: int, height: float) -> float:
    """Size of a pixel in the middle of a photograph [m]."""
    lens, view = calibration.lens, calibration.views[index]
    eye = -view.rotation.T @ view.translation
    middle = view.meet_plane(np.array([[0.0, 0.0, 1.0]]), height)[0]
    return float(np.linalg.norm(middle - eye)) / lens.focal


Found = list[dict[str, np.ndarray]]
"""Places of markers in the frame of the board, of each row."""


def _on_plane(
    markers: Sequence[Mapping[str, Corners]], calibration: CameraCalibration, height: float
) -> tuple[Found, list[float], list[dict[str, float]]]:
    """Places of markers, sides of all tags [m], and the misfit of each tag to a square [m]."""
    found, sides, misfits = [], [], []
    for seen, view in zip(markers, calibration.views, strict=True):
        tags = {name: locate_on_plane(corners, calibration.lens, view, height) for name, corners in seen.items()}
        found.append({name: place[:2] for name, (place, _, _) in tags.items()})
        misfits.append({name: misfit for name, (_, _, misfit) in tags.items()})
        sides += [side for _, side, _ in tags.values()]
    return found, sides, misfits


def _in_space(
    markers: Sequence[Mapping[str, Corners]], rows: list[list[int]], calibration: CameraCalibration, side: float
) -> tuple[Found, list[dict[str, float]]]:
    """Places of markers, and the misfit of each tag to a square of its size [pixels]."""
    found, misfits = [], []
    for row in rows:
        names = dict.fromkeys(name for index in row for name in markers[index])
        tags = {
            name: locate_in_space(
                [(markers[index][name], calibration.views[index]) for index in row if name in markers[index]],
                calibration.lens,
                side,
            )
            for name in names
        }
        found.append({name: place for name, (place, _) in tags.items()})
        misfits.append({name: misfit for name, (_, misfit) in tags.items()})
    return found, misfits


def _same_poses(photos: Sequence[Photo]) -> list[list[int]]:
    """Photographs of each pose."""
    rows: dict[object, list[int]] = {}
    for index, photo in enumerate(photos):
        rows.setdefault(photo.pose, []).append(index)
    return list(rows.values())


def _simulate(robot: Robot, photos: Sequence[Photo]) -> list[Equilibrium | None]:
    """Simulated pose of each row; None without an equilibrium."""
    simulations: dict[object, Simulation] = {}
    solved: dict[object, Equilibrium | None] = {}
    for photo in photos:
        if photo.loads_of_pose not in simulations:
            simulations[photo.loads_of_pose] = Simulation(replace(robot, loads=(*robot.loads, *photo.loads_of_pose)))
        if photo.pose not in solved:
            pose = simulations[photo.loads_of_pose].solve(dict(photo.contractions), strict=False)
            solved[photo.pose] = pose if pose.result.converged else None
    return [solved[photo.pose] for photo in photos]


def _align(robot: Robot, found: Found, poses: Sequence[Equilibrium | None]) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and shift from the frame of the board to that of the robot.

    Raises:
        InputError: too few markers, or markers that are a mirror image of the robot's.
    """
    dim = robot.body.mesh.dim
    pairs = [pairs_of(each, pose.markers) for each, pose in zip(found, poses, strict=True) if pose is not None]
    pairs = [pair for pair in pairs if len(pair[0])]
    if not pairs:
        raise InputError("the simulated robot reaches no equilibrium at these contractions. Check them.")
    places, targets = (np.concatenate(each) for each in zip(*pairs, strict=True))
    if np.linalg.matrix_rank(places - places.mean(axis=0), tol=0.01 * robot.body.mesh.size) < dim - 1:
        raise InputError(f"all markers are at one place. Measure at least {dim} markers that are apart.")
    turn, shift = align_places(places, targets)
    straight, mirrored = (
        float(np.sqrt(((places @ a.T + b - targets) ** 2).sum(axis=1).mean()))
        for a, b in ((turn, shift), align_places(places, targets, mirror=True))
    )
    if mirrored < 0.5 * straight and straight > LIMITS.shifted * robot.body.mesh.size:
        raise InputError(
            "the markers are a mirror image of the robot's. Turn the robot over, or swap the tags of left and right."
        )
    return turn, shift


def _table(robot: Robot, photos: Sequence[Photo], places: Found) -> Measurements:
    names = tuple(marker.name for marker in robot.markers if any(marker.name in each for each in places))
    nowhere = np.full(robot.body.mesh.dim, np.nan)
    return Measurements(
        commands=np.array([[photo.contractions.get(w.name, 0.0) for w in robot.winches] for photo in photos]),
        markers=names,
        places=np.array([[each.get(name, nowhere) for name in names] for each in places]),
        masses=np.array([[photo.masses.get(name, 0.0) for name in names] for photo in photos]),
        in_order=all(photo.step is not None for photo in photos),
    )


def table_text(robot: Robot, found: PhotoMeasurements) -> bytes:
    """Return a CSV: pose, left_mm per winch, tip_x_mm ... per marker, tip_load_g per marker with a mass."""
    measured = found.measurements
    axes = "xyz"[: measured.places.shape[2]]
    hung = np.asarray(measured.hung_masses.any(axis=0))
    loaded = [name for name, has_mass in zip(measured.markers, hung.tolist(), strict=True) if has_mass]
    head = ["pose", *(f"{winch.name}_mm" for winch in robot.winches)]
    head += [f"{name}_{axis}_mm" for name in measured.markers for axis in axes]
    head += [f"{name}_load_g" for name in loaded]
    rows = []
    for members, command, places, masses in zip(
        found.rows, measured.commands, measured.places, measured.hung_masses, strict=True
    ):
        numbers = [f"{1e3 * value:.6g}" for value in command]
        numbers += ["" if np.isnan(value) else f"{1e3 * value:.3f}" for value in places.ravel()]
        rows.append([found.photos[members[0]].photo.name, *numbers, *(f"{1e3 * mass:.6g}" for mass in masses[hung])])
    return csv_text(head, rows)
