"""`Photo`: a photograph with the contractions and hung masses of its pose; reading them from names and tables."""

import csv
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hydrostat.arrays import UInt8
from hydrostat.camera.find_tags import Gray
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.robot import Load, Robot, Winch
from hydrostat.units import LENGTH, MASS, MM, parse_quantity

if TYPE_CHECKING:
    from PIL import Image

FULL_FRAME = 43.27
"""Diagonal of the film that focal lengths in photographs are converted to [mm]."""

MAX_PIXELS = 100_000_000
"""Pixels that a photograph may have."""


@dataclass(frozen=True, kw_only=True)
class Photo:
    """Photograph of a pose.

    Attributes:
        file: path of the photograph.
        contractions: contractions of winches [m]; 0 for other winches.
        masses: masses hung at markers [kg].
        loads: other loads, which a table cannot contain.
        step: index of the pose in a motion, which separates equal contractions on the way up and down; None without
            one.
    """

    file: Path
    contractions: Mapping[str, float]
    masses: Mapping[str, float]
    loads: tuple[Load, ...] = ()
    step: int | None = None

    @property
    def name(self) -> str:
        """File name."""
        return self.file.name

    @property
    def pose(self) -> tuple[object, ...]:
        """Step, contractions and loads, which all photographs of a pose share."""
        pulls = sorted((name, value) for name, value in self.contractions.items() if value)
        return (self.step, *pulls, *self.loads_of_pose)

    @property
    def loads_of_pose(self) -> tuple[Load, ...]:
        """All loads of the pose."""
        masses = sorted((name, mass) for name, mass in self.masses.items() if mass > 0)
        return (*(Load(name=f"measured {name}", marker=name, mass=mass) for name, mass in masses), *self.loads)

    @staticmethod
    def read_all(files: Sequence[Path], robot: Robot, table: Path | None = None) -> "list[Photo]":
        """Return photographs with contractions from file names, such as "left=12mm,right=0mm.jpg", or from a table.

        A name can also have hung masses, such as "tip=100g"; begin with the step of a motion, such as "03 "; and end
        with a number in parentheses, such as " (2)", for more photographs of one pose.
        Photographs with steps are sorted by step.

        Raises:
            InputError: a photograph without contractions, an unknown winch or marker, or a file listed twice.
        """
        if not files:
            raise InputError("no photographs. Name at least one file.")
        names = [file.name for file in files]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError(f"{twice[0]}: two photographs have this name. Rename one.")
        named = [_with_name(file, robot) for file in files] if table is None else _with_table(files, robot, table)
        return sorted(named, key=lambda photo: photo.step or 0)


_POSE_NAME = re.compile(r"\s*(?:(\d{1,9})\s+)?(.*?)\s*(?:\(\d+\))?", re.DOTALL)


def _with_name(file: Path, robot: Robot) -> Photo:
    number, words = _POSE_NAME.fullmatch(file.stem).groups()  # type: ignore[union-attr]
    first = file.stem.partition("=")[0].strip()
    if any(part.name == first for part in (*robot.winches, *robot.markers)):  # a name that begins with a number
        number, words = None, f"{number} {words}" if number else words
    step = None if number is None else int(number)
    if words == "rest":
        return Photo(file=file, contractions={}, masses={}, step=step)
    contractions, masses = {}, {}
    for part in words.split(","):
        name, equals, value = (each.strip() for each in part.partition("="))
        if not equals:
            raise InputError(
                f"{file.name}: the name holds no contractions. Rename it like {_example(robot)}, rest.jpg, or give "
                "--table."
            )
        _sort(f"{file.name}", name, value, robot, contractions, masses)
    return Photo(file=file, contractions=contractions, masses=masses, step=step)


def _example(robot: Robot) -> str:
    return ",".join(f"{winch.name}=12mm" for winch in robot.winches[:2]) + ".jpg"


def _sort(
    where: str, name: str, value: str, robot: Robot, contractions: dict[str, float], masses: dict[str, float]
) -> None:
    """Put a length to the contractions, a mass to the masses."""
    winches, markers = [winch.name for winch in robot.winches], [marker.name for marker in robot.markers]
    if name in contractions or name in masses:
        raise InputError(f"{where}: {name} is given twice. Give it once.")
    try:
        if name in winches and not (name in markers and value.endswith("g")):
            sign = -1.0 if value.startswith("-") else 1.0
            contractions[name] = sign * parse_quantity(value.removeprefix("-"), LENGTH)
            _check_travel(robot.winch(name), contractions[name])
        elif name in markers:
            masses[name] = parse_quantity(value, MASS)
        else:
            allowed = ", ".join(winches + [f"{marker} (a mass)" for marker in markers])
            raise InputError(f'unknown winch "{name[:60]}". Available: {allowed}.')
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _check_travel(winch: Winch, contraction: float) -> None:
    """Check that a contraction is within about the travel of a winch (InputError: a wrong unit)."""
    if abs(contraction) > TRAVELS * winch.travel:
        raise InputError(
            f"{winch.name} contracts by {contraction / MM:.0f} mm, but its travel is {winch.travel / MM:.0f} mm. "
            "Check the unit."
        )


