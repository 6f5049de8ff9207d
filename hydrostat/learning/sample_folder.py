"""`SampleFolder`: samples on disk, a file for each shard and one manifest."""

import json
import os
from dataclasses import dataclass
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry.files.stranger import read_stranger
from hydrostat.given import path_of
from hydrostat.learning.sample_plan import SamplePlan
from hydrostat.learning.sample_shard import sample_type

FORMAT = 1
"""Version of what lies in a folder of samples."""

MANIFEST = "samples.json"
"""File that says what was sampled."""


@dataclass(frozen=True)
class SampleFolder:
    """A folder into which samples are written whole, file by file; what is there is not made again.

    Attributes:
        path: of the folder.
        plan: of the samples.
    """

    path: Path
    plan: SamplePlan

    @classmethod
    def begin(cls, path: Path, plan: SamplePlan) -> "SampleFolder":
        """The folder of a plan: a new one, or one with the same plan, to go on with.

        Raises:
            InputError: it holds samples of another plan, or cannot be written.
        """
        folder, facts = cls(path, plan), {"format": FORMAT, "version": version("hydrostat"), **plan.facts()}
        try:
            path.mkdir(parents=True, exist_ok=True)
            present = (path / MANIFEST).is_file()
            strangers = [] if present else [other.name for other in path.iterdir() if not other.name.startswith(".")]
        except OSError as error:
            raise InputError(f"{path}: cannot be made a folder of samples ({error.strerror})") from None
        if strangers:
            raise InputError(f"{path}: holds other things, such as {min(strangers)}; name an empty folder")
        if present:
            known = read_manifest(path)
            differing = [key for key, value in facts.items() if known.get(key) != value]
            if differing:
                key = differing[0]
                raise InputError(
                    f"{path}: holds samples of another plan: {key} is {known.get(key)!r}, asked for {facts[key]!r}; "
                    f"ask for the same, or name another folder"
                )
        else:
            _write_whole(path / MANIFEST, (json.dumps(facts, indent=2) + "\n").encode())
        return folder

    def file(self, shard: int) -> Path:
        """Where the samples of a shard are."""
        return self.path / f"samples-{shard:06d}.npy"

    def missing(self, part: tuple[int, int]) -> list[int]:
        """Shards of part i of n, counted from 0, that are not there yet; leftovers of killed runs are cleared."""
        for left in self.path.glob(".*.part-*"):
            if not _alive(left):
                left.unlink(missing_ok=True)
        return [shard for shard in range(part[0], self.plan.shards, part[1]) if not self.file(shard).is_file()]

    def write(self, shard: int, rows: np.ndarray) -> None:
        """Write the samples of a shard, whole or not at all.

        Raises:
            InputError: they cannot be written, as when the disk is full.
        """
        assert rows.dtype == sample_type(self.plan)
        content = BytesIO()
        np.save(content, rows, allow_pickle=False)
        _write_whole(self.file(shard), content.getvalue())


def read_manifest(path: str | Path) -> dict[str, Any]:
    """What was sampled, from the manifest of a folder.

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
    part = path.with_name(f".{path.name}.part-{os.getpid()}")
    try:
        with part.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); what was written before is whole") from None
    finally:
        part.unlink(missing_ok=True)


def _alive(part: Path) -> bool:
    """Whether the process that writes a part may still be at work; one on another machine may be for an hour."""
    try:
        os.kill(int(part.name.rpartition("-")[2]), 0)
    except ProcessLookupError:
        return False
    except (ValueError, OSError):
        return True
    return True


_MOST_TEXT = 10_000_000
"""No manifest is longer [bytes]."""
