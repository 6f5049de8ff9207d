"""`Samples`: poses of a robot as arrays, for learning."""

from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from hydrostat.arrays import Vector
from hydrostat.errors import InputError
from hydrostat.geometry import read_stranger
from hydrostat.learning.sample_folder import read_manifest
from hydrostat.learning.sample_shard import REASONS


@dataclass(frozen=True, kw_only=True, eq=False)
class Samples:
    """Equilibria of a robot at contractions drawn at random; only those that were found.

    Attributes:
        facts: facts of the samples, as in the manifest.
        numbers: numbers of the samples.
        contractions: [m], (samples, winches).
        markers: positions [m], (samples, markers, dim).
        jacobians: slopes of the markers with the contractions, (samples, markers, dim, winches).
        tensions: tension of each cable [N], (samples, cables).
        tension_slopes: slopes of tensions with contractions [N/m], (samples, cables, winches); None in folders of an
            earlier version, which did not sample them.
        touches: True if parts of the body push one another off.
        crosses: True if the body passes through itself, as it may without contact.
        nodes: positions of all nodes [m], float32; None if they were not kept.
        lost: number of samples without a stable equilibrium, or without slopes.
    """

    facts: Mapping[str, Any]
    numbers: Int[np.ndarray, " samples"]
    contractions: Float[np.ndarray, "samples winches"]
    markers: Float[np.ndarray, "samples markers dim"]
    jacobians: Float[np.ndarray, "samples markers dim winches"]
    tensions: Float[np.ndarray, "samples cables"]
    tension_slopes: Float[np.ndarray, "samples cables winches"] | None
    touches: Bool[np.ndarray, " samples"]
    crosses: Bool[np.ndarray, " samples"]
    nodes: np.ndarray | None
    lost: int

    def __len__(self) -> int:
        return len(self.contractions)

    def __repr__(self) -> str:
        """Return a description of one line."""
        return f"<Samples of {self.facts['robot']!r}: {len(self)} found, {self.lost} lost>"

    @property
    def limits(self) -> tuple[Vector, Vector]:
        """Least and largest contraction of each winch [m]."""
        return -np.array(self.facts["release"], dtype=float), np.array(self.facts["travel"], dtype=float)

    def first(self, count: int) -> "Samples":
        """The first samples, by their number (InputError: there are not so many)."""
        if not 1 <= count <= len(self):
            raise InputError(f"there are {len(self)} samples, not {count}")
        return self.only(np.arange(count))

    def only(self, which: np.ndarray) -> "Samples":
        """Some of them."""
        return Samples(
            facts=self.facts,
            numbers=self.numbers[which],
            contractions=self.contractions[which],
            markers=self.markers[which],
            jacobians=self.jacobians[which],
            tensions=self.tensions[which],
            tension_slopes=None if self.tension_slopes is None else self.tension_slopes[which],
            touches=self.touches[which],
            crosses=self.crosses[which],
            nodes=None if self.nodes is None else self.nodes[which],
            lost=self.lost,
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
    for file in files:
        try:
            rows = np.load(BytesIO(read_stranger(file, most=_MOST)), allow_pickle=False)
        except (InputError, OSError, ValueError, EOFError, TokenError, SyntaxError, MemoryError, OverflowError):
            raise InputError(f"{file}: is damaged; delete it and let hydrostat sample make it again") from None
        if rows.dtype.names is None or rows.ndim != 1 or (parts and rows.dtype != parts[0].dtype):
            raise InputError(f"{file}: has other columns than the files before it; delete it and sample again")
        parts.append(rows)
    rows = np.concatenate(parts)
    return facts, rows[np.argsort(rows["number"], kind="stable")]


def read_samples(folder: str | Path) -> Samples:
    """Samples of a folder that `sample_robot` has written; stable equilibria with slopes alone.

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
        tension_slopes=rows["tension_slopes"] if "tension_slopes" in (rows.dtype.names or ()) else None,
        touches=rows["touches"] > 0,
        crosses=rows["crosses"] > 0,
        nodes=rows["nodes"] if "nodes" in (rows.dtype.names or ()) else None,
        lost=lost,
    )


_MOST = 2_000_000_000
"""No file of samples is larger [bytes]."""
