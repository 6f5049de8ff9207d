"""`save_model`, `load_model`: a learned model as one file, in which nothing is executed."""

from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.learning.portable_file import PortableFile


def save_model(model: LearnedModel, path: Path) -> Path:
    """Write a model whole, or not at all (InputError: it cannot be written)."""
    arrays = {name: getattr(model, name) for name in ("low", "high", "middle", "unit", "known", "reached")}
    for name in ("forward", "inverse"):
        network = getattr(model, name)
        if network is not None:
            arrays |= {f"{name}.sizes": network.sizes, f"{name}.numbers": network.numbers}
    return _FILE.write(path, model.facts, arrays)


def load_model(path: str | Path) -> LearnedModel:
    """A model that `save_model` has written.

    Raises:
        InputError: there is none, it was changed since it was written, or it is not one that this version can use.
    """
    return _FILE.read(path, _model)


def _check_facts(facts: Mapping[str, Any]) -> None:
    """ValueError: a fact that a model is used by is none."""
    for name in ("winches", "markers", "cables"):
        if not all(isinstance(one, str) for one in facts[name]) or len(set(facts[name])) != len(facts[name]):
            raise ValueError(f"its {name} are no names")
    paired = [name for group in facts.get("pairs", ()) for name in group]
    if len(set(paired)) != len(paired) or not set(paired) <= set(facts["winches"]):
        raise ValueError("its pairs are none of its winches")
    if facts["dim"] not in {2, 3} or not all(isfinite(facts[one]) and facts[one] >= 0 for one in ("error", "size")):
        raise ValueError("its numbers are out of their ranges")
    told = [facts.get(one) for one in ("contact_distance", "contact_friction")]
    if not all(one is None or isfinite(one) for one in told):
        raise ValueError("its contact has no numbers")


def _model(facts: dict[str, Any], arrays: dict[str, np.ndarray]) -> LearnedModel:
    """The model of its parts (ValueError: they do not fit one another)."""
    _check_facts(facts)
    winches, coordinates = len(facts["winches"]), len(facts["markers"]) * facts["dim"]
    expected = coordinates + len(facts["cables"])
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
    return LearnedModel(facts=facts, forward=forward, inverse=inverse, **{name: arrays[name] for name in shapes})


_KINDS: dict[str, tuple[str, int]] = dict.fromkeys(("low", "high", "middle", "unit"), ("<f8", 1))
_KINDS |= dict.fromkeys(("known", "reached", "forward.numbers", "inverse.numbers"), ("<f4", 2))
_KINDS |= dict.fromkeys(("forward.sizes", "inverse.sizes"), ("<i8", 1))
"""Type and number of axes of each array; networks are learned in float32."""

_FACTS: Mapping[str, Any] = {
    "robot": str,
    "physics": str,
    "contact": bool,
    "dim": int,
    "size": (int, float),
    "error": (int, float),
    "winches": list,
    "markers": list,
    "cables": list,
}
"""Facts that a model is used by, and their kinds."""

_FILE = PortableFile(magic=b"HSMODEL1", word="model", writer="hydrostat learn", kinds=_KINDS, needs=_FACTS)
