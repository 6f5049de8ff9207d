"""First robots from nothing but a body in space, to be edited from there."""

from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry.healing.heal import Healing, heal
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.sizing import size_for
from hydrostat.geometry.surface import Surface
from hydrostat.robot.body import Body, Source, mesh_body
from hydrostat.robot.materials import find_material
from hydrostat.robot.rig import rigged
from hydrostat.robot.robot import Robot

NODES = 900
"""Of a sketch, if neither a number nor an element size is asked for: as many as the thesis's hand (N3)."""

SHORTEST, LONGEST = 0.002, 20.0
"""Bodies are as long [m]; what is not was probably meant in another unit."""


@dataclass(frozen=True, eq=False)
class SurfaceSketch:
    """A robot from a surface, and how that was healed.

    Attributes:
        robot: its body's file is the one that came if that was clean, else the healed surface as PLY.
        before: the surface as it came.
        healing: of it.
    """

    robot: Robot
    before: Surface
    healing: Healing


def sketch_surface(
    content: bytes,
    *,
    file: str,
    name: str,
    size: float | None = None,
    element_size: float | None = None,
    nodes: int = NODES,
    material: str = "flexfoam-it x",
) -> SurfaceSketch:
    """Robot from the bytes of a scan or CAD model; coordinates count in mm if the file does not say.

    Args:
        content: of an STL, OBJ, PLY, OFF or 3MF file.
        file: its name.
        name: of the robot.
        size: longest side of the bounding box [m]; None: as the file says.
        element_size: [m]; None: so that there are about as many nodes as asked for.
        nodes: wanted; not used with an element size.
        material: a name from the table.

    Raises:
        InputError: the file is no body.
    """
    from hydrostat.geometry.files.ply_file import write_ply
    from hydrostat.geometry.files.surface_file import read_surface
    from hydrostat.geometry.tetrahedra.tetrahedralise import tetrahedralise

    known = find_material(material)
    before = read_surface(content, name=file, size=size)
    _check_scale(before.size, size)
    healing = heal(before, resolution=(element_size or _guess(before, nodes)) / 4)
    closed, meshes = healing.surface, {}

    def fill(trial: float) -> Mesh:
        meshes[trial] = tetrahedralise(closed, trial)
        return meshes[trial]

    length = element_size or size_for(nodes, fill, content=closed.volume, rim=closed.area, dim=3)
    if not healing.clean:
        content, file, size = write_ply(closed), f"{PurePath(file).stem}_healed.ply", None
    body = Body(
        source=Source.SURFACE,
        file=file,
        content=content,
        material=known,
        size=size,
        element_size=length,
        mesh=meshes[length] if length in meshes else fill(length),
        healing=healing,
    )
    return SurfaceSketch(rigged(body, name), before, healing)


def sketch_mesh(path: Path, *, name: str, size: float | None = None, material: str = "flexfoam-it x") -> Robot:
    """Robot from a ready mesh of tetrahedra, whose coordinates count in mm unless a size [m] is given.

    Raises:
        InputError: the file holds no mesh in space.
    """
    body = mesh_body(path, unit=1e-3, material=find_material(material), size=size)
    _check_scale(body.mesh.size, size)
    return rigged(body, name)


def _check_scale(length: float, size: float | None) -> None:
    """Refuse bodies so small or large that the file probably counts in another unit."""
    if SHORTEST <= length <= LONGEST:
        return
    meant = 1e3 * length if length < SHORTEST else 1e-3 * length
    hint = f'; files without a unit are read as mm: give a size, perhaps "{1e3 * meant:.3g} mm"' if size is None else ""
    raise InputError(f"the body would be {1e3 * length:.3g} mm long, not {1e3 * SHORTEST:g} mm to {LONGEST:g} m{hint}")


def _guess(surface: Surface, nodes: int) -> float:
    """Element size [m] for a number of nodes in a surface that may be open."""
    box = float(np.prod(np.ptp(surface.box, axis=0)))
    return float((max(min(abs(surface.volume), box), 0.05 * box, 1e-3 * surface.size**3) / nodes) ** (1 / 3))
