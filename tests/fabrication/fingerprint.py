"""A kit in a few numbers and words, read from its files by other people's programs; kept to compare kits with."""

import csv
import io
import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pypdf
import trimesh
from read_back import Seen, see_dxf, see_svg


def fingerprint(files: Mapping[str, bytes]) -> dict[str, Any]:
    """What is in each file, by its path: words exact, numbers as far as a machine may differ."""
    return {path: _READERS[path.rpartition(".")[2]](content) for path, content in sorted(files.items())}


def differences(one: Any, other: Any, *, at: str = "kit", rtol: float = 2e-3, atol: float = 0.02) -> list[str]:
    """Where two fingerprints differ, a line each; numbers may differ by `rtol` of them or `atol`."""
    if isinstance(one, dict) and isinstance(other, dict):
        keys = sorted(one.keys() | other.keys())
        missing = [f"{at}: {key} is in one only" for key in keys if (key in one) != (key in other)]
        both = [key for key in keys if key in one and key in other]
        return missing + [line for key in both for line in differences(one[key], other[key], at=f"{at}/{key}")]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = enumerate(zip(one, other, strict=True))
        return [line for index, (a, b) in pairs for line in differences(a, b, at=f"{at}[{index}]")]
    if _number(one) and _number(other):
        same = math.isclose(float(one), float(other), rel_tol=rtol, abs_tol=atol)
        return [] if same else [f"{at}: {one} and {other}"]
    return [] if one == other else [f"{at}: {one!r} and {other!r}"]


def _number(value: Any) -> bool:
    try:
        return not isinstance(value, bool) and math.isfinite(float(value))
    except (TypeError, ValueError):
        return False


def _drawing(seen: Seen) -> dict[str, Any]:
    """Counts, total length and middle of what is on each layer."""
    told = {}
    for layer, lines in seen.lines.items():
        lengths = [np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines]
        middles = [line.mean(axis=0) for line in lines]
        told[layer] = {
            "lines": len(lines),
            "length": round(float(sum(lengths)), 2),
            "middle": np.mean(middles, axis=0).round(2).tolist() if middles else [],
            "circles": len(seen.circles[layer]),
            "circle middle": seen.circles[layer].mean(axis=0).round(3).tolist() if len(seen.circles[layer]) else [],
        }
    return told


def _pages(content: bytes) -> list[list[float]]:
    """Sizes of the pages [mm]."""
    return [[float(round(side * 25.4 / 72, 2)) for side in page.mediabox[2:]] for page in _reader(content).pages]


def _reader(content: bytes) -> pypdf.PdfReader:
    return pypdf.PdfReader(io.BytesIO(content))


def _stl(content: bytes) -> dict[str, Any]:
    return _solid(trimesh.load_mesh(io.BytesIO(content), file_type="stl"))


def _solid(mesh: Any) -> dict[str, Any]:
    return {
        "watertight": bool(mesh.is_watertight),
        "volume": round(float(mesh.volume), 2),
        "box": np.round(mesh.extents, 3).tolist(),
    }


def _three_mf(content: bytes) -> dict[str, Any]:
    scene = trimesh.load_scene(io.BytesIO(content), file_type="3mf")
    return {"solids": len(scene.geometry), "volume": round(float(sum(part.volume for part in scene.dump())), 2)}


def _table(content: bytes) -> list[list[str]]:
    return list(csv.reader(io.StringIO(content.decode("utf-8-sig"))))


def _manifest(content: bytes) -> dict[str, Any]:
    told = json.loads(content)
    return {"robot": told["robot"], "options": told["options"], "files": sorted(told["files"])}


_READERS = {
    "svg": lambda content: _drawing(see_svg(content)),
    "dxf": lambda content: _drawing(see_dxf(content)),
    "pdf": _pages,
    "stl": _stl,
    "3mf": _three_mf,
    "csv": _table,
    "txt": lambda content: [line for line in content.decode().splitlines() if line.isupper()],
    "json": _manifest,
}
