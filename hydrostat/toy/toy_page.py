"""`toy_page`: one HTML file in which a robot is dragged, without server, simulator or installation."""

import base64
import hashlib
import html
import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, Self

import numpy as np

from hydrostat.arrays import Float, Int, Nodes, Points, Vector
from hydrostat.control import Calibration, LinkLimits, robot_word, servo_ratings
from hydrostat.drawing import Camera, Color
from hydrostat.errors import InputError
from hydrostat.fabrication import winch_marks_of
from hydrostat.plot import Attachments, FlatSkin
from hydrostat.robot import LoadDrive, Robot, robot_hash
from hydrostat.toy.learned_shape import LearnedShape
from hydrostat.version import __version__

_MODULES = (
    "model",
    "sight",
    "drawing",
    "surface",
    "player",
    "spool",
    "drive",
    "board",
    "dynamixel",
    "feetech",
    "servos",
    "motors",
    "page",
)
"""JavaScript of the page, each before those that import it."""


@dataclass(frozen=True, kw_only=True)
class ToyPose:
    """A pose that the page can play.

    Attributes:
        name: name on its button.
        contractions: cable taken in by each winch [m], then the values of drives.
    """

    name: str
    contractions: tuple[float, ...]


def toy_page(
    robot: Robot,
    shape: LearnedShape,
    *,
    poses: Sequence[ToyPose] = (),
    moves: Sequence[tuple[float, Vector]] = (),
    motors: Calibration | None = None,
) -> str:
    """Return the page as text. Same robot, shape and poses, same bytes.

    Names are data: they stand in JSON whose "<" is escaped, and the page's policy runs no script but its own.

    Args:
        robot: robot to show.
        shape: learned shape of its body.
        poses: poses to play.
        moves: keyframes to play: times [s] and contractions of all winches [m], then values of drives.
        motors: motors on one board or adapter, which the page offers to drive.

    Raises:
        InputError: a body with more points on its surface than a browser without extensions draws, or a pose or
            keyframe without one finite number for each winch and drive.
    """
    for pose in poses:
        _check_taken(f'pose "{pose.name}"', pose.contractions, robot)
    for time, taken in moves:
        _check_taken(f"keyframe at {time:g} s", taken, robot, time)
    picture = ToyPicture.of(robot, shape)
    most = 65_536  # points of a surface by 16 bit numbers of WebGL 1
    if len(picture.faces) and int(picture.faces.max()) >= most:
        raise InputError(f"the surface has {int(picture.faces.max()) + 1} nodes. Use a mesh with at most {most}.")
    places = {winch.name: place for place, winch in enumerate(robot.winches)}
    up, eye = _view(robot)
    facts: dict[str, Any] = {
        "name": robot.name,
        "version": __version__,
        "robot": robot_hash(robot),
        "dim": robot.body.mesh.dim,
        "size": robot.body.mesh.size,
        "up": up.tolist(),
        "eye": eye.tolist(),
        "winches": _knobs(robot, shape),
        "cables": [places[cable.winch] for cable in robot.cables],
        "markers": [marker.name for marker in robot.markers],
        "poses": [{"name": pose.name, "contractions": list(pose.contractions)} for pose in poses],
        "moves": [[float(time), np.asarray(taken).tolist()] for time, taken in moves],
        "motors": motor_facts(robot, motors),
        "groups": picture.facts(),
        "sizes": shape.network.sizes.tolist(),
        "numbers": _encode(shape.network.numbers[0], "<f4"),
        "mean": _encode(picture.mean, "<f4"),
        "basis": _encode(picture.basis, "<f4"),
        "faces": _encode(picture.faces, "<u4"),
    }
    text = json.dumps(facts, separators=(",", ":"), ensure_ascii=True, allow_nan=False).replace("<", "\\u003c")
    script = _script()
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    filled = {
        "TITLE": html.escape(robot.name),
        "STYLE": _static("toy.css"),
        "SCRIPT_HASH": f"sha256-{digest}",
        "HINT": "Drag the body" if robot.body.mesh.dim == 2 else "Drag the body. Drag next to it to turn the view",
        "KNOBS": " and ".join(["Winches"] * bool(robot.winches) + ["Drives"] * bool(robot.drives)).capitalize(),
        "MADE": _made_text(shape),
        "DATA": text,
        "SCRIPT": script,
    }
    return re.sub(r"@([A-Z_]+)@", lambda found: filled[found[1]], _static("toy.html"))


