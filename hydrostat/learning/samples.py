"""`SampleFolder`: samples on disk, a file for each shard and one manifest; `Samples`: the same as arrays."""

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.errors import InputError
from hydrostat.files import clear_unfinished, read_stranger, temporary_path
from hydrostat.given import path_of
from hydrostat.learning.sample_plan import SamplePlan
from hydrostat.learning.sample_shard import REASONS, sample_type
from hydrostat.result_table import Columns, Tabular, control_columns, marker_columns, named_columns

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
            raise InputError(f"{path}: holds other files, such as {min(strangers)}; name an empty folder")
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
    known = {
        "contact_friction": 0.0 if known.get("contact") else None,
        "sensors": [],
        "noise": [],
        "drives": {},
        **known,
    }  # earlier ones do not say it
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
    most_text = 10_000_000  # No manifest is longer [bytes]
    try:
        text = read_stranger(file, most=most_text)
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Samples(Tabular):
    """Equilibria of a robot at random contractions. Failed samples are left out.

    Attributes:
        facts: metadata of the samples, as in the manifest.
        numbers: indices of the samples.
        contractions: contractions [m], then drive values [rad, m or share] (samples, winches and drives).
        markers: marker positions [m] (samples, markers, dim).
        jacobians: derivatives of the markers with respect to the contractions (samples, markers, dim, winches).
        tensions: tension of each cable [N] (samples, cables).
        tension_jacobians: derivatives dT/da of the tensions [N/m] (samples, cables, winches); None in folders of an
            earlier version, which did not sample them.
        touches: True where the body has self-contact.
        crosses: True where the body intersects itself, which is possible without contact.
        nodes: positions of all nodes [m], float32; None if they were not kept.
        sensors: sensor readings with noise, in SI units (samples, values), names in `facts`; None without sensors.
        lost: number of samples without a stable equilibrium, or without derivatives.
    """

    facts: Mapping[str, Any]
    numbers: Int[np.ndarray, " samples"]
    contractions: Float[np.ndarray, "samples winches"]
    markers: Float[np.ndarray, "samples markers dim"]
    jacobians: Float[np.ndarray, "samples markers dim winches"]
    tensions: Float[np.ndarray, "samples cables"]
    tension_jacobians: Float[np.ndarray, "samples cables winches"] | None
    touches: Bool[np.ndarray, " samples"]
    crosses: Bool[np.ndarray, " samples"]
    nodes: np.ndarray | None
    lost: int
    sensors: Float[np.ndarray, "samples values"] | None = None

    def __len__(self) -> int:
        return len(self.contractions)

    def columns(self) -> Columns:
        """Return a table of contractions, drive values, markers and tensions, one row for each sample."""
        drives: dict[str, str] = self.facts.get("drives", {})
        winches = [name for name in self.facts["winches"] if name not in drives]
        columns = control_columns(winches, drives, self.contractions)
        columns |= marker_columns({name: self.markers[:, row] for row, name in enumerate(self.facts["markers"])})
        return columns | named_columns("tension", self.facts["cables"], self.tensions, "N")

    def __repr__(self) -> str:
        """Return a description of one line."""
        return f"<Samples of {self.facts['robot']!r}: {len(self)} found, {self.lost} lost>"

    @property
    def limits(self) -> tuple[Vector, Vector]:
        """Least and largest contraction of each winch [m], then of each drive value."""
        return -np.array(self.facts["release"], dtype=float), np.array(self.facts["travel"], dtype=float)

    def first(self, count: int) -> "Samples":
        """Return the first samples (InputError: fewer samples than `count`)."""
        if not 1 <= count <= len(self):
            raise InputError(f"there are {len(self)} samples, not {count}")
        return self.only(np.arange(count))

    def only(self, which: np.ndarray) -> "Samples":
        """Return selected samples."""
        return Samples(
            facts=self.facts,
            numbers=self.numbers[which],
            contractions=self.contractions[which],
            markers=self.markers[which],
            jacobians=self.jacobians[which],
            tensions=self.tensions[which],
            tension_jacobians=None if self.tension_jacobians is None else self.tension_jacobians[which],
            touches=self.touches[which],
            crosses=self.crosses[which],
            nodes=None if self.nodes is None else self.nodes[which],
            sensors=None if self.sensors is None else self.sensors[which],
            lost=self.lost,
        )

    @staticmethod
    def read(folder: str | Path) -> "Samples":
        """Read the samples that `sample_robot` has written, only those with a stable equilibrium and derivatives.

        Raises:
            InputError: as for `read_rows`.
        """
        facts, rows = read_rows(folder)
        good = (rows["reason"] == REASONS.index("converged")) & (rows["stable"] > 0)
        good &= np.isfinite(rows["jacobian"]).all(axis=(1, 2, 3)) & np.isfinite(rows["markers"]).all(axis=(1, 2))
        rows, lost = rows[good], int((~good).sum())
        return Samples(
            facts=facts,
            numbers=rows["number"],
            contractions=rows["contractions"],
            markers=rows["markers"],
            jacobians=rows["jacobian"],
            tensions=rows["tensions"],
            tension_jacobians=rows["tension_slopes"] if "tension_slopes" in (rows.dtype.names or ()) else None,
            touches=rows["touches"] > 0,
            crosses=rows["crosses"] > 0,
            nodes=rows["nodes"] if "nodes" in (rows.dtype.names or ()) else None,
            sensors=rows["sensors"] if "sensors" in (rows.dtype.names or ()) else None,
            lost=lost,
        )


def read_rows(folder: str | Path) -> tuple[dict[str, Any], np.ndarray]:
    """Manifest and all rows of a folder of samples, in the order of their numbers; a run need not be complete.

    Raises:
        InputError: no samples, or a file that does not belong to the others.
    """
    facts = read_manifest(folder)
    files = sorted(Path(folder).glob("samples-*.npy"))
    if not files:
        raise InputError(f"{folder}: there are no samples yet")
    parts: list[np.ndarray] = []
    most = 2_000_000_000  # No file of samples is larger [bytes]
    for file in files:
        try:
            rows = np.load(BytesIO(read_stranger(file, most=most)), allow_pickle=False)
        except (InputError, OSError, ValueError, EOFError, TokenError, SyntaxError, MemoryError, OverflowError):
            raise InputError(f"{file}: is damaged; delete it and let hydrostat sample make it again") from None
        if rows.dtype.names is None or rows.ndim != 1 or (parts and rows.dtype != parts[0].dtype):
            raise InputError(f"{file}: has other columns than the files before it; delete it and sample again")
        parts.append(rows)
    rows = np.concatenate(parts)
    return facts, rows[np.argsort(rows["number"], kind="stable")]
