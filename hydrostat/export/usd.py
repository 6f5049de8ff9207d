"""`usd_text`: a motion of a robot as a USD scene (usda)."""

import re
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from hydrostat.arrays import Int, Nodes, Points
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh, locate
from hydrostat.robot import Mount, Robot


def usd_text(robot: Robot, frames: Sequence[Nodes], *, step: float) -> str:
    """Return a USD scene as text, in which body and cables deform: time-sampled points, meters, z up.

    Args:
        robot: robot to write; a flat body is a slab of its thickness.
        frames: positions of the nodes at equal times [m].
        step: time between frames [s].

    Raises:
        InputError: no frame, a frame that does not fit the robot, or a step that is not above 0.
    """
    shape = robot.body.mesh.nodes.shape
    for index, frame in enumerate(frames):
        if np.shape(frame) != shape or not np.isfinite(frame).all():
            raise InputError(f"frame {index} must be finite, {shape}, not {np.shape(frame)}")
    if not len(frames) or not 0 < step < np.inf:
        raise InputError(f"a scene needs frames and a time step above 0 s, not {len(frames)} frames and {step:g} s")
    return "\n".join(_lines(robot, frames, step)) + "\n"


def _lines(robot: Robot, frames: Sequence[Nodes], step: float) -> Iterator[str]:
    root = "robot"
    yield "#usda 1.0"
    yield f'(\n    defaultPrim = "{root}"\n    metersPerUnit = 1\n    upAxis = "Z"\n    startTimeCode = 0'
    yield f"    endTimeCode = {len(frames) - 1}\n    timeCodesPerSecond = {1 / step:.9g}\n)\n"
    yield f'def Xform "{root}" (\n    displayName = "{_escape(robot.name)}"\n)\n{{'
    yield from _body(robot, frames)
    for number, (cable, places) in enumerate(zip(robot.cables, _cable_places(robot, frames), strict=True)):
        yield f'    def BasisCurves "cable_{number}" (\n        displayName = "{_escape(cable.name)}"\n    )\n    {{'
        yield '        uniform token type = "linear"'
        yield f"        int[] curveVertexCounts = [{len(cable.points)}]"
        yield '        float[] widths = [0.001] (\n            interpolation = "constant"\n        )'
        yield "        color3f[] primvars:displayColor = [(0.1, 0.1, 0.1)]"
        yield from _moving("points", "point3f[]", places)
        yield "    }"
    yield "}"


def _body(robot: Robot, frames: Sequence[Nodes]) -> Iterator[str]:
    faces, lift = _skin(robot.body.mesh)
    used, numbers = np.unique(np.concatenate([face.ravel() for face in faces]), return_inverse=True)
    counts = np.concatenate([np.full(len(face), face.shape[1]) for face in faces])
    half = 0.5 * (robot.body.thickness or 0.0)
    copies = [np.concatenate([_in_space(frame, -half), _in_space(frame, half)]) if lift else frame for frame in frames]
    yield '    def Mesh "body"\n    {'
    yield '        uniform token subdivisionScheme = "none"'
    yield f"        int[] faceVertexCounts = [{', '.join(map(str, counts))}]"
    yield f"        int[] faceVertexIndices = [{', '.join(map(str, numbers))}]"
    yield "        color3f[] primvars:displayColor = [(0.85, 0.45, 0.35)]"
    yield from _moving("points", "point3f[]", [copy[used] for copy in copies])
    yield "    }"


def _skin(mesh: Mesh) -> tuple[list[Int[np.ndarray, "faces corners"]], bool]:
    """Faces of the skin, outward, and True where nodes have a lower and an upper copy: the body is flat."""
    if mesh.dim == 3:
        return [mesh.boundary], False
    count, edges = len(mesh.nodes), mesh.boundary
    sides = np.column_stack([edges, edges[:, ::-1] + count])
    return [mesh.elements[:, ::-1], mesh.elements + count, sides], True


def _cable_places(robot: Robot, frames: Sequence[Nodes]) -> list[list[Points]]:
    """Points of each cable in each frame [m]; a winch in the world stays."""
    found = []
    for cable in robot.cables:
        rest = np.array(cable.points, dtype=float)
        anchors, stays = locate(robot.body.mesh, rest), np.zeros(len(rest), dtype=bool)
        stays[0] = robot.winch(cable.winch).mount is Mount.WORLD
        found.append([np.where(stays[:, None], rest, anchors.positions(frame)) for frame in frames])
    return found


def _moving(name: str, kind: str, frames: Iterable[Points]) -> Iterator[str]:
    """Attribute with a value for each time."""
    yield f"        {kind} {name}.timeSamples = {{"
    for time, points in enumerate(frames):
        rows = ", ".join(f"({x:.7g}, {y:.7g}, {z:.7g})" for x, y, z in _in_space(points))
        yield f"            {time}: [{rows}],"
    yield "        }"


def _in_space(points: Points, height: float = 0.0) -> Points:
    """Points with three coordinates."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.full(len(points), height)])


def _escape(text: str) -> str:
    return re.sub(r'(["\\])', r"\\\1", text.replace("\n", " "))
