"""`SampleFolder`: samples on disk, a file for each shard and one manifest."""

import json
import os
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry import read_stranger
from hydrostat.given import path_of
from hydrostat.learning.sample_plan import SamplePlan
from hydrostat.learning.sample_shard import sample_type
from hydrostat.robot import clear_unfinished, temporary_path

FORMAT = 1
"""Version of what lies in a folder of samples."""

MANIFEST = "samples.json"
"""File that says what was sampled."""


@dataclass(frozen=True)
class SampleFolder:
    """A folder into which samples are written whole, file by file; what is there is not made again.

    Attributes:
        path: path of the folder.
        plan: plan of the samples.
    """

    path: Path
    plan: SamplePlan

    @classmethod
    def begin(cls, path: Path, plan: SamplePlan) -> "SampleFolder":
        """The folder of a plan: a new one, or one with the same plan to go on with, perhaps of fewer samples till now.

        Raises:
            InputError: it holds samples of another plan, or more of them; or it cannot be written.
        """
        folder, facts = cls(path, plan), {"format": FORMAT, "version": version("hydrostat"), **plan.facts()}
        try:
            path.mkdir(parents=True, exist_ok=True)
            present, known = (path / MANIFEST).is_file(), {}
            strangers = [] if present else [other.name for other in path.iterdir() if not other.name.startswith(".")]
        except OSError as error:
            raise InputError(f"{path}: cannot be made a folder of samples ({error.strerror})") from None
        if strangers:
            raise InputError(f"{path}: holds other things, such as {min(strangers)}; name an empty folder")
        if present:
            known = read_manifest(path)
            _check_known(path, known, facts)
        if not present or known["count"] != plan.count:
            _write_whole(path / MANIFEST, (json.dumps(facts, indent=2) + "\n").encode())
        return folder

    def file(self, shard: int) -> Path:
        """Return the path of the samples of a shard."""
        return self.path / f"samples-{shard:06d}.npy"

    def missing(self, part: tuple[int, int]) -> list[int]:
        """Shards of part i of n, counted from 0, that are not there yet; leftovers of killed runs are cleared.

        A file of another size is not there: the last one was shorter while fewer samples were asked for.
        """
        clear_unfinished(self.path)
        return [shard for shard in range(part[0], self.plan.shards, part[1]) if not self._is_whole(shard)]

    def _is_whole(self, shard: int) -> bool:
        try:
            size = self.file(shard).stat().st_size
        except OSError:
            return False
        return size == _size_of(len(self.plan.numbers(shard)), sample_type(self.plan))

    def write(self, shard: int, rows: np.ndarray) -> None:
        """Write the samples of a shard, whole or not at all.

        Raises:
            InputError: they cannot be written, as when the disk is full.
        """
        assert rows.dtype == sample_type(self.plan)
        _write_whole(self.file(shard), _content(rows))


@cache
def _size_of(count: int, columns: np.dtype) -> int:
    """Bytes of a file with so many samples."""
    return len(_content(np.zeros(count, columns)))


def _content(rows: np.ndarray) -> bytes:
    content = BytesIO()
    np.save(content, rows, allow_pickle=False)
    return content.getvalue()


def _check_known(path: Path, known: dict[str, Any], facts: dict[str, Any]) -> None:
    """InputError: what a folder holds is not what is asked for, nor fewer samples of the same."""
    known = {"contact_friction": 0.0 if known.get("contact") else None, **known}  # earlier ones do not say it
    differing = [key for key, value in facts.items() if known.get(key) != value and key != "count"]
    if differing:
        key = differing[0]
        raise InputError(
            f"{path}: holds samples of another plan: {key} is {known.get(key)!r}, asked for {facts[key]!r}; "
            f"ask for the same, or name another folder"
        )
    there, asked = known.get("count"), facts["count"]
    if type(there) is not int or there > asked:
        raise InputError(
            f"{path}: is for {there} samples already, more than the {asked} asked for, and none are taken away; "
            f"ask for {there} or more, or learn from the first by hydrostat learn --max-samples {asked}"
        )


def read_manifest(path: str | Path) -> dict[str, Any]:
    """Read the plan from the manifest of a folder.

    Raises:
        InputError: there is none, or it is not one of ours.
    """
    file = path_of(path, "samples are read from their folder, by a path") / MANIFEST
    try:
        text = read_stranger(file, most=_MOST_TEXT)
    except InputError as error:
        raise InputError(f"{error}; name a folder that hydrostat sample has written") from None
    try:
        facts = json.loads(text)
    except ValueError:
        raise InputError(f"{file}: is no JSON; it was changed since it was written") from None
    if not isinstance(facts, dict) or facts.get("format") != FORMAT:
        raise InputError(f"{file}: must have format {FORMAT}, as this version of hydrostat writes it")
    return facts


def _write_whole(path: Path, content: bytes) -> None:
    """Write a file whole, to the disk, or not at all; processes that write the same do not get in each other's way."""
    part = temporary_path(path)
    try:
        with part.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); what was written before is whole") from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


_MOST_TEXT = 10_000_000
"""No manifest is longer [bytes]."""
