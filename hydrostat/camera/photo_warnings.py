"""Warnings of what is likely to be wrong with photographs: texts, each a line."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from hydrostat.camera.calibrate_camera import CameraCalibration
from hydrostat.camera.find_tags import Corners
from hydrostat.camera.locate_tags import align_places, pairs_of
from hydrostat.camera.photo import Photo
from hydrostat.errors import InputError
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium


@dataclass(frozen=True)
class PhotoLimits:
    """Limits beyond which photographs get a warning."""

    misplaced: float = 0.35
    """Share of the corners of a sheet that may be elsewhere than its others say: tags that the robot half covers."""

    bent: float = 0.3e-3
    """Error of the board's corners [m] from which on it is bent."""

    missized: float = 0.015
    """Share by which tags of markers may look larger or smaller than they are."""

    shifted: float = 0.05
    """Shift of the frame in one photograph, as a share of the body's size, from which on the board has moved."""

    max_corner_error: float = 0.5
    """Error of corners that sharp photographs do not have [pixels]."""


LIMITS = PhotoLimits()


def find_missing(
    photos: Sequence[Photo],
    markers: Sequence[Mapping[str, Corners]],
    names: Mapping[str, int],
    rows: Sequence[Sequence[int]],
) -> list[str]:
    """Name markers without a tag in a row, or in all photographs."""
    never = [name for name in names if not any(name in found for found in markers)]
    texts = [
        f"{name}: its tag is in no photograph: hidden, blurred or mirrored. The table leaves it out." for name in never
    ]
    for row in rows:
        seen = {name for index in row for name in markers[index]}
        if gone := [name for name in names if name not in seen and name not in never]:
            texts.append(f"{photos[row[0]].name}: no tag of {', '.join(gone)}. Their cells stay empty.")
    return texts


def check_sheets(photos: Sequence[Photo], calibration: CameraCalibration) -> None:
    """Refuse photographs in which a sheet is elsewhere than the others say (InputError: one is)."""
    for (photo, sheet), share in calibration.wrong.items():
        if share > LIMITS.misplaced:
            raise InputError(
                f"{photos[photo].name}: the board is bent or its sheets have moved ({100 * share:.0f} % of the corners "
                f"of sheet {sheet + 1} are elsewhere). Glue sheets to a flat plate.{_few(photos)}"
            )


def _few(photos: Sequence[Photo]) -> str:
    """Other cause of a board that does not fit: too few photographs to find the lens; empty with enough of them."""
    enough = 3
    return "" if len(photos) >= enough else " Or the lens is not known from so few photographs: give three or more."


def warn_of_board(photos: Sequence[Photo], calibration: CameraCalibration, scale: float) -> list[str]:
    """Warn of photographs whose board is off by more than sharp ones."""
    return [
        f"{photo.name}: the board is off by {1e3 * error * scale:.2f} mm ({error:.2f} pixels). It is bent or "
        f"printed in different sizes.{_few(photos)}"
        for photo, error in zip(photos, calibration.errors, strict=True)
        if error * scale > LIMITS.bent and error > LIMITS.max_corner_error
    ]


def warn_of_tags(photos: Sequence[Photo], misfits: Sequence[Mapping[str, float]]) -> list[str]:
    """Warn of tags that are no squares, by their misfits [pixels]."""
    return [
        f"{photo.name}: the tag of {name} is no square ({misfit:.1f} pixels). It is bent, tilted or half covered."
        for photo, each in zip(photos, misfits, strict=True)
        for name, misfit in each.items()
        if misfit > LIMITS.max_corner_error
    ]


def warn_of_sizes(sides: list[float], side: float, height: float, calibration: CameraCalibration) -> list[str]:
    """Warn if tags look larger or smaller than they are: their height or their print is another."""
    share = median(sides) / side
    if abs(share - 1) < LIMITS.missized:
        return []
    away = median(float(-(view.rotation.T @ view.translation)[2]) for view in calibration.views)
    likely = away - (away - height) / share
    other = f", or they lie {1e3 * likely:.0f} mm high" if likely >= 0 else ""
    return [
        f"tags of markers measure {1e3 * median(sides):.2f} mm at a height of {1e3 * height:.1f} mm, not "
        f"{1e3 * side:.2f} mm. Check --height and --tag{other}."
    ]


def warn_of_frame(
    robot: Robot,
    photos: Sequence[Photo],
    found: Sequence[Mapping[str, np.ndarray]],
    poses: Sequence[Equilibrium | None],
    frame: tuple[np.ndarray, np.ndarray],
) -> list[str]:
    """Warn of photographs that fit the robot much better with a frame of their own."""
    texts = []
    turn, shift = frame
    for photo, each, pose in zip(photos, found, poses, strict=True):
        if pose is None:
            texts.append(f"{photo.name}: the simulated robot reaches no equilibrium at these contractions.")
            continue
        places, targets = pairs_of(each, pose.markers)
        if len(photos) < 3 or len(places) <= robot.body.mesh.dim:
            continue
        own_turn, own_shift = align_places(places, targets)
        common = np.sqrt(((places @ turn.T + shift - targets) ** 2).sum(axis=1).mean())
        own = np.sqrt(((places @ own_turn.T + own_shift - targets) ** 2).sum(axis=1).mean())
        if common > max(LIMITS.shifted * robot.body.mesh.size, 4 * own):
            texts.append(f"{photo.name}: board or robot moved by about {1e3 * common:.0f} mm since other photographs.")
    return texts
