"""`LensFile`: the lens that photographs of a camera showed, for its next ones."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from hydrostat.camera.lens import Lens
from hydrostat.errors import InputError
from hydrostat.files import read_stranger

SHAPE = 0.002
"""Relative difference of the sides' ratio from which on pictures are cropped."""


@dataclass(frozen=True, kw_only=True)
class LensFile:
    """A lens and the size of the pictures that it made.

    Attributes:
        lens: the camera.
        size: width and height of its pictures [pixels].
        name: name of the file, for messages.
    """

    lens: Lens
    size: tuple[int, int]
    name: str = field(default="lens", compare=False)

    def text(self) -> bytes:
        """Text of its file."""
        told = {"about": "Lens of a camera by hydrostat measure, in pixels.", "size": self.size, **asdict(self.lens)}
        return (json.dumps(told, indent=1) + "\n").encode()

    def scale_to(self, size: tuple[int, int]) -> Lens:
        """Lens for pictures of another size with the same view (InputError: they are cropped)."""
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
        """Lens of a file (InputError: it is none)."""
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
