"""A hand of foam, the robot in space that benchmarks are measured on: palm, five fingers, ten cables.

    python benchmarks/hand_body.py [--spacing 9.755] [--out build/hand]

prints its size, its quality and how its volume compares with that of the shape, as manifold3d meshes it; with --out it
writes the robot to a folder, an example of a robot in space.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

from machine import machine

import numpy as np  # isort: skip

from jaxtyping import Float, Int

from hydrostat.arrays import Elements, Nodes, Points, Vector
from hydrostat.geometry.anchors import locate
from hydrostat.geometry.mesh import Mesh
from hydrostat.geometry.mesh_file import write_mesh
from hydrostat.geometry.quality import dihedral_angles
from hydrostat.robot import Body, Cable, Marker, Pin, Point, Robot, Source, Winch, find_material, save_robot

SPACING = 9.755e-3
"""Side of a cell of the lattice [m]: 916 nodes or so."""

LEAST_DIHEDRAL = 15.0
"""No tetrahedron gets a smaller angle between two faces [degrees]; those of the lattice have 60."""

FINGERS = {
    "thumb": ((0.030, 0.028), (0.071, 0.076), 0.0095),
    "index": ((0.030, 0.080), (0.045, 0.150), 0.0085),
    "middle": ((0.010, 0.080), (0.016, 0.1715), 0.0085),
    "ring": ((-0.010, 0.080), (-0.016, 0.162), 0.0085),
    "little": ((-0.030, 0.080), (-0.045, 0.136), 0.0080),
}
"""Where the axis of each finger begins and ends, and its radius [m]; x goes across, y from the wrist, z to the back."""

_PALM = np.array([0.040, 0.045, 0.0125])
_PALM_MIDDLE = np.array([0.0, 0.045, 0.0])
_CORNER = 0.012
_BLEND = 0.004
_BOX = np.array([[-0.07, -0.01, -0.02], [0.1, 0.195, 0.02]])


def distance(points: Points) -> Vector:
    """About how far points are outside the hand [m], negative inside: a rounded box and capsules, blended smoothly."""
    beyond = np.abs(points - _PALM_MIDDLE) - (_PALM - _CORNER)
    result = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0) - _CORNER
    for base, tip, radius in FINGERS.values():
        start, axis = np.array([*base, 0.0]), np.array([*np.subtract(tip, base), 0.0])
        share = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
        capsule = np.linalg.norm(points - start - share[:, None] * axis, axis=1) - radius
        blend = np.clip(0.5 + 0.5 * (capsule - result) / _BLEND, 0, 1)
        result = capsule + blend * (result - capsule) - _BLEND * blend * (1 - blend)
    return result


def hand_mesh(spacing: float = SPACING) -> Mesh:
    """Tetrahedra that fill the hand: those of a lattice that lie inside, with the outer nodes moved to the surface."""
    nodes, elements = _lattice(spacing)
    elements = elements[distance(nodes[elements].mean(axis=1)) < 0]
    mesh = _parted(nodes, _largest_part(elements))
    for _ in range(4):
        mesh = _moved(mesh, _smoothed(mesh))
        mesh = _moved(mesh, _snapped(mesh))
    return mesh


def hand_robot(spacing: float = SPACING) -> Robot:
    """The hand held at the wrist, with a flexor on the palm's side and an extensor on the back of each finger."""
    mesh = hand_mesh(spacing)
    winches, cables, markers = [], [], []
    for place, (finger, (base, tip, radius)) in enumerate(FINGERS.items()):
        for kind, side in (("flexor", -1), ("extensor", 1)):
            route = _inside(mesh, _route(place, np.array(base), np.array(tip), side * 0.55 * radius))
            name = f"{finger} {kind}"
            winches.append(Winch(name=name, at=route[0]))
            cables.append(Cable(winch=name, points=route))
        markers.append(Marker(name=finger, at=_inside(mesh, np.array([[*tip, 0.0]]))[0]))
    return Robot(
        name="hand",
        body=Body(source=Source.MESH, file="hand.vtu", content=b"", material=find_material("flexfoam-it x"), mesh=mesh),
        pins=(Pin(box=((-0.1, -0.01, -0.1), (0.1, 0.010, 0.1))),),
        winches=tuple(winches),
        cables=tuple(cables),
        markers=tuple(markers),
        poses={},
    )


