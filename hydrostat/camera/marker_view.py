"""`MarkerView`: a fixed camera before a robot on its board."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.camera.calibrate_camera import calibrate_camera
from hydrostat.camera.find_tags import Corners, Gray, find_tags
from hydrostat.camera.locate_tags import align_places, locate_in_space, locate_on_plane, pairs_of
from hydrostat.camera.measure_photos import MIN_TAGS, PhotoOptions
from hydrostat.camera.tags import marker_tags, sheet_of
from hydrostat.errors import InputError
from hydrostat.simulation import Equilibrium
from hydrostat.units import plural

MOVED = 3.0
"""Shift of the board at which the camera or the board counts as moved [pixels]."""


class MarkerView:
    """Fixed camera before a robot on its board: places of markers in each frame."""

    def __init__(
        self,
        frames: Sequence[Gray],
        pose: Equilibrium,
        options: PhotoOptions | None = None,
        *,
        name: str = "--camera",
    ) -> None:
        """Calibrate the camera by frames of a robot that stands in a simulated pose.

        Args:
            frames: frames in which nothing moves.
            pose: simulated pose of the robot in them.
            options: numbers that frames do not show.
            name: name of the camera, for messages.

        Raises:
            InputError: too few tags of the board or of markers.
        """
        robot, self._options = pose.robot, options or PhotoOptions()
        self._name = name.removeprefix("--")
        self._numbers, self._dim = marker_tags(robot), robot.body.mesh.dim
        found = [find_tags(pixels, self._name) for pixels in frames]
        tags = {
            number: np.mean([each[number] for each in found], axis=0)
            for number in set.intersection(*(set(each) for each in found))
        }
        self._board = {number: corners for number, corners in tags.items() if sheet_of(number) is not None}
        if len(self._board) < MIN_TAGS:
            raise InputError(
                f"{name}: {plural(len(self._board), 'tag')} of the board in sight. Show at least {MIN_TAGS} whole "
                "tags, in focus."
            )
        size = (frames[0].shape[1], frames[0].shape[0])
        known = self._options.lens and self._options.lens.scale_to(size)
        calibration = calibrate_camera([tags], size, known=known)
        self._lens, self._view = calibration.lens, calibration.views[0]
        thickness = robot.body.thickness or 0.0
        self._height = thickness if self._options.height is None else self._options.height
        self._turn, self._shift = np.eye(self._dim), np.zeros(self._dim)
        places, targets = pairs_of(self._locate(tags), pose.markers)
        if len(places) < self._dim:
            raise InputError(
                f"{name}: {plural(len(places), 'marker')} of {robot.name} in sight. Show at least {self._dim}."
            )
        self._turn, self._shift = align_places(places, targets)

    def find(self, pixels: Gray) -> dict[str, Vector]:
        """Places of the markers in sight, in the frame of the robot [m].

        Raises:
            InputError: a tag is there twice, or the camera or the board has moved.
        """
        tags = find_tags(pixels, self._name, refine=self._numbers.values())
        both = [number for number in self._board if number in tags]
        moved = [np.linalg.norm((tags[number] - self._board[number]).mean(axis=0)) for number in both]
        if both and np.median(moved) > MOVED:
            raise InputError(f"{self._name}: the camera or the board has moved")
        return self._locate(tags)

    def _locate(self, tags: Mapping[int, Corners]) -> dict[str, Vector]:
        found = {}
        for name, number in self._numbers.items():
            if number in tags:
                if self._dim == 2:
                    at = locate_on_plane(tags[number], self._lens, self._view, self._height)[0][:2]
                else:
                    at = locate_in_space([(tags[number], self._view)], self._lens, self._options.side)[0]
                found[name] = self._turn @ at + self._shift
        return found
