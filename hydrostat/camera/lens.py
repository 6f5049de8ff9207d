"""`Lens`, `View`, `LensFile`: a camera, its position over the board, its file."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.files import read_stranger

Pixels = Float[np.ndarray, "points 2"]
Space = Float[np.ndarray, "points 3"]


@dataclass(frozen=True)
class Lens:
    """Pinhole camera with radial distortion, the same for all photographs.

    Attributes:
        focal: focal length [pixels].
        center: principal point [pixels].
        distortion: coefficients of the second and fourth power of the distance from the axis.
    """

    focal: float
    center: tuple[float, float]
    distortion: tuple[float, float]

    def project(self, points: Space) -> Pixels:
        """Pixels of points in the frame of the camera: x right, y down, z ahead."""
        flat = points[:, :2] / points[:, 2:]
        squared = (flat**2).sum(axis=1, keepdims=True)
        first, second = self.distortion
        return self.focal * flat * (1 + first * squared + second * squared**2) + np.array(self.center)

    def rays(self, pixels: Pixels) -> Space:
        """Directions of pixels in the frame of the camera, with z = 1."""
        bent = (pixels - np.array(self.center)) / self.focal
        first, second = self.distortion
        flat = bent
        for _ in range(20):
            squared = (flat**2).sum(axis=1, keepdims=True)
            flat = bent / (1 + first * squared + second * squared**2)
        return np.column_stack([flat, np.ones(len(flat))])


@dataclass(frozen=True, eq=False)
class View:
    """Frame of the board as one photograph shows it.

    Attributes:
        rotation: from the frame of the board to that of the camera.
        translation: place of the board's origin in the frame of the camera [m].
    """

    rotation: Float[np.ndarray, "3 3"]
    translation: Float[np.ndarray, " 3"]

    def to_camera(self, points: Space) -> Space:
        """Points of the board's frame in that of the camera."""
        return points @ self.rotation.T + self.translation

    def meet_plane(self, rays: Space, height: float) -> Space:
        """Points where rays of the camera meet the plane at a height above the board [m], in the board's frame."""
        eye = -self.rotation.T @ self.translation
        directions = rays @ self.rotation
        return eye + directions * ((height - eye[2]) / directions[:, 2])[:, None]


SHAPE = 0.002
"""Relative difference of the sides' ratio from which on pictures are cropped."""


@dataclass(frozen=True, kw_only=True)
class LensFile:
    """Lens calibration, with the size of its pictures.

    Attributes:
        lens: camera model.
        size: width and height of its pictures [pixels].
        name: name of the file, for messages.
    """

    lens: Lens
    size: tuple[int, int]
    name: str = field(default="lens", compare=False)

    def text(self) -> bytes:
        """Return the text of the file."""
        told = {"about": "Lens of a camera by hydrostat measure, in pixels.", "size": self.size, **asdict(self.lens)}
        return (json.dumps(told, indent=1) + "\n").encode()

    def scale_to(self, size: tuple[int, int]) -> Lens:
        """Return the lens for pictures of another size with the same view (InputError: cropped pictures)."""
        (width, height), (own_width, own_height) = size, self.size
        if abs(width * own_height / (height * own_width) - 1) > SHAPE:
            raise InputError(
                f"{self.name}: is of pictures of {own_width} x {own_height} pixels, not {width} x {height}. Use the "
                "same camera and format."
            )
        times = width / own_width
        shift = (times - 1) / 2  # centers of pixels are whole numbers
        x, y = self.lens.center
        return Lens(times * self.lens.focal, (times * x + shift, times * y + shift), self.lens.distortion)

    @classmethod
    def read(cls, file: Path) -> "LensFile":
        """Read a lens from a file (InputError: not a lens file)."""
        try:
            told = json.loads(read_stranger(file, most=100_000))
            numbers = np.array([told["focal"], *told["center"], *told["distortion"]], dtype=float)
            width, height = (int(side) for side in told["size"])
            if numbers.shape != (5,) or not np.isfinite(numbers).all() or min(width, height, numbers[0]) <= 0:
                raise ValueError
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            raise InputError(f"{file}: is no lens. Give the .lens.json that `hydrostat measure` wrote.") from None
        focal, x, y, first, second = numbers.tolist()
        return cls(lens=Lens(focal, (x, y), (first, second)), size=(width, height), name=str(file))
