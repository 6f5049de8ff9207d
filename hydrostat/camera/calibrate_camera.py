"""`calibrate_camera`: the lens, the views and the sheets of the board that all photographs agree on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from hydrostat.camera.find_tags import Corners, load_opencv
from hydrostat.camera.lens import Lens, Pixels, Space, View
from hydrostat.camera.tags import board_corners, sheet_of
from hydrostat.errors import InputError


@dataclass(frozen=True)
class CalibrationRules:
    """Guesses of a lens and their spread, and weights of corners."""

    focal: float = 0.85
    focal_spread: float = 0.3
    """Focal length over the longer side of a photograph where the file does not say it, and its spread (logarithm)."""

    focal_trust: float = 0.05
    """Spread (logarithm) of a focal length that the file says."""

    center_spread: float = 0.02
    distortion_spread: float = 0.15
    """Spread of the principal point over the longer side, and of coefficients of distortion."""

    lens_trust: tuple[float, float, float] = (0.01, 0.002, 0.01)
    """Spread of a lens that other photographs showed, as focus moves it: focal length, principal point, distortion."""

    covered: float = 1.0
    """Distance of a corner [pixels] from which on it counts as covered, if others are closer."""

    scales: tuple[tuple[float, ...], ...] = ((0.5,), (20.0, 3.0, 0.5))
    """Errors [pixels] from which on corners count less, one fit after another, of two tries; the better one counts.

    The first keeps to a first guess of which most is right, as if a sheet has moved. The second is for a guess that is
    far from all, as by another focal length.
    """


RULES = CalibrationRules()


LENS = 5
"""Numbers of a lens."""


@dataclass(frozen=True, eq=False)
class CameraCalibration:
    """Lens, views and sheets that fit the tags of the board in all photographs.

    Attributes:
        lens: the camera.
        views: frame of the board in each photograph.
        sheets: place (x, y) [m] and turn [rad] of each sheet of the board in the frame of the first.
        errors: root mean square distance of the board's corners in each photograph [pixels], without covered ones.
        wrong: share of the corners of a sheet that are elsewhere, by photograph and sheet: covered, bent or moved.
    """

    lens: Lens
    views: list[View]
    sheets: dict[int, np.ndarray]
    errors: list[float]
    wrong: dict[tuple[int, int], float]


def calibrate_camera(
    tags: Sequence[Mapping[int, Corners]],
    size: tuple[int, int],
    *,
    focal: float | None = None,
    known: Lens | None = None,
) -> CameraCalibration:
    """Calibrate a camera from the board in its photographs (least squares with a Cauchy loss, as tags may be covered).

    Args:
        tags: tags in each photograph; each has at least one of the board.
        size: width and height of all photographs [pixels].
        focal: focal length [pixels] that the files say; a usual one if left out.
        known: lens that other photographs of the camera showed, for pictures of this size.

    Raises:
        InputError: sheets of which no photograph shows two together.
    """
    long = max(size)
    start = known or Lens(focal or RULES.focal * long, ((size[0] - 1) / 2, (size[1] - 1) / 2), (0.0, 0.0))
    trust = (
        (RULES.focal_trust if focal else RULES.focal_spread, RULES.center_spread, RULES.distortion_spread)
        if known is None
        else RULES.lens_trust
    )
    sheets, views = _first_guess(tags, start)
    spreads = np.array([trust[0], *[trust[1] * long] * 2, *[trust[2]] * 2])
    problem = _Problem(tags, sorted(sheets), start, spreads)
    numbers = problem.solve(problem.pack(sheets, views))
    lens, sheets, views = problem.unpack(numbers)
    away = np.linalg.norm(problem.residuals(numbers)[:-LENS].reshape(-1, 2), axis=1)
    good = away <= max(RULES.covered, 5 * float(np.median(away)))
    errors = [float(np.sqrt((away[(problem.photo == photo) & good] ** 2).mean())) for photo in range(len(views))]
    wrong = {
        (photo, sheet): float(1 - good[(problem.photo == photo) & (problem.sheet == index)].mean())
        for photo, each in enumerate(tags)
        for index, sheet in enumerate(sorted(sheets))
        if sheet in sheets_in(each)
    }
    return CameraCalibration(lens, views, sheets, errors, wrong)


def _flat_points(tags: Mapping[int, Corners], sheet: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a sheet in its own frame [m], and in a photograph [pixels]."""
    numbers = [number for number in tags if sheet_of(number) == sheet]
    return np.concatenate([board_corners(number) for number in numbers]), np.concatenate(
        [tags[number] for number in numbers]
    )