def _knobs(robot: Robot, shape: LearnedShape) -> list[dict[str, Any]]:
    """Return facts of each winch, then of each drive: what it is called, its color and range, and its unit."""
    controls = (*robot.winches, *robot.drives)
    colors = Color.of_winches(controls)
    marks = winch_marks_of(robot) | {drive.name: f"D{number}" for number, drive in enumerate(robot.drives, 1)}
    units = [("mm", 1e3)] * len(robot.winches)
    for drive in robot.drives:
        lengthwise = ("", 1.0) if isinstance(drive, LoadDrive) else ("mm", 1e3)
        units.append(("°", math.degrees(1.0)) if drive.turns else lengthwise)
    return [
        {"name": each.name, "mark": marks[each.name], "color": colors[each.name], "low": low, "high": high}
        | {"unit": unit, "factor": factor}
        for each, low, high, (unit, factor) in zip(
            controls, shape.low.tolist(), shape.high.tolist(), units, strict=True
        )
    ]


def _check_taken(name: str, contractions: Sequence[float] | Vector, robot: Robot, time: float = 0.0) -> None:
    """Check contractions [m] and time [s] of a pose."""
    numbers, wanted = np.asarray(contractions), (len(robot.winches) + len(robot.drives),)
    if numbers.shape != wanted or not (np.isfinite(numbers).all() and np.isfinite(time)):
        told = ", ".join(f"{number:g}" for number in numbers.ravel().tolist())
        raise InputError(
            f"{name}: contractions [{told}]. Give {wanted[0]} finite numbers, one for each winch or drive."
        )


def _view(robot: Robot) -> tuple[Vector, Vector]:
    """Upward direction of a robot, and the direction in which the eye is at first; of no use where it is flat."""
    up = np.array([0.0, 0.0, 1.0])
    nodes = robot.body.mesh.nodes
    if nodes.shape[1] == 2:
        return up, up
    if robot.gravity is not None and any(robot.gravity):
        up = -np.array(robot.gravity) / np.linalg.norm(robot.gravity)
    shown = np.array([part.at for part in (*robot.winches, *robot.markers)], dtype=float)
    return up, Camera.three_quarter(nodes, shown, up).axes[2]


def _made_text(shape: LearnedShape) -> str:
    """Return how the page was made and its error, as HTML."""
    lines = [
        f"Learned from {shape.samples} simulated poses by a network of {shape.network.numbers.size} numbers.",
        f"Checked in {shape.held_out} other poses: mean error {_millimeters(shape.error)} "
        f"of {_millimeters(shape.moved)} mean motion. "
        f"In 95 % of them no point is more than {_millimeters(shape.worst)} off.",
        f"Made by hydrostat {__version__}.",
    ]
    if shape.stopped:
        lines.insert(1, "Training ended early for lack of time.")
    return "".join(f"<p>{html.escape(line)}</p>" for line in lines)


def _millimeters(length: float) -> str:
    return f"{1e3 * length:.2g} mm" if length < 0.1 else f"{1e3 * length:.0f} mm"


def _script() -> str:
    """All modules as one, without the lines that import and export."""
    parts = [_static(f"{name}.js") for name in _MODULES]
    bare = [re.sub(r"^import .*;\n", "", part, flags=re.MULTILINE) for part in parts]
    return "\n" + "\n".join(re.sub(r"^export ", "", part, flags=re.MULTILINE) for part in bare)