def surface_volume(edge: float = 2e-3) -> float:
    """Volume of the hand [m^3] by manifold3d, which meshes the same distance in its own way."""
    from manifold3d import Manifold

    bounds = [float(value) for value in _BOX.ravel() * 1e3]
    solid = Manifold.level_set(
        lambda x, y, z: -1e3 * float(distance(np.array([[x, y, z]]) / 1e3)[0]), bounds, edge * 1e3
    )
    return solid.volume() * 1e-9


def _lattice(spacing: float) -> tuple[Nodes, Elements]:
    """Body-centred cubic lattice over the box, its tetrahedra all alike (dihedral angles 60 and 90 degrees).

    Each edge of a face between two cells makes one with the middles of both cells.
    """
    cells = np.ceil((_BOX[1] - _BOX[0]) / spacing).astype(int) + 1
    centre = (cells + 1) // 2 * spacing
    shift = (_BOX[0] + _BOX[1]) / 2 - centre
    corners = np.stack(np.meshgrid(*[np.arange(count + 1) for count in cells], indexing="ij"), axis=-1)
    middles = np.stack(np.meshgrid(*[np.arange(count) + 0.5 for count in cells], indexing="ij"), axis=-1)
    nodes = np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3)]) * spacing + shift
    corner = np.arange(np.prod(cells + 1)).reshape(cells + 1)
    middle = len(corner.ravel()) + np.arange(np.prod(cells)).reshape(cells)
    elements = []
    for axis in range(3):
        before, after = np.moveaxis(middle, axis, 0)[:-1], np.moveaxis(middle, axis, 0)[1:]
        face = np.moveaxis(corner, axis, 0)[1:-1]
        ring = [face[:, :-1, :-1], face[:, 1:, :-1], face[:, 1:, 1:], face[:, :-1, 1:]]
        for one, two in zip(ring, ring[1:] + ring[:1], strict=True):
            elements.append(np.stack([before, after, one, two], axis=-1).reshape(-1, 4))
    elements = np.concatenate(elements)
    sides = nodes[elements]
    flipped = np.linalg.det(sides[:, 1:] - sides[:, :1]) < 0
    elements[flipped] = elements[flipped][:, [1, 0, 2, 3]]
    return nodes, elements


def _largest_part(elements: Elements) -> Elements:
    """Without tetrahedra that hang on by one face or less, and what is then not joined by faces."""
    while True:
        one, two = _joins(elements)[:2] // 4
        parts = _parts(one, two, len(elements))
        hold = np.bincount([*one, *two], minlength=len(elements)) // 3
        kept = (parts == np.argmax(np.bincount(parts))) & (hold > 1)
        if kept.all():
            return elements
        elements = elements[kept]


def _joins(elements: Elements) -> Int[np.ndarray, "2 joins"]:
    """Pairs of corners (4 x element + corner) that are the same node of a face that two elements share."""
    corners = np.arange(4 * len(elements)).reshape(-1, 4)
    corners = np.take_along_axis(corners, np.argsort(elements, axis=1), axis=1)
    faces = np.concatenate([np.delete(corners, corner, axis=1) for corner in range(4)])
    names = elements.ravel()[faces]
    order = np.lexsort(names.T)
    same = np.flatnonzero((names[order][1:] == names[order][:-1]).all(axis=1))
    return np.stack([faces[order[same]].ravel(), faces[order[same + 1]].ravel()])