def sheets_in(tags: Mapping[int, Corners]) -> list[int]:
    """Sheets of the board in a photograph."""
    return sorted({sheet for number in tags if (sheet := sheet_of(number)) is not None})


def _first_guess(tags: Sequence[Mapping[int, Corners]], lens: Lens) -> tuple[dict[int, np.ndarray], list[View]]:
    """Sheets in the frame of the first, and the view of each photograph, from one sheet at a time."""
    alone = [{sheet: _view_of(_flat_points(each, sheet), lens) for sheet in sheets_in(each)} for each in tags]
    first = min(sheet for each in alone for sheet in each)
    sheets = {first: np.zeros(3)}
    while True:
        linked = [
            (view, known, sheet)
            for each in alone
            for known, view in each.items()
            for sheet in each
            if known in sheets and sheet not in sheets
        ]
        if not linked:
            break
        view, known, sheet = linked[0]
        other = next(each[sheet] for each in alone if each.get(known) is view)
        move = view.rotation.T @ (other.translation - view.translation)
        turn = view.rotation.T @ other.rotation
        sheets[sheet] = _chain(sheets[known], np.array([move[0], move[1], np.arctan2(turn[1, 0], turn[0, 0])]))
    views = []
    for photo, each in enumerate(alone):
        if missing := [sheet for sheet in each if sheet not in sheets]:
            raise InputError(
                f"photograph {photo + 1}: sheet {missing[0] + 1} of the board is in no photograph with sheet "
                f"{first + 1}. Take one that shows both."
            )
        sheet = max(each, key=lambda one: len(_flat_points(tags[photo], one)[0]))
        points = _on_board(_flat_points(tags[photo], sheet)[0], sheets[sheet])
        views.append(_view_of((points, _flat_points(tags[photo], sheet)[1]), lens))
    return sheets, views


def _chain(sheet: np.ndarray, move: np.ndarray) -> np.ndarray:
    c, s = np.cos(sheet[2]), np.sin(sheet[2])
    return np.array([sheet[0] + c * move[0] - s * move[1], sheet[1] + s * move[0] + c * move[1], sheet[2] + move[2]])


def _on_board(flat: np.ndarray, sheet: np.ndarray) -> np.ndarray:
    """Points of a sheet in the frame of the board."""
    c, s = np.cos(sheet[2]), np.sin(sheet[2])
    return flat @ np.array([[c, s], [-s, c]]) + sheet[:2]


def _view_of(points: tuple[np.ndarray, np.ndarray], lens: Lens) -> View:
    """View from points on the plane of the board."""
    cv2 = load_opencv()
    flat, pixels = points
    matrix = np.array([[lens.focal, 0, lens.center[0]], [0, lens.focal, lens.center[1]], [0, 0, 1.0]])
    _, turn, move = cv2.solvePnP(
        np.column_stack([flat, np.zeros(len(flat))]), pixels, matrix, None, flags=cv2.SOLVEPNP_IPPE
    )
    return View(cv2.Rodrigues(turn)[0], move.ravel())


