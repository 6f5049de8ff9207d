"""`save_model`, `load_model`: a learned model as one file, in which nothing is executed.

The file: the eight bytes `HSMODEL1`; the length of the header, as eight bytes, little-endian; the header, JSON, with
the facts and with name, type and shape of each array; the arrays, one after another, little-endian; SHA-256 of all
before it.
"""

import hashlib
import json
from collections.abc import Mapping
from math import isfinite, prod
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning.learned_model import LearnedModel
from hydrostat.learning.perceptrons import Perceptrons
from hydrostat.robot import replace_file


def save_model(model: LearnedModel, path: Path) -> Path:
    """Write a model whole, or not at all (InputError: it cannot be written)."""
    arrays = {name: np.ascontiguousarray(value, dtype) for name, (dtype, value) in _arrays(model).items()}
    table = [[name, value.dtype.str, list(value.shape)] for name, value in arrays.items()]
    header = json.dumps({"facts": model.facts, "arrays": table}).encode()
    content = b"".join([_MAGIC, len(header).to_bytes(8, "little"), header, *(one.tobytes() for one in arrays.values())])
    return replace_file(Path(path), content + hashlib.sha256(content).digest())


def load_model(path: Path) -> LearnedModel:
    """A model that `save_model` has written.

    Raises:
        InputError: there is none, it was changed since it was written, or it is not one that this version can use.
    """
    path = Path(path)
    try:
        if path.stat().st_size > _MOST:
            raise InputError(f"{path}: is larger than any model, {_MOST // 10**6} MB")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); name a file that hydrostat learn wrote") from None
    if not content.startswith(_MAGIC):
        raise InputError(f"{path}: is no model of this version of hydrostat; name a file that hydrostat learn wrote")
    body, checksum = content[:-_DIGEST], content[-_DIGEST:]
    if hashlib.sha256(body).digest() != checksum:
        raise InputError(f"{path}: is damaged; get it again, or learn again")
    try:
        facts, arrays = _parts(body)
        _check_facts(facts)
        return _model(facts, arrays)
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
        raise InputError(f"{path}: is no sound model: {error}") from None


def _arrays(model: LearnedModel) -> dict[str, tuple[str, np.ndarray]]:
    """Arrays by name, with the type that they are kept in; networks are learned in float32."""
    kept = {name: ("<f8", getattr(model, name)) for name in ("low", "high", "middle", "unit")}
    kept |= {name: ("<f4", getattr(model, name)) for name in ("known", "reached")}
    for name in ("forward", "inverse"):
        network = getattr(model, name)
        if network is not None:
            kept |= {f"{name}.sizes": ("<i8", network.sizes), f"{name}.numbers": ("<f4", network.numbers)}
    return kept


def _parts(body: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Facts, and arrays by name; sizes are checked before bytes are taken (ValueError: what is wrong)."""
    begin = len(_MAGIC) + 8
    length = int.from_bytes(body[len(_MAGIC) : begin], "little")
    if length > len(body) - begin:
        raise ValueError("its header is cut off")
    header = json.loads(body[begin : begin + length])
    at, arrays = begin + length, {}
    for name, kind, shape in header["arrays"]:
        if name not in _KINDS or kind != _KINDS[name][0] or len(shape) != _KINDS[name][1] or name in arrays:
            raise ValueError(f"array {name!r} is none of a model's")
        if not all(type(side) is int and 0 <= side <= _MOST for side in shape):
            raise ValueError(f"array {name} has no size")
        size = prod(shape) * np.dtype(kind).itemsize
        if size > len(body) - at:
            raise ValueError(f"array {name} is cut off")
        value = np.frombuffer(body[at : at + size], kind).reshape(shape)
        if not np.isfinite(value).all():
            raise ValueError(f"array {name} holds numbers that are not finite")
        arrays[name] = value.astype(np.int64 if kind == "<i8" else np.float64)
        at += size
    if at != len(body):
        raise ValueError("there is more in it than its header says")
    return dict(header["facts"]), arrays


def _check_facts(facts: Mapping[str, Any]) -> None:
    """ValueError: a fact that is needed is missing or of another kind."""
    for name, kind in _FACTS.items():
        if not isinstance(facts.get(name), kind) or (kind is not bool and isinstance(facts[name], bool)):
            raise ValueError(f"it does not say its {name}")
    for name in ("winches", "markers", "cables"):
        if not all(isinstance(one, str) for one in facts[name]) or len(set(facts[name])) != len(facts[name]):
            raise ValueError(f"its {name} are no names")
    if facts["dim"] not in {2, 3} or not all(isfinite(facts[one]) and facts[one] >= 0 for one in ("error", "size")):
        raise ValueError("its numbers are out of their ranges")


def _model(facts: dict[str, Any], arrays: dict[str, np.ndarray]) -> LearnedModel:
    """The model of its parts (ValueError: they do not fit one another)."""
    winches, coordinates = len(facts["winches"]), len(facts["markers"]) * facts["dim"]
    expected = coordinates + len(facts["cables"])
    forward = _network(arrays, "forward", winches, expected)
    inverse = _network(arrays, "inverse", coordinates, winches) if "inverse.sizes" in arrays else None
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


def _network(arrays: dict[str, np.ndarray], name: str, inputs: int, outputs: int) -> Perceptrons:
    sizes, numbers = arrays[f"{name}.sizes"], arrays[f"{name}.numbers"]
    if not 2 <= len(sizes) <= _LAYERS or sizes[0] != inputs or sizes[-1] != outputs:
        raise ValueError(f"the {name} network fits no such robot")
    if ((sizes < 1) | (sizes > _WIDEST)).any() or not len(numbers) or numbers.shape[1] != Perceptrons.count(sizes):
        raise ValueError(f"the {name} network has wrong sizes")
    return Perceptrons(sizes=sizes, numbers=numbers)


_MAGIC = b"HSMODEL1"
"""First bytes of a model of this format."""

_DIGEST = hashlib.sha256().digest_size

_MOST = 500_000_000
"""No model is larger [bytes]."""

_LAYERS, _WIDEST = 64, 100_000
"""Most layers, and most units in one."""

_KINDS = dict.fromkeys(("low", "high", "middle", "unit"), ("<f8", 1))
_KINDS |= dict.fromkeys(("known", "reached", "forward.numbers", "inverse.numbers"), ("<f4", 2))
_KINDS |= dict.fromkeys(("forward.sizes", "inverse.sizes"), ("<i8", 1))
"""Type and number of axes of each array."""

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
