"""`Show`, `Picture`: what all screens show, as bytes that are made again only where something has changed; `packet`."""

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Nodes, Points, Vector
from hydrostat.geometry import Anchors, locate
from hydrostat.robot import Robot
from hydrostat.studio.view.scene_items import Area, Cloud, Dot, Ghost, RobotShape, SceneItem, Strand

KINDS = {"f": "<f4", "i": "<u4", "u": "<u4"}


def packet(head: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> bytes:
    """Words and arrays of one or two axes, sent as tables of float32 or uint32, as one message of bytes.

    A message is: the length of its head in bytes, as a little-endian uint32; the head, JSON in UTF-8 that is padded
    with spaces until the arrays begin at a multiple of four; then the arrays one after the other, each again padded to
    a multiple of four. `head["arrays"]` names them in this order: {name: [kind, rows, columns]}, kind being "f4" or
    "u4", little-endian.
    """
    tables, bodies = {}, []
    for name, array in arrays.items():
        kind = KINDS[array.dtype.kind]
        table = np.ascontiguousarray(array if array.ndim == 2 else array[:, None], dtype=kind)
        tables[name] = [kind[1:], *table.shape]
        bodies.append(table.tobytes())
    text = json.dumps({**head, "arrays": tables}, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([struct.pack("<I", len(text)), text, *bodies])


def parse_message(message: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return the head and arrays of a message, for tests and for programs that listen to a studio."""
    (length,) = struct.unpack_from("<I", message)
    head = json.loads(message[4 : 4 + length])
    place, arrays = 4 + length, {}
    for name, (kind, rows, columns) in head.pop("arrays").items():
        arrays[name] = np.frombuffer(message, f"<{kind}", rows * columns, place).reshape(rows, columns)
        place += 4 * rows * columns
    return head, arrays


Table = Float[np.ndarray, "rows 3"]

KINDS_OF_ITEMS = {Dot: "dot", Strand: "line", Ghost: "ghost", Cloud: "cloud", Area: "area"}  # what a screen calls each


class Picture:
    """Scene that stays the same from frame to frame: faces, styles, and how points are stuck to the body.

    A *scene* is sent once, a *frame* for each new place. Every point has three coordinates, the last 0 in a flat body.

    The head of a scene: kind "scene", serial, name, dim, items (a list; each with kind, its style, and "first" and
    "count" of its points in the frame's `points`). Arrays: `rest` and `faces` of the shown surface; `rim`, edges of a
    flat body; for each ghost `ghost:NAME` and for each cloud `cloud:NAME`.

    The head of a frame: kind "frame", scene (the serial of the scene it belongs to), and what the session adds. Arrays:
    `nodes` of the surface, `points` of all items, `loads` of the lines, `values` of the nodes (0 to 1) if colored.
    """

    def __init__(self, robot: Robot, items: Sequence[SceneItem], serial: int) -> None:
        """The picture of a robot's body with items beside it; the serial names the scene."""
        self.robot, self.serial = robot, serial
        self.signature = _signature(robot, items)
        self._shown = _shown_nodes(robot)
        self._stuck_flags, self._rest = _stuck_flags(items, robot.body.mesh.dim)
        self._items = tuple(items)

    def fits(self, robot: Robot, items: Sequence[SceneItem]) -> bool:
        """Return True if these need no new scene: only places in the world and loads may differ."""
        return robot.body.mesh is self.robot.body.mesh and _signature(robot, items) == self.signature

    def scene(self) -> bytes:
        """All that stays the same."""
        mesh = self.robot.body.mesh
        renumber = np.zeros(len(mesh.nodes), dtype=np.uint32)
        renumber[self._shown] = np.arange(len(self._shown), dtype=np.uint32)
        faces = mesh.elements if mesh.dim == 2 else mesh.boundary
        arrays = {"rest": _in_space(mesh.nodes[self._shown]), "faces": renumber[faces]}
        if mesh.dim == 2:
            arrays["rim"] = renumber[mesh.boundary]
        for item in self._items:
            if isinstance(item, Ghost):
                arrays[f"ghost:{item.name}"] = _in_space(item.nodes[self._shown])
            elif isinstance(item, Cloud):
                arrays[f"cloud:{item.name}"] = _in_space(item.points)
        head = {
            "kind": "scene",
            "serial": self.serial,
            "name": self.robot.name,
            "dim": mesh.dim,
            "items": _styles(self._items),
        }
        return packet(head, arrays)

    def frame(
        self, nodes: Nodes, items: Sequence[SceneItem], head: dict[str, Any], *, values: Vector | None = None
    ) -> bytes:
        """All that changes: nodes [m] and their colors from 0 to 1, if any, places and loads of items, words."""
        points = np.concatenate([_points(item) for item in items] or [np.zeros((0, nodes.shape[1]))])
        if self._stuck_flags.any():
            points[self._stuck_flags] = self._anchors.positions(nodes) + self._beside
        loads = np.array([item.load for item in items if isinstance(item, Strand)], dtype=np.float32)
        arrays = {"nodes": _in_space(nodes[self._shown]), "points": _in_space(points), "loads": loads}
        if values is not None:
            arrays["values"] = values[self._shown].astype(np.float32)
        return packet({"kind": "frame", "scene": self.serial, **head}, arrays)

    @cached_property
    def _anchors(self) -> Anchors:
        """The points that are stuck to the body."""
        return locate(self.robot.body.mesh, self._rest[self._stuck_flags])

    @cached_property
    def _beside(self) -> Points:
        """Offsets of stuck points from the body at rest [m], such as corners of a zone beyond it; 0 on the body."""
        return self._rest[self._stuck_flags] - self._anchors.positions(self.robot.body.mesh.nodes)


def _shown_nodes(robot: Robot) -> np.ndarray:
    """Nodes of the surface; of a flat body all."""
    mesh = robot.body.mesh
    return np.arange(len(mesh.nodes)) if mesh.dim == 2 else np.unique(mesh.boundary)


def _in_space(points: Points) -> Table:
    table = np.zeros((len(points), 3), dtype=np.float32)
    table[:, : points.shape[1]] = points
    return table


def _points(item: SceneItem) -> Points:
    """The points of a item that are sent with every frame."""
    if isinstance(item, Dot):
        return np.array([item.at], dtype=float)
    if isinstance(item, Strand):
        return np.array(item.points, dtype=float)
    if isinstance(item, Area):
        return np.array(item.outline or (item.at,), dtype=float)
    return np.zeros((0, (item.nodes if isinstance(item, Ghost) else item.points).shape[1]))


def _stuck_flags(items: Sequence[SceneItem], dim: int) -> tuple[np.ndarray, Points]:
    """Return flags of the points that are stuck to the body, and all points as given [m]."""
    flags, places = [np.zeros(0, dtype=bool)], [np.zeros((0, dim))]
    for item in items:
        points = _points(item)
        stuck = np.ones(len(points), dtype=bool)
        if isinstance(item, Dot):
            stuck[:] = item.stuck
        elif isinstance(item, Strand):
            stuck[: len(points) if item.loose < 0 else item.loose] = False
        flags.append(stuck)
        places.append(points)
    return np.concatenate(flags), np.concatenate(places)


def _styles(items: Sequence[SceneItem]) -> list[dict[str, Any]]:
    """Return the style of each object, and the range of its points."""
    styles, first = [], 0
    for item in items:
        count = len(_points(item))
        style = {"kind": KINDS_OF_ITEMS[type(item)], "first": first, "count": count, **_style(item)}
        styles.append(style)
        first += count
    return styles


def _style(item: SceneItem) -> dict[str, Any]:
    if isinstance(item, Dot):
        return {
            "key": item.key, "look": str(item.look), "color": item.color, "label": item.label,
            "short": item.short, "chosen": item.chosen, "radius": item.radius, "about": item.about,
            "faint": item.faint,
        }  # fmt: skip
    if isinstance(item, Strand):
        return {
            "key": item.key, "stroke": str(item.stroke), "color": item.color, "chosen": item.chosen,
            "faint": item.faint,
        }  # fmt: skip
    if isinstance(item, Area):
        return {
            "key": item.key, "color": item.color, "radius": item.radius, "label": item.label,
            "chosen": item.chosen,
        }  # fmt: skip
    return {"name": item.name, "color": item.color}


def _signature(robot: Robot, items: Sequence[SceneItem]) -> tuple[Any, ...]:
    """Return the content of a scene as a tuple: equal tuples mean an equal scene."""
    marks: list[Any] = [robot.name]
    for item in items:
        if isinstance(item, Dot):
            marks.append((*_style(item).values(), item.at if item.stuck else None))
        elif isinstance(item, Strand):
            stuck = item.points[item.loose :] if item.loose >= 0 else len(item.points)
            marks.append((*_style(item).values(), item.loose, stuck))
        elif isinstance(item, Area):
            marks.append((*_style(item).values(), item.at, item.outline))
        else:
            marks.append((item.name, item.color, id(item.nodes if isinstance(item, Ghost) else item.points)))
    return tuple(marks)


@dataclass(frozen=True, eq=False)
class Shown:
    """One moment."""

    serial: int  # of its scene
    scene: bytes  # all that stays the same
    frame: bytes  # all that changes


class Show:
    """Makes a new scene only when the old one does not fit."""

    def __init__(self) -> None:
        self._picture: Picture | None = None
        self._scene = b""
        self._serial = 0

    def moment(
        self,
        robot: Robot,
        shape: RobotShape,
        items: Sequence[SceneItem],
        head: dict[str, Any],
        values: Vector | None = None,
    ) -> Shown:
        """A robot in a shape, with items, words to go along with the frame, and values of nodes for colors."""
        if self._picture is None or not self._picture.fits(robot, items):
            self._serial += 1
            self._picture = Picture(robot, items, self._serial)
            self._scene = self._picture.scene()
        frame = self._picture.frame(shape.nodes, items, head, values=values)
        return Shown(self._serial, self._scene, frame)