class _Problem:
    """Residuals of all corners of the board, and of what is known before; numbers: lens, sheets, views."""

    def __init__(
        self, tags: Sequence[Mapping[int, Corners]], sheets: list[int], lens: Lens, spreads: np.ndarray
    ) -> None:
        self._start, self._spreads = lens, spreads
        self._sheets = sheets
        photo, sheet, flat, pixels = [], [], [], []
        for index, each in enumerate(tags):
            for one in sheets_in(each):
                points, seen = _flat_points(each, one)
                photo += [index] * len(points)
                sheet += [sheets.index(one)] * len(points)
                flat.append(points)
                pixels.append(seen)
        self.photo, self.sheet = np.array(photo), np.array(sheet)
        self._flat, self._pixels = np.concatenate(flat), np.concatenate(pixels)
        self._views = len(tags)

    def pack(self, sheets: Mapping[int, np.ndarray], views: Sequence[View]) -> np.ndarray:
        """Numbers of a first guess."""
        turns = [Rotation.from_matrix(view.rotation).as_rotvec() for view in views]
        return np.concatenate(
            [
                np.zeros(LENS),
                *(sheets[sheet] for sheet in self._sheets[1:]),
                *(np.concatenate([turn, view.translation]) for turn, view in zip(turns, views, strict=True)),
            ]
        )

    def unpack(self, numbers: np.ndarray) -> tuple[Lens, dict[int, np.ndarray], list[View]]:
        """Lens, sheets and views of some numbers."""
        lens = Lens(
            float(self._start.focal * np.exp(numbers[0])),
            (self._start.center[0] + float(numbers[1]), self._start.center[1] + float(numbers[2])),
            (self._start.distortion[0] + float(numbers[3]), self._start.distortion[1] + float(numbers[4])),
        )
        parts = numbers[LENS : LENS + 3 * (len(self._sheets) - 1)].reshape(-1, 3)
        poses = numbers[LENS + parts.size :].reshape(-1, 6)
        turns = Rotation.from_rotvec(poses[:, :3]).as_matrix()
        views = [View(turn, pose[3:]) for turn, pose in zip(turns, poses, strict=True)]
        return lens, dict(zip(self._sheets, [np.zeros(3), *parts], strict=True)), views

    def solve(self, start: np.ndarray) -> np.ndarray:
        """Numbers with the smallest loss, of the tries from a first guess."""
        best = (np.inf, start)
        for scales in RULES.scales:
            numbers, cost = start, np.inf
            for scale in scales:
                found = least_squares(
                    self.residuals,
                    numbers,
                    jac=self.jacobian,  # pyright: ignore[reportArgumentType] (a function)
                    loss="cauchy",
                    f_scale=scale,
                    x_scale="jac",
                    ftol=1e-8 if scale == scales[-1] else 1e-2,
                    max_nfev=60,
                )
                numbers, cost = found.x, float(found.cost)
            best = min(best, (cost, numbers), key=lambda one: one[0])
        return best[1]

    def _project_corners(self, numbers: np.ndarray) -> Pixels:
        lens, sheets, views = self.unpack(numbers)
        placed = np.array([sheets[sheet] for sheet in self._sheets])[self.sheet]
        c, s = np.cos(placed[:, 2]), np.sin(placed[:, 2])
        x, y = self._flat.T
        points: Space = np.column_stack([c * x - s * y + placed[:, 0], s * x + c * y + placed[:, 1], np.zeros(len(x))])
        turns = np.array([view.rotation for view in views])[self.photo]
        moves = np.array([view.translation for view in views])[self.photo]
        return lens.project(np.einsum("pij,pj->pi", turns, points) + moves)

    def residuals(self, numbers: np.ndarray) -> np.ndarray:
        """Distances of corners [pixels], then deviations of the lens in spreads."""
        away = (self._project_corners(numbers) - self._pixels).ravel()
        return np.concatenate([away, numbers[:LENS] / self._spreads])

    def jacobian(self, numbers: np.ndarray) -> np.ndarray:
        """Derivatives by central differences; numbers of all views are changed together, as they share no corner."""
        count = len(self._pixels)
        shared = len(numbers) - 6 * self._views
        derivatives = np.zeros((2 * count + LENS, len(numbers)))
        for column in range(shared + 6):
            step = np.zeros(len(numbers))
            size = 1e-2 if column in {1, 2} else 1e-6
            step[column if column < shared else slice(column, None, 6)] = size
            derivative = (self._project_corners(numbers + step) - self._project_corners(numbers - step)) / (2 * size)
            if column < shared:
                derivatives[: 2 * count, column] = derivative.ravel()
            else:
                rows = 2 * np.arange(count)
                for axis in (0, 1):
                    derivatives[rows + axis, column + 6 * self.photo] = derivative[:, axis]
        derivatives[2 * count + np.arange(LENS), np.arange(LENS)] = 1 / self._spreads
        return derivatives
