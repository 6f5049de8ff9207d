"""Bodies that benchmarks and studies are measured on: the gallery's hand, a slender rod, robots of SOFA's users.

The hand can be finer or coarser. The rod has nine cables, three to each third of it, as OpenCR's tendon-driven
continuum robot: 186.5 mm long, 5 mm in radius, 722 nodes, cables of 100 N/mm through 12, 24 or 37 via points on a
circle of 4.5 mm. Robots of SOFA's SoftRobots plugin are no part of hydrostat: each is a folder with `case.json` (mm,
kg, s, so kPa and mN) and the mesh that it names.
"""

import json
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.geometry import Mesh, locate, read_labeled_mesh
from hydrostat.given import Point
from hydrostat.robot import Body, Cable, Marker, Material, Mount, Pin, Robot, Source, Winch, gallery_folder, load_robot

HAND = "cupping_hand"

ELEMENT_SIZE = 11.6e-3
"""Of the gallery [m]: about as many nodes and elements as the thesis's hand (N3)."""


def hand_robot(element_size: float = ELEMENT_SIZE) -> Robot:
    """The hand with elements of a size [m]."""
    robot = load_robot(gallery_folder(HAND))
    if element_size == robot.body.element_size:
        return robot
    body = robot.body
    finer = Body.from_surface(
        body.content, file=body.file, unit=1e-3, material=body.material, element_size=element_size, volume=body.volume
    )
    return replace(robot, body=finer)


def hand_mesh(element_size: float = ELEMENT_SIZE) -> Mesh:
    """Its mesh alone."""
    return hand_robot(element_size).body.mesh


LENGTH, RADIUS, CIRCLE = 0.1865, 5e-3, 4.5e-3
LAYERS, ENDS = 38, (13, 25, 38)
"""Layers of nodes along the rod, and how many of them the cables of each third pass."""


def rod_robot(friction: float) -> Robot:
    """The rod, its cables with a friction coefficient."""
    body = Body(
        source=Source.MESH, file="rod.vtk", content=b"", mesh=rod_mesh(),
        material=Material(young=5e6, poisson=0.3, density=1000.0),
    )  # fmt: skip
    heights = np.linspace(0, LENGTH, LAYERS)
    winches, cables = [], []
    for third, end in enumerate(ENDS):
        for turn in range(3):
            angle = 0.5 * third + 2 * np.pi * turn / 3
            x, y = CIRCLE * np.cos(angle), CIRCLE * np.sin(angle)
            name, points = f"{third + 1}{turn + 1}", tuple((x, y, float(height)) for height in heights[1:end])
            winches.append(Winch(name=name, at=(x, y, 0.0), travel=0.02, release=0.012))
            cables.append(Cable(winch=name, points=points, stiffness=1e5, friction=friction))
    foot = Pin(box=((-0.01, -0.01, -1e-4), (0.01, 0.01, 1e-4)))
    tip = Marker(name="tip", at=(0.0, 0.0, LENGTH))
    return Robot(
        name="rod", body=body, pins=(foot,), winches=tuple(winches), cables=tuple(cables), markers=(tip,), poses={}
    )


def rod_mesh() -> Mesh:
    """Layers of 19 nodes, prisms between them, three tetrahedra in each."""
    from scipy.spatial import Delaunay

    rings = [np.zeros((1, 2))]
    for ring in (1, 2):
        angles = 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        rings.append(0.5 * ring * RADIUS * np.column_stack([np.cos(angles), np.sin(angles)]))
    flat = np.concatenate(rings)
    low = np.sort(Delaunay(flat).simplices, axis=1)
    low = low[_areas(flat[low]) > 1e-3 * RADIUS**2]  # on a circle some have no area
    high = low + len(flat)
    parts = [
        np.column_stack([low, high[:, 2]]),
        np.column_stack([low[:, :2], high[:, 1:]]),
        np.column_stack([low[:, 0], high]),
    ]
    layer = np.concatenate(parts)
    elements = np.concatenate([layer + step * len(flat) for step in range(LAYERS - 1)])
    nodes = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in np.linspace(0, LENGTH, LAYERS)])
    sides = nodes[elements][:, 1:] - nodes[elements][:, :1]
    elements[np.linalg.det(sides) < 0] = elements[np.linalg.det(sides) < 0][:, [0, 2, 1, 3]]
    return Mesh(nodes, elements)


def rod_commands(count: int) -> Float[np.ndarray, "commands 9"]:
    """Contractions that bend each third by itself, up to 5 mm, (count, 9) [m]."""
    random = np.random.default_rng(0)
    ways, sizes = random.uniform(0, 2 * np.pi, (count, 3)), random.uniform(0, 5e-3, (count, 3))
    turns = 2 * np.pi * np.arange(3) / 3
    return (sizes[:, :, None] * np.cos(turns - ways[:, :, None])).reshape(count, 9)


def _areas(corners: np.ndarray) -> Vector:
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return np.abs(ax * by - ay * bx)


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
    return read_labeled_mesh(path, unit=MM)[0]


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
