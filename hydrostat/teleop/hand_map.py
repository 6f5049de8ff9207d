"""`HandMap`: fitted map of a hand, as a file: from sensors to contractions or fingertip positions."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.files import replace_file
from hydrostat.teleop.ridge import Ridge

FORMAT = "hydrostat hand map 1"


@dataclass(frozen=True, kw_only=True, eq=False)
class HandMap:
    """Linear map from the sensors of a hand to the channels of a robot.

    Attributes:
        robot: robot name.
        sensors: sensor names.
        outputs: channel names.
        ridge: ridge regression from sensors to channels [m].
        poses: number of mimicked poses.
        error: root-mean-square error of held-out poses [m].
    """

    robot: str
    sensors: tuple[str, ...]
    outputs: tuple[str, ...]
    ridge: Ridge
    poses: int
    error: float

    def __call__(self, sensors: Vector) -> dict[str, float]:
        """Return the channel values [m]."""
        return dict(zip(self.outputs, self.ridge(sensors).tolist(), strict=True))

    def check(self, sensors: tuple[str, ...], channels: tuple[str, ...]) -> None:
        """Check that the map fits a hand and a robot (InputError: other sensors, or other channels)."""
        if self.sensors != sensors:
            raise InputError(f"--map: it was learned of {len(self.sensors)} sensors of another kind of hand")
        if self.outputs != channels:
            raise InputError(
                f"--map: it was learned of {self.robot} for {', '.join(self.outputs[:3])} ..., and here are "
                f"{', '.join(channels[:3])} ...: use --markers as `hydrostat mimic` did, and the same robot"
            )

    def save(self, path: Path) -> Path:
        """Write the map as JSON, atomically; return the path."""
        ridge = self.ridge
        table = {
            "format": FORMAT,
            "robot": self.robot,
            "poses": self.poses,
            "error_m": self.error,
            "sensors": self.sensors,
            "outputs": self.outputs,
            "centre": ridge.center.tolist(),
            "level_m": ridge.level.tolist(),
            "weights_m": ridge.weights.tolist(),
            "penalty": ridge.penalty,
        }
        return replace_file(path, (json.dumps(table, indent=1) + "\n").encode())

    @classmethod
    def open(cls, path: Path) -> "HandMap":
        """Read a map from a file (InputError: not a hand map)."""
        try:
            table = json.loads(path.read_text("utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot be read ({error}); `hydrostat mimic` makes it") from None
        try:
            if table["format"] != FORMAT:
                raise ValueError(f"its format is {table['format']!r}, not {FORMAT!r}")
            center, level, weights = (np.array(table[key], float) for key in ("centre", "level_m", "weights_m"))
            ridge = Ridge(center, level, weights, table["penalty"])
            sensors, outputs = tuple(map(str, table["sensors"])), tuple(map(str, table["outputs"]))
            shapes = ridge.center.shape, ridge.level.shape, ridge.weights.shape
            if shapes != ((len(sensors),), (len(outputs),), (len(sensors), len(outputs))):
                raise ValueError("its numbers are not as many as its names")
            if not all(np.isfinite(each).all() for each in (ridge.center, ridge.level, ridge.weights)):
                raise ValueError("some of its numbers are not finite")
            return cls(
                robot=str(table["robot"]),
                sensors=sensors,
                outputs=outputs,
                ridge=ridge,
                poses=int(table["poses"]),
                error=float(table["error_m"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"{path}: is no map of a hand ({error}); `hydrostat mimic` makes it") from None
