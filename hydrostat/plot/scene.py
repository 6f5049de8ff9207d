"""`save_glb`: an animation of a robot as a scene that can be turned and walked about."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.drawing import Camera, Color, Spots
from hydrostat.errors import InputError
from hydrostat.files import replace_file
from hydrostat.plot.frame import Attachments, Frame, check_frames
from hydrostat.plot.glb import Glb, GlbPart
from hydrostat.plot.open_sheet import way_up
from hydrostat.plot.sheet import Spread
from hydrostat.plot.solids import Solid, cross, join_solids, skin, slab, sphere, spool, tube
from hydrostat.plot.targets import target_points
from hydrostat.plot.tension_scale import TensionScale
from hydrostat.robot import PoseTarget, Robot

MAX_KEYS = 120  # of a film of more different frames every second, third ... is a key: programs hold them all at once
CABLE, MARKER, TARGET = 0.0045, 0.011, 0.05
"""Radius of a cable and of a marker, and length of a target's cross, in sizes of the body."""

SPOOL = (0.012, 0.045)  # least and largest radius of a spool that is shown, in sizes of the body


def save_glb(robot: Robot, frames: Sequence[Frame], path: str | Path, *, step: float) -> Path:
    """Write frames, a step [s] apart, as a binary glTF 2.0 scene, whole or not at all; returns its path.

    Every frame that differs is a morph target of body and cables, and an animation goes from one to the next; winches,
    stoppers and markers are carried along. Cables are colored by tension, targets are there while a pose is
    approached, a flat body is a slab of its thickness. Meters; what is up is y, as glTF wants it.

    Raises:
        InputError: frames that do not fit the robot, a time that is not above 0, a file that cannot be written.
    """
    check_frames(robot, frames)
    if not 0 < step < np.inf:
        raise InputError(f"the time of a frame must be above 0 s, not {step:g} s")
    film = _Film.of(robot, frames)
    kept = _instants(film.order, [frame.target for frame in frames])
    glb = Glb(robot.name, turn=_turn(robot))
    glb.add(_body(film))
    if robot.cables:
        glb.add(_cables(film))
    _add_hardware(glb, film)
    _add_targets(glb, robot, [frames[place].target for place in kept])
    glb.animate(step * np.array(kept, dtype=float), [film.order[place] for place in kept], name="poses")
    return replace_file(Path(path), glb.content())


