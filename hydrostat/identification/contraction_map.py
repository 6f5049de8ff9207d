"""`ContractionMap`: contractions that a model needs for those that are commanded, from a file or a fit."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.errors import InputError
from hydrostat.files import read_stranger
from hydrostat.robot import Robot

FILE = "correction.json"
"""Its file in a robot folder."""

BOUND = 0.2
"""Largest change of a contraction, as a share of the winch's travel."""

ROUNDS = 20
"""Steps of the inverse of a map."""

INEXACT = 1e-3
"""Largest error of the inverse, as a share of the travel."""

LENGTH_TOLERANCE = 5e-4
"""Difference of lengths below which travel and cables are those of the robot that was measured [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContractionMap:
    """Quadratic map from commanded contractions to those at which the model shows what the robot does.

    Attributes:
        winches: names of the winches.
        travel: travel of each [m].
        lengths: rest length of each cable of the robot that was measured [m].
        weights: change of each contraction, as a share of its travel, by `features` of all.
        before: root mean square distance of held-out markers without the map [m].
        after: the same with it [m].
    """

    winches: tuple[str, ...]
    travel: Vector
    lengths: Vector
    weights: Float[np.ndarray, "features winches"]
    before: float
    after: float

    def effective(self, commands: Float[np.ndarray, "... winches"]) -> Float[np.ndarray, "... winches"]:
        """Contractions of the model for commanded ones [m]."""
        change = np.clip(features(commands / self.travel) @ self.weights, -BOUND, BOUND)
        return commands + self.travel * change

    def command(self, contractions: Float[np.ndarray, "... winches"]) -> Float[np.ndarray, "... winches"]:
        """Contractions to command for those of the model [m], by fixed-point steps."""
        commands = contractions
        for _ in range(ROUNDS):
            commands = contractions - (self.effective(commands) - commands)
        return commands

    @property
    def is_invertible(self) -> bool:
        """True if `command` inverts `effective` within the travel, tried at 500 random contractions."""
        shares = np.random.default_rng(0).uniform(size=(500, len(self.travel)))
        missed = self.effective(self.command(shares * self.travel)) / self.travel - shares
        return bool(np.abs(missed).max(initial=0.0) < INEXACT)

    def text(self) -> bytes:
        """Text of its file."""
        told = {
            "about": "Correction of contractions by hydrostat identify.",
            "winches": list(self.winches),
            "travel_m": self.travel.tolist(),
            "cable_lengths_m": self.lengths.tolist(),
            "weights": self.weights.tolist(),
            "held_out_before_m": self.before,
            "held_out_after_m": self.after,
        }
        return (json.dumps(told, indent=1) + "\n").encode()

    @classmethod
    def read(cls, folder: Path, robot: Robot) -> "ContractionMap | None":
        """Map of a robot folder; None if it has none (InputError: a file that is no such map, or of other winches)."""
        file = folder / FILE
        if not file.exists():
            return None
        names = tuple(winch.name for winch in robot.winches)
        try:
            told = json.loads(read_stranger(file, most=1_000_000))
            winches, weights = tuple(told["winches"]), np.array(told["weights"], dtype=float)
            travel, lengths = (np.array(told[name], dtype=float) for name in ("travel_m", "cable_lengths_m"))
            errors = float(told["held_out_before_m"]), float(told["held_out_after_m"])
        except (ValueError, KeyError, TypeError, RecursionError):
            raise InputError(f"{file}: is no correction. Remove it, or run `hydrostat identify` again.") from None
        if winches != names:
            raise InputError(f"{file}: is for the winches {', '.join(map(str, winches))[:60]}. Remove it.")
        count = len(names)
        shape = (len(features(np.zeros(count))), count)
        if weights.shape != shape or travel.shape != (count,) or not np.isfinite([*weights.ravel(), *travel]).all():
            raise InputError(f"{file}: is no correction. Remove it, or run `hydrostat identify` again.")
        if not (travel > 0).all():
            raise InputError(f"{file}: travel_m must be above 0. Remove it, or run `hydrostat identify` again.")
        own = np.array([winch.travel for winch in robot.winches]), cable_lengths(robot)
        for one, other in zip((travel, lengths), own, strict=True):
            if one.shape != other.shape or not (np.abs(one - other) < LENGTH_TOLERANCE).all():
                raise InputError(
                    f"{file}: is for other cables or travel. Remove it, or run `hydrostat identify` again."
                )
        found = cls(winches=winches, travel=travel, lengths=lengths, weights=weights, before=errors[0], after=errors[1])
        if not found.is_invertible:
            raise InputError(f"{file}: cannot be inverted. Remove it, or run `hydrostat identify` again.")
        return found


def cable_lengths(robot: Robot) -> Vector:
    """Rest length of each cable [m]."""
    return np.array([cable.length for cable in robot.cables])


def features(shares: Float[np.ndarray, "... winches"]) -> Float[np.ndarray, "... features"]:
    """Contractions as shares of the travel, and their products."""
    one, other = np.triu_indices(shares.shape[-1])
    return np.concatenate([shares, shares[..., one] * shares[..., other]], axis=-1)
