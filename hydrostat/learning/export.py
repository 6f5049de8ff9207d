"""`export_samples`: samples for the tools of others."""

from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.errors import InputError
from hydrostat.learning.sample_shard import REASONS
from hydrostat.learning.samples import read_rows
from hydrostat.version import install_command


def export_samples(folder: Path, out: Path) -> Path:
    """Export all samples of a folder to one file, also those without an equilibrium.

    Args:
        folder: sample folder.
        out: output path, with an extension of `EXPORTS`: .parquet (one column for each value), or .zarr (one array for
            each quantity).

    Raises:
        InputError: an unknown file extension, a missing package, an existing file, or no samples.
    """
    check_export(out)
    write = EXPORTS[out.suffix]
    facts, rows = read_rows(folder)
    part = out.with_name(f".{out.name}.part")
    try:
        write(part, facts, rows)
        part.rename(out)
    except ImportError as error:
        raise InputError(f"{out}: package {error.name} not found. Install it: {install_command('cluster')}") from None
    except OSError as error:
        raise InputError(f"{out}: cannot be written ({error.strerror})") from None
    return out


def check_export(out: Path) -> None:
    """Check that samples can be exported to a path, before any other work.

    Raises:
        InputError: an unknown file extension, an existing file, or a missing package.
    """
    if out.suffix not in EXPORTS:
        raise InputError(f"{out}: must end in {' or '.join(EXPORTS)}")
    if out.exists():
        raise InputError(f"{out}: is there already; name another")
    if find_spec(_NEEDS[out.suffix]) is None:
        raise InputError(f"{out}: package {_NEEDS[out.suffix]} not found. Install it: {install_command('cluster')}")


def _parquet(path: Path, facts: Mapping[str, Any], rows: np.ndarray) -> None:
    """One column for each number, such as contraction_index_mm's SI value `contractions.index`."""
    import json

    import pyarrow as pa  # pyright: ignore[reportMissingImports]
    import pyarrow.parquet as pq  # pyright: ignore[reportMissingImports]

    columns: dict[str, Any] = {"reason": [str(REASONS[reason]) for reason in rows["reason"]]}
    axes = "xyz"[: facts["dim"]]
    names = {
        "contractions": facts["winches"],
        "tensions": facts["cables"],
        "tension_slopes": [f"{cable}.{winch}" for cable in facts["cables"] for winch in facts["winches"]],
        "markers": [f"{marker}.{axis}" for marker in facts["markers"] for axis in axes],
        "jacobian": [f"{m}.{axis}.{w}" for m in facts["markers"] for axis in axes for w in facts["winches"]],
    }
    for name in rows.dtype.names or ():
        flat = rows[name].reshape(len(rows), -1)
        if name == "reason":
            continue
        for column, label in enumerate(names.get(name, range(flat.shape[1]))):
            columns[name if flat.shape[1] == 1 and name not in names else f"{name}.{label}"] = flat[:, column]
    table = pa.table(columns).replace_schema_metadata({"hydrostat": json.dumps(facts)})
    pq.write_table(table, path)


def _zarr(path: Path, facts: Mapping[str, Any], rows: np.ndarray) -> None:
    import zarr  # pyright: ignore[reportMissingImports]

    group = zarr.open_group(path, mode="w")
    group.attrs.update({**facts, "reasons": [str(reason) for reason in REASONS]})
    for name in rows.dtype.names or ():
        group.create_array(name, data=np.ascontiguousarray(rows[name]))


EXPORTS: Mapping[str, Callable[[Path, Mapping[str, Any], np.ndarray], None]] = {".parquet": _parquet, ".zarr": _zarr}
"""Functions that write samples, by the ending of the file."""

_NEEDS: Mapping[str, str] = {".parquet": "pyarrow", ".zarr": "zarr"}
"""Libraries that write them."""
