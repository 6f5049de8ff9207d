"""`PortableFile`: a kind of file that holds facts and arrays of numbers, in which nothing is executed.

The file: eight bytes that say its kind; the length of the header, as eight bytes, little-endian; the header, JSON, with
the facts and with name, type and shape of each array; the arrays, one after another, little-endian; SHA-256 of all
before it.
"""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from hydrostat.errors import InputError
from hydrostat.files import read_stranger, replace_file
from hydrostat.given import path_of

Parts = tuple[dict[str, Any], dict[str, np.ndarray]]
Made = TypeVar("Made")


@dataclass(frozen=True, kw_only=True)
class PortableFile:
    """Kind of portable file.

    Attributes:
        magic: its first eight bytes.
        word: content, in a word.
        writer: the command that writes it.
        kinds: type and number of axes of each array that it may hold.
    """

    magic: bytes
    word: str
    writer: str
    kinds: Mapping[str, tuple[str, int]]

    def write(self, path: str | Path, facts: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> Path:
        """Write a file whole, or not at all; arrays are kept as their kinds say (InputError: it cannot be written)."""
        kept = {name: np.ascontiguousarray(value, self.kinds[name][0]) for name, value in arrays.items()}
        table = [[name, value.dtype.str, list(value.shape)] for name, value in kept.items()]
        header = json.dumps({"facts": dict(facts), "arrays": table}).encode()
        if len(header) > MAX_HEADER:
            raise InputError(f"{path}: names and facts of the {self.word} take more than {MAX_HEADER} bytes")
        parts = [self.magic, len(header).to_bytes(8, "little"), header, *(one.tobytes() for one in kept.values())]
        content = b"".join(parts)
        return replace_file(Path(path), content + hashlib.sha256(content).digest())

    def read(self, path: str | Path, made: Callable[[dict[str, Any], dict[str, np.ndarray]], Made]) -> Made:
        """Make an object of the facts and the arrays of a file; numbers are float64 or int64.

        Args:
            path: path of the file.
            made: gives what they are (ValueError: they do not fit one another).

        Raises:
            InputError: there is none, it was changed since it was written, or it is none that this version can use.
        """
        path = path_of(path, f"a {self.word} is read from its file, by a path")
        try:
            content = read_stranger(path, most=MAX_BYTES)
        except InputError as error:
            raise InputError(f"{error}; name a file that {self.writer} wrote") from None
        if not content.startswith(self.magic):
            told = f"{path}: is no {self.word} of this version of hydrostat; name a file that {self.writer} wrote"
            raise InputError(told)
        body, checksum = content[:-_DIGEST], content[-_DIGEST:]
        if hashlib.sha256(body).digest() != checksum:
            raise InputError(f"{path}: is damaged; get it again, or make it again by {self.writer}")
        try:
            return made(*self._parts(body))
        except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
            raise InputError(f"{path}: is no sound {self.word}: {error}") from None

    def _parts(self, body: bytes) -> Parts:
        """Facts, and arrays by name; sizes are checked before bytes are taken (ValueError: what is wrong)."""
        begin = len(self.magic) + 8
        length = int.from_bytes(body[len(self.magic) : begin], "little")
        if length > MAX_HEADER:
            raise ValueError(f"its header has {length} bytes, and no header needs more than {MAX_HEADER}")
        if length > len(body) - begin:
            raise ValueError("its header is cut off")
        header = json.loads(body[begin : begin + length])
        at, arrays = begin + length, {}
        for name, kind, shape in header["arrays"]:
            if name not in self.kinds or (kind, len(shape)) != tuple(self.kinds[name]) or name in arrays:
                raise ValueError(f"array {name!r} is none of a {self.word}'s")
            if not all(type(side) is int and 0 <= side <= MAX_BYTES for side in shape):
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


def check_fact(name: str, value: Any, kind: type | tuple[type, ...]) -> None:
    """Check the value of a key in JSON (ValueError: it is missing or of another kind)."""
    if value is None:
        raise ValueError(f'"{name}" is missing')
    if not isinstance(value, kind) or (kind is not bool and isinstance(value, bool)):
        kinds = kind if isinstance(kind, tuple) else (kind,)
        raise ValueError(f'"{name}" is {value!r:.60}, not {" or ".join(_WORDS[one] for one in kinds)}')


_WORDS = {str: "text", bool: "true or false", int: "a whole number", float: "a number", list: "a list", dict: "a table"}
"""Name of each kind of value in JSON."""

_DIGEST = hashlib.sha256().digest_size

MAX_BYTES = 500_000_000
"""No such file is larger [bytes]."""

MAX_HEADER = 2_000_000
"""No header is longer [bytes]: it has names and options, some kilobytes of them."""