@dataclass(frozen=True, eq=False)
class _Film:
    """Frames without those that repeat another."""

    robot: Robot  # that moves
    keys: list[Frame]  # frames that differ
    order: list[int]  # the key of every frame, -1 where it is between two
    nodes: Float[np.ndarray, "keys nodes dim"]  # positions of the nodes in every key [m]

    @classmethod
    def of(cls, robot: Robot, frames: Sequence[Frame]) -> Self:
        keys, order = _distinct(robot, frames)
        if len(keys) > MAX_KEYS:
            stride = -(-len(frames) // MAX_KEYS)
            kept = [index for index in range(len(frames)) if index % stride == 0 or index == len(frames) - 1]
            keys, some = _distinct(robot, [frames[index] for index in kept])
            order = [-1] * len(frames)
            for index, key in zip(kept, some, strict=True):
                order[index] = key
        return cls(robot, keys, order, np.stack([key.nodes for key in keys]))


def _distinct(robot: Robot, frames: Sequence[Frame]) -> tuple[list[Frame], list[int]]:
    """Frames that differ, and which of them each frame is."""
    same = 1e-5  # two frames are one key where no node differs by more than this, in sizes of the body
    near = same * robot.body.mesh.size
    most = max(float(frame.tensions.max(initial=0.0)) for frame in frames)
    keys: list[Frame] = []
    order: list[int] = []
    for frame in frames:
        for index, key in enumerate(keys):
            if (
                np.abs(key.nodes - frame.nodes).max() <= near
                and np.abs(key.tensions - frame.tensions).max(initial=0.0) <= 1e-3 * most
            ):
                order.append(index)
                break
        else:
            order.append(len(keys))
            keys.append(frame)
    return keys, order


def _instants(order: Sequence[int], targets: Sequence[PoseTarget | None]) -> list[int]:
    """Numbers of the frames that tell all: without those between others of the same key and the same targets."""
    known = [(index, key, targets[index]) for index, key in enumerate(order) if key >= 0]
    inner = [
        here[0]
        for before, here, after in zip(known, known[1:], known[2:], strict=False)
        if not before[1:] == here[1:] == after[1:]
    ]
    return sorted({known[0][0], *inner, known[-1][0]})


def _turn(robot: Robot) -> tuple[float, float, float, float]:
    """The turn that brings what is up for a robot to y, as a quaternion (x, y, z, w)."""
    from scipy.spatial.transform import Rotation

    if robot.body.mesh.dim == 2:
        return 0.0, 0.0, 0.0, 1.0
    to_y = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    x, y, z, w = Rotation.from_matrix(to_y @ Camera.upright(way_up(robot))).as_quat()
    return float(x), float(y), float(z), float(w)


def _body(film: _Film) -> GlbPart:
    body = film.robot.body
    solid = skin(body.mesh, film.nodes) if body.mesh.dim == 3 else slab(body.mesh, film.nodes, body.thickness or 0.0)
    opacity = 0.72  # of a body that has cables: they run inside, mostly
    return _shape("body", solid, Color.FELT, opacity=opacity if film.robot.cables else 1.0)


def _cables(film: _Film) -> GlbPart:
    """A tube for each cable, in the colors of tension."""
    carried, size = Attachments(film.robot), film.robot.body.mesh.size
    runs = [[_in_space(points) for points in carried.cables(nodes)] for nodes in film.nodes]
    scale = TensionScale.of(np.concatenate([key.tensions for key in film.keys]))
    solids, colors = [], []
    for index in range(len(film.robot.cables)):
        solids.append(tube(np.stack([run[index] for run in runs]), CABLE * size))
        shades = np.array([_linear(scale.color(float(key.tensions[index]))) for key in film.keys])
        colors.append(np.repeat(shades[:, None], solids[-1][1].shape[1], axis=1))
    triangles, places, normals = join_solids(solids)
    every = np.concatenate(colors, axis=1)
    return GlbPart(name="cables", triangles=triangles, places=places, normals=normals, colors=every)


def _add_hardware(glb: Glb, film: _Film) -> None:
    """Spools, and balls for markers and for the ends of cables, which the body carries without turning them."""
    robot, carried, size = film.robot, Attachments(film.robot), film.robot.body.mesh.size
    ways = {winch.name: np.array([1.0, 0.0, 0.0]) for winch in robot.winches}
    for cable in reversed(robot.cables):
        ends = _in_space(np.array(cable.points[:2], dtype=float))
        ways[cable.winch] = ends[1] - ends[0]
    colors, winches = Color.of_winches(robot.winches), _carry_places(film, carried.winches)
    for index, winch in enumerate(robot.winches):
        radius = min(max(robot.largest_spool(winch), SPOOL[0] * size), SPOOL[1] * size)
        shape = _shape(f"winch {winch.name}", spool(ways[winch.name], radius), colors[winch.name])
        glb.add_copies(shape, winches[:, [index]], [shape.name])
    if robot.cables:
        ends = _carry_places(film, lambda nodes: np.array([points[-1] for points in carried.cables(nodes)]))
        names = [f"stopper {number}" for number in range(1, len(robot.cables) + 1)]
        glb.add_copies(_shape("stopper", sphere(2.2 * CABLE * size), Color.DARK), ends, names)
    if robot.markers:
        names = [f"marker {marker.name}" for marker in robot.markers]
        glb.add_copies(
            _shape("marker", sphere(MARKER * size), Color.LIGHT), _carry_places(film, carried.markers), names
        )


def _carry_places(film: _Film, places: Callable[[Nodes], Points]) -> Float[np.ndarray, "_ _ 3"]:
    """Places of points in every key [m]."""
    return np.stack([_in_space(places(nodes)) for nodes in film.nodes])


def _add_targets(glb: Glb, robot: Robot, targets: Sequence[PoseTarget | None]) -> None:
    """A cross at each target, there at the instants whose pose it belongs to."""
    poses = list({pose.name: pose for pose in targets if pose is not None}.values())
    if poses:
        shape = _shape("target", cross(TARGET * robot.body.mesh.size), Color.DARK)
        places = np.concatenate([_in_space(target_points(pose)) for pose in poses])
        names = [f"target {pose.name}: {marker}" for pose in poses for marker in pose.targets]
        seen = [[target == pose for pose in poses for _ in pose.targets] for target in targets]
        glb.add_copies(shape, places[None], names, np.array(seen))


def _shape(name: str, solid: Solid, color: str, *, opacity: float = 1.0) -> GlbPart:
    triangles, places, normals = solid
    told = np.tile(_linear(color), (1, places.shape[1], 1))
    return GlbPart(name=name, triangles=triangles, places=places, normals=normals, colors=told, opacity=opacity)


def _in_space(points: Spread) -> Spots:
    """Points in the plane as points in space, in the middle of the body's thickness."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _linear(color: str) -> Vector:
    """A color of a screen (sRGB) as shares of light, which glTF wants."""
    shares = np.array(Color.channels(color)) / 255
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