TRAVELS = 2
"""Contractions over the travel of their winch from which on their unit is wrong."""


def _with_table(files: Sequence[Path], robot: Robot, table: Path) -> list[Photo]:
    """Photographs with the rows of a table: columns photo, step, left_mm per winch, tip_load_g per marker."""
    try:
        rows = list(csv.reader(StringIO(read_stranger(table, most=10_000_000).decode("utf-8-sig"), newline="")))
    except (UnicodeDecodeError, csv.Error):
        raise InputError(f"{table}: cannot be read as a table; save it as CSV in UTF-8") from None
    head = [cell.strip() for cell in rows[0]] if rows else []
    if "photo" not in head:
        columns = ", ".join(f"{winch.name}_mm" for winch in robot.winches[:2]) or "columns of hung masses"
        raise InputError(f'{table}: no column "photo". Write photo, then {columns} and so on.')
    found: dict[str, Photo] = {}
    for line, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        where = f"{table}, line {line}"
        if len(row) != len(head):
            raise InputError(f"{where}: {len(row)} cells, but there are {len(head)} columns")
        name = row[head.index("photo")].strip()
        if name in found:
            raise InputError(f"{where}: {name} has two rows. Keep one.")
        found[name] = _with_row(where, name, dict(zip(head, row, strict=True)), robot)
    if missing := [file.name for file in files if file.name not in found]:
        raise InputError(f"{missing[0]}: no row in {table}. Add one with its contractions.")
    return [replace(found[file.name], file=file) for file in files]


def _with_row(where: str, name: str, cells: Mapping[str, str], robot: Robot) -> Photo:
    """Photograph with the cells of its row by column."""
    contractions: dict[str, float] = {}
    masses: dict[str, float] = {}
    step = None
    for column, cell in cells.items():
        if column == "photo" or not cell.strip():
            continue
        if column == "step":
            if re.fullmatch(r"\s*[0-9]{1,9}\s*", cell) is None:
                raise InputError(f'{where}: step must be a whole number, not "{cell[:60]}"')
            step = int(cell)
            continue
        for end, unit in (("_load_g", "g"), ("_mm", "mm")):
            if column.endswith(end):
                _sort(where, column.removesuffix(end), f"{cell.strip()} {unit}", robot, contractions, masses)
                break
        else:
            raise InputError(f'{where}: unknown column "{column[:60]}". Write WINCH_mm, MARKER_load_g or step.')
    return Photo(file=Path(name), contractions=contractions, masses=masses, step=step)


def read_pixels(file: Path) -> tuple[Gray, float | None]:
    """Brightness of the pixels of a photograph, as its sensor lies, and its focal length [pixels] if the file says it.

    Raises:
        InputError: a file that is no picture.
    """
    with _open(file) as picture:
        focal = picture.getexif().get_ifd(0x8769).get(0xA405)  # of film of 35 mm with the same view
        diagonal = float(np.hypot(*picture.size))
        pixels = np.asarray(picture.convert("L"))
    try:
        length = float(focal or 0.0)
    except (TypeError, ValueError):  # what a camera wrote is no number
        length = 0.0
    return pixels, length / FULL_FRAME * diagonal if 0.0 < length < np.inf else None


def read_colors(file: Path) -> UInt8[np.ndarray, "height width 3"]:
    """Read the pixel colors of a photograph in sensor orientation (InputError: not a picture)."""
    with _open(file) as picture:
        return np.asarray(picture.convert("RGB"))


def _open(file: Path) -> "Image.Image":
    from PIL import Image, UnidentifiedImageError  # Imported here: --print needs no picture.

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            picture = Image.open(file)
            if picture.size[0] * picture.size[1] > MAX_PIXELS:
                raise InputError(f"{file}: more than {MAX_PIXELS // 1_000_000} megapixels. Save it smaller.")
            picture.load()
    except FileNotFoundError:
        raise InputError(f"{file}: no such file") from None
    except (UnidentifiedImageError, Image.DecompressionBombError, OSError, SyntaxError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else "not a picture that can be read"
        raise InputError(f"{file}: {reason}. Save it as JPEG or PNG.") from None
    return picture