def _parts(one: Int[np.ndarray, " joins"], two: Int[np.ndarray, " joins"], count: int) -> Int[np.ndarray, " count"]:
    """Number of the part to which each of `count` things belongs that are joined in pairs."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    joined = coo_array((np.ones(len(one)), (one, two)), shape=(count, count))
    return connected_components(joined, directed=False)[1]


def _parted(nodes: Nodes, elements: Elements) -> Mesh:
    """A node for every group of tetrahedra that are joined by faces about it: where two fingers only touch, two."""
    one, two = _joins(elements)
    parts = _parts(one, two, elements.size)
    places = np.zeros((parts.max() + 1, 3))
    places[parts] = nodes[elements.ravel()]
    return Mesh(places, parts.reshape(-1, 4))


def _smoothed(mesh: Mesh) -> Nodes:
    """Inner nodes half way to the mean of their neighbours."""
    pairs = np.unique(np.concatenate([mesh.elements[:, list(p)] for p in combinations(range(4), 2)]), axis=0)
    total, count = np.zeros_like(mesh.nodes), np.zeros(len(mesh.nodes))
    for one, two in (pairs.T, pairs.T[::-1]):
        np.add.at(total, one, mesh.nodes[two])
        np.add.at(count, one, 1.0)
    goal = 0.5 * mesh.nodes + 0.5 * total / count[:, None]
    goal[mesh.boundary_nodes] = mesh.nodes[mesh.boundary_nodes]
    return goal


def _snapped(mesh: Mesh) -> Nodes:
    """Outer nodes on the surface.

    From outside on the way to the middle of their own tetrahedra, for another finger may be nearer; else by two Newton
    steps along the gradient of the distance.
    """
    goal, outer = mesh.nodes.copy(), mesh.boundary_nodes
    middles, count = np.zeros_like(goal), np.bincount(mesh.elements.ravel())
    np.add.at(middles, mesh.elements, mesh.nodes[mesh.elements].mean(axis=1, keepdims=True))
    middles = (middles / count[:, None])[outer]
    inside, outside = middles.copy(), mesh.nodes[outer]
    for _ in range(12):
        half = (inside + outside) / 2
        out = (distance(half) > 0)[:, None]
        inside, outside = np.where(out, inside, half), np.where(out, half, outside)
    between = (distance(mesh.nodes[outer]) > 0) & (distance(middles) < 0)
    goal[outer[between]] = inside[between]
    rest = outer[~between]
    for _ in range(2):
        slope = np.column_stack(
            [(distance(goal[rest] + step) - distance(goal[rest] - step)) / 2e-5 for step in 1e-5 * np.eye(3)]
        )
        size = np.maximum((slope**2).sum(axis=1), 0.25)
        goal[rest] -= (distance(goal[rest]) / size)[:, None] * slope
    return goal


def _moved(mesh: Mesh, goal: Nodes) -> Mesh:
    """Nodes moved towards a goal, each as far as no tetrahedron becomes too flat."""
    share = np.ones(len(mesh.nodes))
    for halving in range(8):
        nodes = mesh.nodes + share[:, None] * (goal - mesh.nodes)
        flat = dihedral_angles(nodes, mesh.elements) < LEAST_DIHEDRAL
        if not flat.any():
            return Mesh(nodes, mesh.elements)
        share[mesh.elements[flat]] *= 0.5 if halving < 4 else 0.0
    return mesh


def _route(place: int, base: Vector, tip: Vector, height: float) -> Points:
    """Winch near the wrist, a point in the palm, six along the finger."""
    winch = np.array([0.030 - 0.015 * place, 0.016, np.sign(height) * 0.007])
    palm = np.array([*(0.35 * winch[:2] + 0.65 * base), np.sign(height) * 0.007])
    along = [np.array([*(base + share * (tip - base)), height]) for share in np.linspace(0.05, 0.98, 6)]
    return np.array([winch, palm, *along])


def _inside(mesh: Mesh, points: Float[np.ndarray, "points 3"]) -> tuple[Point, ...]:
    """Points that a coarse mesh leaves outside brought to the nearest place of it."""
    return tuple(tuple(float(value) for value in point) for point in locate(mesh, points).positions(mesh.nodes))


def write_robot(robot: Robot, folder: Path) -> None:
    """A folder with robot.toml and hand.vtu."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "hand.vtu"
    write_mesh(file, robot.body.mesh, robot.body.mesh.nodes, {})
    body = replace(robot.body, file=file.name, content=file.read_bytes())
    save_robot(replace(robot, body=body, length_unit="m"), folder)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--spacing", type=float, default=SPACING * 1e3, help="side of a cell of the lattice [mm]")
    parser.add_argument("--out", type=Path, help="folder to write the robot to, for `hydrostat simulate`")
    options = parser.parse_args(arguments)
    robot = hand_robot(options.spacing * 1e-3)
    if options.out is not None:
        write_robot(robot, options.out)
    mesh, angles = robot.body.mesh, dihedral_angles(robot.body.mesh.nodes, robot.body.mesh.elements)
    outside = np.abs(distance(mesh.nodes[mesh.boundary_nodes]))
    print(machine())
    print(f"{len(mesh.nodes)} nodes, {len(mesh.elements)} elements, {len(robot.cables)} cables")
    print(f"size {np.round(np.ptp(mesh.nodes, axis=0) * 1e3, 1)} mm")
    print(f"dihedral angles from {angles.min():.1f} degrees; median of the smallest {np.median(angles):.1f}")
    print(
        f"outer nodes off the surface: median {1e3 * np.median(outside):.2f} mm, at most {1e3 * outside.max():.2f} mm"
    )
    print(f"volume {1e6 * mesh.volumes.sum():.1f} cm^3, of the shape by manifold3d {1e6 * surface_volume():.1f} cm^3")


if __name__ == "__main__":
    main()
