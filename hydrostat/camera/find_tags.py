"""`find_tags`: tags in a photograph, with their corners to a few hundredths of a pixel."""

from collections.abc import Container
from typing import Any

import numpy as np

from hydrostat.arrays import Float, UInt8
from hydrostat.camera.tags import CELLS
from hydrostat.errors import InputError
from hydrostat.version import install_command

Gray = UInt8[np.ndarray, "height width"]
"""Brightness of the pixels of a photograph."""

Corners = Float[np.ndarray, "4 2"]
"""Corners of a tag in a photograph [pixels], clockwise from the upper left of the tag."""


def load_opencv() -> Any:
    """OpenCV, which an extra brings (InputError: it is not installed)."""
    try:
        import cv2  # pyright: ignore[reportMissingImports] (an extra)
    except ImportError as error:
        raise InputError(f"photographs need OpenCV ({error}): {install_command('photos')}") from None
    return cv2


def find_tags(pixels: Gray, where: str, *, refine: Container[int] | None = None) -> dict[int, Corners]:
    """Tags in a photograph by their numbers.

    Args:
        pixels: brightness of the photograph.
        where: name of the photograph, for messages.
        refine: numbers of the tags whose corners are refined; all if left out.

    Raises:
        InputError: a tag that is there twice, or a mirrored photograph.
    """
    found = _detect(pixels)
    numbers = [number for number, _ in found]
    if twice := sorted({number for number in numbers if numbers.count(number) > 1}):
        raise InputError(f"{where}: tag {twice[0]} is there {numbers.count(twice[0])} times. Cover or remove copies.")
    if len(found) < 2 and len(mirrored := _detect(np.ascontiguousarray(pixels[:, ::-1]))) > max(1, len(found)):
        raise InputError(
            f"{where}: the photograph is mirrored ({len(mirrored)} tags). Turn off mirroring, as of a front camera."
        )
    bright = (pixels / np.float32(255.0)) ** np.float32(2.2)  # light, of which blur is a mean
    return {
        number: _refine_corners(bright, corners) if refine is None or number in refine else corners
        for number, corners in found
    }


def _detect(pixels: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Numbers and corners of tags, to about a pixel."""
    cv2 = load_opencv()
    options = cv2.aruco.DetectorParameters()
    options.minMarkerPerimeterRate = 0.01
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    corners, numbers, _ = cv2.aruco.ArucoDetector(family, options).detectMarkers(pixels)
    if numbers is None:
        return []
    return [
        (int(number), one.reshape(4, 2).astype(float)) for number, one in zip(numbers.ravel(), corners, strict=True)
    ]


ROUNDS = 2
"""Times that the edges are looked for, each about the corners found before."""


def _refine_corners(bright: np.ndarray, corners: Corners) -> Corners:
    """Corners where lines through the edges of a tag's black square meet; as they were where an edge is not clear."""
    side = float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min())
    for _ in range(ROUNDS):
        lines = [_edge_line(bright, corners[i], corners[(i + 1) % 4]) for i in range(4)]
        if any(line is None for line in lines):
            return corners
        found = np.array([_cross(lines[i - 1], lines[i]) for i in range(4)])
        if not np.isfinite(found).all() or np.linalg.norm(found - corners, axis=1).max() > 2 + _reach(side):
            return corners
        corners = found
    return corners


def _reach(side: float) -> float:
    """Distance from an edge of some length that is looked at [pixels]: less than a cell of the tag."""
    return float(np.clip(0.75 * side / CELLS, 1.5, 5.0))


def _edge_line(bright: np.ndarray, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Point and direction of the line along an edge, from where the brightness crosses half between black and white."""
    from scipy.ndimage import map_coordinates

    side = float(np.linalg.norm(end - start))
    along = (end - start) / side
    outward = np.array([along[1], -along[0]])
    reach = _reach(side)
    shares = np.linspace(0.06, 0.94, int(np.clip(side, 12, 80)))
    depths = np.linspace(-reach, reach, int(8 * reach) + 1)
    feet = start + np.outer(shares * side, along)
    points = feet[:, None] + depths[:, None] * outward
    seen = map_coordinates(bright, [points[..., 1], points[..., 0]], order=1, mode="nearest")
    ends = max(2, len(depths) // 6)
    black, white = np.median(seen[:, :ends], axis=1), np.median(seen[:, -ends:], axis=1)
    clear = white - black > 0.25 * max(float(np.median(white - black)), 1e-3)
    level = 0.5 * (black + white)[:, None]
    crossing = (seen[:, :-1] < level) & (seen[:, 1:] >= level)
    nearest = np.where(crossing, np.abs(depths[:-1]), np.inf)
    index = nearest.argmin(axis=1)
    clear &= np.isfinite(nearest.min(axis=1))
    if clear.sum() < 6:
        return None
    rows = np.flatnonzero(clear)
    low, high = seen[rows, index[rows]], seen[rows, index[rows] + 1]
    step = depths[1] - depths[0]
    depth = depths[index[rows]] + step * (level[rows, 0] - low) / np.maximum(high - low, 1e-9)
    return _fit_line(feet[rows] + depth[:, None] * outward)


def _fit_line(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle and direction of the line through points, without those far from it."""
    middle, direction = _line_through(points)
    for _ in range(2):
        away = np.abs((points - middle) @ np.array([direction[1], -direction[0]]))
        near = away <= max(3 * float(np.median(away)), 0.05)
        if near.all() or near.sum() < 6:
            break
        points = points[near]
        middle, direction = _line_through(points)
    return middle, direction


def _line_through(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    middle = points.mean(axis=0)
    return middle, np.linalg.svd(points - middle, full_matrices=False)[2][0]


def _cross(one: Any, other: Any) -> np.ndarray:
    """Point in which two lines meet."""
    (p, d), (q, e) = one, other
    turn = d[0] * e[1] - d[1] * e[0]
    if abs(turn) < 0.1:
        return np.full(2, np.nan)
    return p + d * (((q - p)[0] * e[1] - (q - p)[1] * e[0]) / turn)
