"""Tags that photographs are measured by: AprilTags of the family 36h11, on sheets of the board and at markers."""

import zlib
from functools import cache
from importlib.resources import files

import numpy as np

from hydrostat.arrays import Bool, Float
from hydrostat.errors import InputError
from hydrostat.robot import Robot

COLUMNS, ROWS = 5, 7
"""Tags of a sheet of the board."""

PITCH, SIDE = 36e-3, 27e-3
"""Distance of neighboring tags of a sheet from center to center, and side of their black square [m]."""

SHEETS = 4
"""Sheets that a board may have: those that lie around a robot that covers one."""

MARKER_SIDE = 15e-3
"""Side of the black square of a marker's tag, unless another is asked for [m]."""

CELLS = 8
"""Cells along the side of a tag's black square, with its black rim."""

ON_SHEET = COLUMNS * ROWS
FIRST_MARKER = SHEETS * ON_SHEET
MAX_MARKERS = 100

BOX = np.array([(-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5)])
"""Corners of a tag of side 1 about its center, y up, in the order in which they are found."""


@cache
def _codes() -> tuple[int, ...]:
    return tuple(int(line, 16) for line in (files("hydrostat.camera") / "tag36h11.txt").read_text().split())


def tag_cells(number: int) -> Bool[np.ndarray, "8 8"]:
    """White cells of a tag, from its upper left, with its black rim."""
    inner = CELLS - 2
    cells = np.zeros((CELLS, CELLS), dtype=bool)
    bits = [_codes()[number] >> (inner**2 - 1 - bit) & 1 for bit in range(inner**2)]
    cells[1:-1, 1:-1] = np.reshape(bits, (inner, inner))
    return cells


def marker_tags(robot: Robot) -> dict[str, int]:
    """Number of the tag of each marker; the first depends on the name of the robot, so that robots are told apart.

    Raises:
        InputError: a robot without markers, or with more than there are tags for.
    """
    if not robot.markers:
        raise InputError(f"{robot.name}: no [[marker]] in robot.toml. Add one for each point to measure.")
    if len(robot.markers) > MAX_MARKERS:
        raise InputError(f"{robot.name}: {len(robot.markers)} markers. Tags are for {MAX_MARKERS} or less.")
    first = FIRST_MARKER + zlib.crc32(robot.name.encode()) % (len(_codes()) - FIRST_MARKER - MAX_MARKERS + 1)
    return {marker.name: first + index for index, marker in enumerate(robot.markers)}


def sheet_of(number: int) -> int | None:
    """Sheet of the board that a tag is on, from 0; None for other tags."""
    return number // ON_SHEET if number < FIRST_MARKER else None


def board_corners(number: int) -> Float[np.ndarray, "4 2"]:
    """Corners of a tag of the board on its sheet [m], about the center of the sheet, y up."""
    row, column = divmod(number % ON_SHEET, COLUMNS)
    center = PITCH * np.array([column - (COLUMNS - 1) / 2, (ROWS - 1) / 2 - row])
    return center + SIDE * BOX
