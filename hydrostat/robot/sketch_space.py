"""First robots from nothing but a body in space, to be edited from there."""

from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Points, Vector
from hydrostat.geometry.anchors import locate
from hydrostat.geometry.healing.heal import Healing, heal
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.sizing import size_for
from hydrostat.geometry.surface import Surface
from hydrostat.robot.body import Body, Source, mesh_body
from hydrostat.robot.cable import Cable
from hydrostat.robot.marker import Marker
from hydrostat.robot.materials import find_material
from hydrostat.robot.pin import Pin
from hydrostat.robot.point import Point
from hydrostat.robot.pose import Pose
from hydrostat.robot.robot import Robot
from hydrostat.robot.winch import Winch

NODES = 900
"""Of a sketch, if neither a number nor an element size is asked for: as many as the thesis's hand (N3)."""

_STATIONS = np.linspace(0.05, 0.93, 12)
_BASE, _TIP = 0.10, 0.07


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
    return SurfaceSketch(_rigged(body, name), before, healing)


def sketch_mesh(path: Path, *, name: str, size: float | None = None, material: str = "flexfoam-it x") -> Robot:
    """Robot from a ready mesh of tetrahedra, whose coordinates count in mm unless a size [m] is given.

    Raises:
        InputError: the file holds no mesh in space.
    """
    return _rigged(mesh_body(path, unit=1e-3, material=find_material(material), size=size), name)


def _guess(surface: Surface, nodes: int) -> float:
    """Element size [m] for a number of nodes in a surface that may be open."""
    box = float(np.prod(np.ptp(surface.box, axis=0)))
    return float((max(min(abs(surface.volume), box), 0.05 * box, 1e-3 * surface.size**3) / nodes) ** (1 / 3))


def _rigged(body: Body, name: str) -> Robot:
    """A body held at the thicker end of its longest side, with one cable along one side and a marker at the other end.

    Everything is meant to be changed.
    """
    middles = body.mesh.nodes[body.mesh.elements].mean(axis=1)
    low, high = body.mesh.nodes.min(axis=0), body.mesh.nodes.max(axis=0)
    axis = int(np.argmax(high - low))
    along = (middles[:, axis] - low[axis]) / (high[axis] - low[axis])
    turned = body.mesh.volumes[along > 1 - 2 * _BASE].sum() > body.mesh.volumes[along < 2 * _BASE].sum()
    share = 1 - along if turned else along
    side = _side(body, axis)
    route = _route(body, middles, share, side)
    tip = _inside(body, _mean(body, middles, share > min(1 - _TIP, share.max() - 1e-9)))
    base = _mean(body, middles, share < _BASE)
    cable = Cable(winch="pull", points=route)
    arm = tip - base
    bent = base + 0.95 * (np.cos(0.4) * arm + np.sin(0.4) * np.linalg.norm(arm) * side)
    margin = 0.05 * (high - low)
    corner, other = low - margin, high + margin
    if turned:
        corner[axis] = high[axis] - _BASE * (high - low)[axis]
    else:
        other[axis] = low[axis] + _BASE * (high - low)[axis]
    return Robot(
        name=name,
        body=body,
        pins=(Pin(box=(_point(corner), _point(other))),),
        winches=(Winch(name="pull", at=route[0], travel=_round(0.4 * cable.length)),),
        cables=(cable,),
        markers=(Marker(name="tip", at=_point(tip)),),
        poses={"bend": Pose(name="bend", targets={"tip": _point(bent)})},
    )


def _side(body: Body, axis: int) -> Vector:
    """The way across in which a body is thinnest, so that it bends easily."""
    spread = np.var(body.mesh.nodes, axis=0)
    spread[axis] = np.inf
    return np.eye(3)[int(np.argmin(spread))]


def _route(body: Body, middles: Points, share: Vector, side: Vector) -> tuple[Point, ...]:
    """Points along a body, half way between its middle line and its skin on one side."""
    points: list[Point] = []
    for station in _STATIONS:
        band = np.abs(share - station) < 0.05
        if not band.any():
            continue
        middle = _mean(body, middles, band)
        half = float(((middles[band] - middle) @ side).max())
        point = _point(_inside(body, middle + 0.4 * half * side))
        if not points or np.linalg.norm(np.subtract(point, points[-1])) > 1e-3:
            points.append(point)
    return tuple(points)


def _mean(body: Body, middles: Points, chosen: np.ndarray) -> Vector:
    return np.average(middles[chosen], axis=0, weights=body.mesh.volumes[chosen])


def _inside(body: Body, place: Vector) -> Vector:
    """The place itself, or if it is outside one a little inside the nearest element."""
    found = locate(body.mesh, place[None])
    if found.inside[0]:
        return place
    return body.mesh.nodes[found.stencils[0]].mean(axis=0)


def _point(place: Float[np.ndarray, " 3"]) -> Point:
    """To a hundredth of a millimetre."""
    return tuple(round(float(value), 5) for value in place)


def _round(length: float) -> float:
    return max(round(length, 3), 1e-3)
