"""Surfaces from files that nobody vouches for: STL, OBJ, PLY, OFF and 3MF, and STEP by Open CASCADE.

All but STEP are read by a few lines of NumPy each, which hold every declared count against the bytes that are there
before anything of that size is made. A general library did neither, took a second to load and needs two more for 3MF.
"""

from pathlib import PurePath

import numpy as np

from hydrostat.errors import GIVE_SIZE, SurfaceError
from hydrostat.geometry.files.ply_file import read_ply, write_ply
from hydrostat.geometry.files.soup import MAX_BYTES, Soup, check_count
from hydrostat.geometry.files.step_file import read_step
from hydrostat.geometry.files.stl_obj_off_files import (
    OFF_HEAD,
    fits_binary_stl,
    is_stl_text,
    read_obj,
    read_off,
    read_stl,
)
from hydrostat.geometry.files.threemf_file import read_3mf
from hydrostat.geometry.surface import Surface

__all__ = ["STEP_SUFFIXES", "SURFACE_SUFFIXES", "convert_step", "read_surface", "write_ply"]

_READERS = {".stl": read_stl, ".obj": read_obj, ".ply": read_ply, ".off": read_off, ".3mf": read_3mf}

SURFACE_SUFFIXES = tuple(_READERS)  # endings of the files that are read as surfaces
STEP_SUFFIXES = (".step", ".stp")  # and those that need the extra `cad`

_STRANGERS = {
    b"ISO-10303": "a STEP file: rename it to end with .step",
    b"glTF": "a glTF file: export it as STL or PLY",
    b"# vtk": "a VTK file: rename it to end with .vtk",
    b"$MeshFormat": "a Gmsh file: rename it to end with .msh",
    b"\x89PNG": "a picture: rename it to end with .png",
}


def read_surface(
    content: bytes, *, name: str, unit: float = 1e-3, size: float | None = None, part: int | None = None
) -> Surface:
    """Read the surface in a file, with all its faults, which `heal` repairs.

    The ending of its name tells the format. A coordinate counts `unit` meters where the file has no unit (all but 3MF
    and STEP); `size`, the longest side of the bounding box [m], overrules any unit. `part` is the number of a body in a
    STEP file, the largest volume is 1. Raises SurfaceError: another ending, other content than the ending says, empty,
    too large, damaged, cut short, without triangles, with coordinates that are no numbers, or without a size.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix not in (*_READERS, *STEP_SUFFIXES):
        raise SurfaceError(f"{name}: surfaces are read from {', '.join(SURFACE_SUFFIXES)} files: export it as STL")
    for key, length in (("unit", unit), ("size", size)):
        if length is not None and not 0.0 < length < np.inf:
            raise SurfaceError(f"{name}: the {key} to read it with is {length!r} m, but has to be above 0")
    if not content.strip():
        raise SurfaceError(f"{name}: the file is empty: export the surface again")
    if len(content) > MAX_BYTES:
        raise SurfaceError(
            f"{name}: the file has {len(content) / 1e6:.0f} MB, at most {MAX_BYTES / 1e6:.0f} MB are read: "
            "save it as binary STL or PLY, or simplify the surface"
        )
    if suffix in STEP_SUFFIXES:
        return _surface(read_step(content, name, part), name, unit, size)
    _check_kind(content, name, suffix)
    return _surface(_READERS[suffix](content, name), name, unit, size)


def _check_kind(content: bytes, name: str, suffix: str) -> None:
    """Refuse content that begins like another format than the ending says."""
    if suffix == ".stl" and fits_binary_stl(content):
        return  # whatever its first 80 bytes are
    for start, word in _STRANGERS.items():
        if content.lstrip().startswith(start):
            raise SurfaceError(f"{name}: is {word}")
    kind = None
    if content.startswith(b"PK\x03\x04"):
        kind = ".3mf"
    elif content.startswith((b"ply\n", b"ply\r")):
        kind = ".ply"
    elif OFF_HEAD.match(content):
        kind = ".off"
    elif suffix != ".stl" and is_stl_text(content) and b"facet" in content[:4000].lower():
        kind = ".stl"
    if kind not in (None, suffix) or (suffix == ".3mf" and kind is None):
        remedy = f"begins like a {kind} file: rename it" if kind else "is no 3MF file: export it again"
        raise SurfaceError(f"{name}: {remedy}")


def _surface(soup: Soup, name: str, unit: float, size: float | None) -> Surface:
    """Check the contents of a file and scale them to meters."""
    if not len(soup.triangles):
        raise SurfaceError(f"{name}: holds no triangles: export the body as a surface")
    check_count(name, "triangles", len(soup.triangles), room=np.inf)
    lowest, highest = int(soup.triangles.min()), int(soup.triangles.max())
    if lowest < 0 or highest >= len(soup.vertices):
        raise SurfaceError(
            f"{name}: a face names vertex {highest if lowest >= 0 else lowest}, of {len(soup.vertices)} from 0 on: "
            "the file is damaged or cut short, export or copy it again"
        )
    used, triangles = np.unique(soup.triangles, return_inverse=True)
    vertices = soup.vertices[used]
    wrong = np.flatnonzero(~(np.abs(vertices) < 1e100).all(axis=1))
    if len(wrong):
        raise SurfaceError(
            f"{name}: {len(wrong)} vertices are not finite, the first is number {used[wrong[0]]} from 0 on: "
            "repair or export the surface again"
        )
    extent = float(np.ptp(vertices, axis=0).max())
    scale = size / max(extent, 1e-300) if size is not None else (soup.unit or unit)
    if not extent > 1e-9 * np.abs(vertices).max():
        raise SurfaceError(f"{name}: has no size, all its vertices are in one place: export the surface again")
    smallest, largest = 1e-6, 1e4  # m
    if not smallest <= extent * scale <= largest:
        raise SurfaceError(
            f"{name}: is {1e3 * extent * scale:.3g} mm large, which no robot is: {GIVE_SIZE}, "
            "or the unit of its numbers"
        )
    return Surface(vertices * scale, triangles.reshape(-1, 3), soup.notes)


def convert_step(content: bytes, *, name: str, part: int | None = None) -> tuple[bytes, tuple[str, ...]]:
    """Convert a body of a STEP file to PLY in millimeters, with notes; see `read_step` for errors."""
    surface = read_surface(content, name=name, part=part)
    return write_ply(surface), surface.notes
