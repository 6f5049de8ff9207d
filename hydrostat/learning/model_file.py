"""`save_model`, `load_model`: a learned model as one file, in which nothing is executed."""

from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.model_card import ModelCard
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.learning.portable_file import PortableFile


def save_model(model: LearnedModel, path: Path) -> Path:
    """Write a model whole, or not at all (InputError: it cannot be written)."""
    arrays = {name: getattr(model, name) for name in ("low", "high", "middle", "unit", "known", "reached")}
    for name in ("forward", "inverse"):
        network = getattr(model, name)
        if network is not None:
            arrays |= {f"{name}.sizes": network.sizes, f"{name}.numbers": network.numbers}
    return _FILE.write(path, model.card.as_json(), arrays)


def load_model(path: str | Path) -> LearnedModel:
    """A model that `save_model` has written.

    Raises:
        InputError: there is none, it was changed since it was written, or it is not one that this version can use.
    """
    return _FILE.read(path, _model)


def _model(facts: dict[str, Any], arrays: dict[str, np.ndarray]) -> LearnedModel:
    """The model of its parts (ValueError: they do not fit one another)."""
    card = ModelCard.from_json(facts)
    winches, coordinates = len(card.winches), card.coordinates
    expected = coordinates + len(card.cables)
    forward = Perceptrons.of(arrays, "forward", winches, expected)
    inverse = Perceptrons.of(arrays, "inverse", coordinates, winches) if "inverse.sizes" in arrays else None
    samples = len(arrays["known"])
    shapes = {"low": (winches,), "high": (winches,), "middle": (expected,), "unit": (expected,)}
    shapes |= {"known": (samples, winches), "reached": (samples, coordinates)}
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise ValueError(f"array {name} has a wrong size")
    if not (winches and coordinates and samples):
        raise ValueError("it has no winch, no marker or no sample")
    if (arrays["low"] > arrays["high"]).any() or (arrays["unit"] <= 0).any():
        raise ValueError("its ranges or units are empty")
    return LearnedModel(card=card, forward=forward, inverse=inverse, **{name: arrays[name] for name in shapes})


_KINDS: dict[str, tuple[str, int]] = dict.fromkeys(("low", "high", "middle", "unit"), ("<f8", 1))
_KINDS |= dict.fromkeys(("known", "reached", "forward.numbers", "inverse.numbers"), ("<f4", 2))
_KINDS |= dict.fromkeys(("forward.sizes", "inverse.sizes"), ("<i8", 1))
"""Type and number of axes of each array; networks are learned in float32."""

_FILE = PortableFile(magic=b"HSMODEL1", word="model", writer="hydrostat learn", kinds=_KINDS)
