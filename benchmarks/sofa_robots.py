"""Robots that SOFA's SoftRobots plugin ships, as hydrostat robots.

Each is a folder with `case.json` (mm, kg, s, so kPa and mN) and the mesh that it names. They are no part of hydrostat.
"""

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.geometry import Mesh, locate, read_mesh
from hydrostat.robot import Body, Cable, Marker, Material, Mount, Pin, Point, Robot, Source, Winch

ROBOTS = Path(__file__).parents[2] / "shared" / "robots"
"""Where the folders are, unless told otherwise: beside this checkout."""

MM = 1e-3
KPA = 1e3

CABLE_STIFFNESS = 2e5
"""Of a cable [N/m]: 1 N makes it 0.005 mm longer; SOFA's cables are inextensible."""

CABLE_SMOOTHING = 1e-6
"""[m]; a cable is fully taut 0.002 mm after it begins to be, at 0.4 N."""

PIN_STIFFNESS = 1e7
"""Of a whole pin [N/m]: 1 N moves it by 1e-7 m; SOFA fixes the nodes."""

LARGEST_MOVE = 1.0
"""[mm]; a via point further outside the body than this is an error of the reader."""


def sofa_robots(folder: Path = ROBOTS) -> dict[str, Callable[[], Robot]]:
    """Readers of the robots that a folder holds, by name."""
    readers = {"finger": finger, "trunk": trunk, "diamond": diamond, "diamond_34k": diamond}
    return {
        name: lambda name=name: readers[name](folder / name)
        for name in readers
        if (folder / name / "case.json").is_file()
    }


def finger(folder: Path) -> Robot:
    """A finger with one cable in a U, pulled from a point of the world; the route in its proper order."""
    case = _case(folder)
    route = [case["cable"]["pull_point"], *case["cable"]["points_correct_order"]]
    return _robot(case, _mesh(folder), {"cable": route}, Mount.WORLD, case["effector"])


def trunk(folder: Path) -> Robot:
    """A trunk with four long and four short cables, whose first points are on the base."""
    case = _case(folder)
    routes = {cable["name"]: [cable["points"][place] for place in cable["used_indices"]] for cable in case["cables"]}
    return _robot(case, _mesh(folder), routes, Mount.BODY, case["effector"])


def diamond(folder: Path) -> Robot:
    """Four legs, each with a cable from a point of the world to where it is attached; 4147 or 33719 elements."""
    case = _case(folder)
    routes = {cable["name"]: [cable["pull_point"], cable["point"]] for cable in case["cables"]}
    mesh = _mesh(folder)
    x, y, z = mesh.nodes.T
    turned = Mesh(np.column_stack([x, -z, y + 35 * MM]), mesh.elements)
    return _robot(case, turned, routes, Mount.WORLD, case["effector"])


def _case(folder: Path) -> dict[str, Any]:
    return {"name": folder.name, **json.loads((folder / "case.json").read_text())}


def _mesh(folder: Path) -> Mesh:
    """The only mesh of a folder."""
    (path,) = (file for file in folder.iterdir() if file.suffix in (".vtk", ".vtu"))
    return read_mesh(path, unit=MM)


def _robot(case: dict[str, Any], mesh: Mesh, routes: dict[str, Any], mount: Mount, tip: Iterable[float]) -> Robot:
    """A robot of a mesh in meters and routes in millimeters, one winch for each."""
    material = Material(
        young=case["material"]["young"] * KPA,
        poisson=case["material"]["poisson"],
        density=case["total_mass"] / float(mesh.volumes.sum()),
    )
    low, high = np.reshape(case["fixed"]["box"], (2, 3)) * MM
    lines = {name: _route(mesh, np.array(points, dtype=float) * MM, mount) for name, points in routes.items()}
    (marker,) = _inside(mesh, np.array([tip]) * MM)
    return Robot(
        name=case["name"],
        body=Body(source=Source.MESH, file=case["mesh"], content=b"", material=material, mesh=mesh),
        pins=(Pin(box=(_point(low), _point(high)), stiffness=PIN_STIFFNESS),),
        winches=tuple(Winch(name=name, at=line[0], mount=mount) for name, line in lines.items()),
        cables=tuple(
            Cable(winch=name, points=line, stiffness=CABLE_STIFFNESS, smoothing=CABLE_SMOOTHING)
            for name, line in lines.items()
        ),
        markers=(Marker(name="tip", at=_point(marker)),),
        poses={},
        gravity=_point(np.array(case["gravity"]) * MM),
    )


def _route(mesh: Mesh, points: np.ndarray, mount: Mount) -> tuple[Point, ...]:
    first = 1 if mount is Mount.WORLD else 0
    return tuple(map(_point, [*points[:first], *_inside(mesh, points[first:])]))


def _inside(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    """Points outside the mesh brought to the nearest place of it, where SOFA would extrapolate.

    Raises:
        ValueError: one lies far outside, so the mesh and the points do not belong together.
    """
    anchors = locate(mesh, points)
    if anchors.distances.max() > LARGEST_MOVE * MM:
        raise ValueError(f"a point lies {anchors.distances.max() / MM:.3g} mm outside the body")
    return anchors.positions(mesh.nodes)


def _point(values: Iterable[float]) -> Point:
    return tuple(float(value) for value in values)