def _static(name: str) -> str:
    return (resources.files("hydrostat.toy") / "static" / name).read_text(encoding="utf-8")


def _encode(numbers: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(numbers, dtype=kind).tobytes()).decode()


def motor_facts(robot: Robot, calibration: Calibration | None) -> dict[str, Any] | None:
    """Return facts for the page in SI units; None without motors on exactly one board or adapter.

    Motors with encoder counts are on a board with our firmware, others are servos. A zero only tells the page whether
    taut cables are where they were when the robot was calibrated.
    """
    if calibration is None or calibration.boards != 1:
        return None
    counted = [motor.counts is not None for motor in calibration.motors]
    if any(counted) and not all(counted):
        return None
    marks = winch_marks_of(robot)
    if all(counted):
        kind: dict[str, Any] = {"kind": "firmware", "robot": robot_word(robot, calibration)}
    else:
        kind = {"kind": "servos", **servo_ratings()}
    return {
        **kind,
        "speed": LinkLimits().speed,
        "motors": [
            {
                "mark": marks[winch.name],
                "number": motor.number,
                "zero": motor.zero,
                "turns": motor.turns,
                "radius": motor.radius,
                "curve": [list(point) for point in motor.curve],
                "current": motor.current,
                "counts": motor.counts,
                "low": -winch.release,
                "high": winch.travel,
            }
            for winch, motor in zip(robot.winches, calibration.motors, strict=True)
        ],
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class ToyPicture:
    """Drawn points of a robot.

    Attributes:
        groups: kind, first point and number of points of each group: outline, seam, surface, drawn, cable, winch and
            marker, in the order in which they are drawn.
        faces: triangles of the surface, as numbers of points from the first of the surface on; none of a flat body.
        mean: the points in the mean shape [m].
        basis: displacement of the points for a coordinate of 1 [m].
    """

    groups: tuple[tuple[str, int, int], ...]
    faces: Int[np.ndarray, "faces 3"]
    mean: Points
    basis: Float[np.ndarray, "coordinates points dim"]

    @classmethod
    def of(cls, robot: Robot, shape: LearnedShape) -> Self:
        """Picture of a robot in a learned shape."""
        mesh, attached = robot.body.mesh, Attachments(robot)

        def parts(nodes: Nodes) -> list[tuple[str, Points]]:
            """Each group of points at nodes; affine in the nodes."""
            found: list[tuple[str, Points]] = []
            if mesh.dim == 2:
                skin = FlatSkin.of(robot.body)
                found += [("outline", ring) for ring in skin.shape(nodes)]
                found += [("seam", ring) for ring in skin.seam(nodes)]
            else:
                found.append(("surface", nodes[mesh.boundary_nodes]))
            found += [("drawn", anchors.positions(nodes)) for anchors in robot.body.mark_anchors]
            found += [("cable", points) for points in attached.cables(nodes)]
            return [*found, ("winch", attached.winches(nodes)), ("marker", attached.markers(nodes))]

        mean = parts(shape.mean)
        whole = np.concatenate([points for _, points in mean])
        moved = [np.concatenate([points for _, points in parts(shape.mean + each)]) - whole for each in shape.basis]
        return cls(groups=_groups(mean), faces=_faces(robot), mean=whole, basis=np.array(moved))

    def facts(self) -> list[list[Any]]:
        """Groups as JSON."""
        return [list(group) for group in self.groups]


def _groups(parts: Sequence[tuple[str, Points]]) -> tuple[tuple[str, int, int], ...]:
    groups, first = [], 0
    for kind, points in parts:
        groups.append((kind, first, len(points)))
        first += len(points)
    return tuple(groups)


def _faces(robot: Robot) -> Int[np.ndarray, "faces 3"]:
    mesh = robot.body.mesh
    if mesh.dim == 2:
        return np.zeros((0, 3), dtype=np.int64)
    return np.searchsorted(mesh.boundary_nodes, mesh.boundary)
