"""Targets of posing as frozen records, points under the pointer, poses of a robot, and undo of drags."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes, Points
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.given import Point, check_name
from hydrostat.project import Wishes, Work, fresh_name
from hydrostat.robot import Marker, PoseTarget, Robot
from hydrostat.studio.document import Document
from hydrostat.studio.stage import Hit
from hydrostat.studio.view.scene_items import Ghost, RobotShape


class Mode(StrEnum):
    """Actuation of the body: by muscles or by cables."""

    MUSCLES = "muscles"
    CABLES = "cables"


@dataclass(frozen=True, kw_only=True)
class HeldPoint:
    """A point of the body with the place where it should be."""

    at: Point  # where it is in the rest shape [m]
    target: Point  # where it should go [m]
    marker: bool = False  # whether it is a marker of the robot; else it is a plain point, though it may become one


@dataclass(frozen=True, kw_only=True)
class PoseTargets:
    """All that a person wants of the body just now."""

    mode: Mode  # what moves it
    held: Mapping[str, HeldPoint] = field(
        default_factory=dict
    )  # points by name; those with a marker's name are that marker
    rests: int = 0  # counts how often it was sent back to rest


class Anchored:
    """Anchors of held points in the mesh, found once for as long as they are the same; any thread may ask."""

    def __init__(self, mesh: Mesh) -> None:
        """Points of this body."""
        self._mesh = mesh
        self._found: tuple[tuple[Point, ...], Anchors] = ((), locate(mesh, np.zeros((0, mesh.dim))))

    def anchors(self, held: Mapping[str, HeldPoint]) -> Anchors:
        """The points as anchors, in their order."""
        places = tuple(point.at for point in held.values())
        known, anchors = self._found
        if places != known:
            anchors = locate(self._mesh, np.array(places, dtype=float).reshape(-1, self._mesh.dim))
            self._found = places, anchors
        return anchors

    def goals(self, held: Mapping[str, HeldPoint]) -> Points:
        """Targets of held points [m], (points, dim)."""
        return np.array([point.target for point in held.values()], dtype=float).reshape(-1, self._mesh.dim)

    def places(self, held: Mapping[str, HeldPoint], nodes: Nodes) -> Points:
        """Places of held points when the nodes are at `nodes` [m], (points, dim)."""
        return self.anchors(held).positions(nodes)

    def errors(self, held: Mapping[str, HeldPoint], nodes: Nodes) -> dict[str, float]:
        """Distance of each held point from its target [m], by name."""
        misses = np.linalg.norm(self.places(held, nodes) - self.goals(held), axis=1)
        return dict(zip(held, misses.tolist(), strict=True))


@dataclass(frozen=True, kw_only=True)
class PoseState:
    """State of posing, replaced as a whole so that no thread sees old targets with a new body."""

    robot: Robot  # that is posed
    targets: PoseTargets  # what a person wants of it
    anchored: Anchored  # where held points are stuck to its mesh
    shape: RobotShape  # where its body is
    ghost: Ghost | None = None  # a shape to compare with, if any

    def find_name(self, name: str) -> str:
        """Return the name if a held point or a marker has it, else ""."""
        found = name in self.targets.held or any(marker.name == name for marker in self.robot.markers)
        return name if found else ""

    def place(self, name: str, point: HeldPoint) -> Point:
        """Return the position of a point of the body [m]."""
        return tuple(Anchored(self.robot.body.mesh).places({name: point}, self.shape.nodes)[0].tolist())

    def with_target(self, name: str, point: HeldPoint, target: Sequence[float]) -> "PoseState":
        """Hold a point at a target, at most one size of the body away from the box of the body at rest."""
        mesh = self.robot.body.mesh
        near = np.clip(target, mesh.nodes.min(axis=0) - mesh.size, mesh.nodes.max(axis=0) + mesh.size)
        held = {**self.targets.held, name: replace(point, target=tuple(near.tolist()))}
        return replace(self, targets=replace(self.targets, held=held))

    def nudge(self, name: str, step: float, axis: int) -> "PoseState":
        """Move the target of a held point or marker along an axis [m]; a marker that is free begins where it is."""
        point = point_of(self, name)
        target = list(point.target if name in self.targets.held else self.place(name, point))
        target[axis] += step
        return self.with_target(name, point, target)

    def adapt_to(self, robot: Robot) -> "PoseState":
        """Return the state for a robot of the same nodes; it releases points held at lost markers, not plain points."""
        names, places = renamed_markers(self.robot, robot), {marker.name: marker.at for marker in robot.markers}
        held: dict[str, HeldPoint] = {}
        for old, point in self.targets.held.items():
            name = names.get(old, old)
            if name in places or not point.marker:
                held[name] = replace(point, at=places.get(name, point.at))
        mode = self.targets.mode if robot.cables else Mode.MUSCLES
        return replace(
            self,
            robot=robot,
            targets=replace(self.targets, held=held, mode=mode),
            shape=with_network_of(robot, self.shape),
        )


def renamed_markers(before: Robot, after: Robot) -> Mapping[str, str]:
    """New names of markers by their old ones: those that are new where one is gone."""
    old, new = {marker.name for marker in before.markers}, {marker.name for marker in after.markers}
    fresh = {marker.at: marker.name for marker in after.markers if marker.name not in old}
    gone = [marker for marker in before.markers if marker.name not in new]
    return {marker.name: fresh[marker.at] for marker in gone if marker.at in fresh}


def with_network_of(robot: Robot, shape: RobotShape) -> RobotShape:
    """A shape for a robot whose winches and cables may be others."""
    if len(shape.tensions) == len(robot.cables) and len(shape.contractions) == len(robot.winches):
        return shape
    return replace(shape, tensions=np.zeros(len(robot.cables)), contractions=np.zeros(len(robot.winches)))


POINT_TOLERANCE = 0.02  # a plain point so near to one that is held is that one, in sizes of the body


def name_under(now: PoseState, hit: Hit) -> str:
    """The point that the pointer is on: a marker, one that is held, or a new one; "" beside the body."""
    kind, _, name = hit.key.partition(":")
    markers = [marker.name for marker in now.robot.markers]
    if kind == "marker" and name in markers:
        return name
    if kind in ("target", "point") and name in now.targets.held:
        return name
    if hit.rest is None:
        return ""
    near = POINT_TOLERANCE * now.robot.body.mesh.size
    for own, held in now.targets.held.items():
        if np.linalg.norm(np.subtract(held.at, hit.rest)) < near:
            return own
    return fresh_name("point", [*now.targets.held, *markers])


def point_of(now: PoseState, name: str, hit: Hit | None = None) -> HeldPoint:
    """A point by name, held where it is if it is not held yet; a new one is under the pointer."""
    if name in now.targets.held:
        return now.targets.held[name]
    for marker in now.robot.markers:
        if marker.name == name:
            return HeldPoint(at=marker.at, target=marker.at, marker=True)
    assert hit is not None
    assert hit.rest is not None
    mesh = now.robot.body.mesh
    at = tuple(locate(mesh, np.array([hit.rest])).positions(mesh.nodes)[0].tolist())
    return HeldPoint(at=at, target=at)


def with_pose(robot: Robot, name: str, held: Mapping[str, HeldPoint]) -> Robot:
    """A robot with one more pose, or another of its name; held points get markers (InputError: no name or point)."""
    name = checked_name(name)
    if not held:
        raise InputError("no targets yet. Drag a point of the body, then store the pose")
    known = {marker.name for marker in robot.markers}
    new = tuple(Marker(name=own, at=point.at) for own, point in held.items() if own not in known)
    pose = PoseTarget(name=name, targets={own: point.target for own, point in held.items()})
    return replace(robot, markers=(*robot.markers, *new), poses={**robot.poses, name: pose})


def same_as(robot: Robot, name: str) -> str:
    """The first other pose with the same targets as one, to a tenth of a millimeter; "" if there is none."""
    own = robot.pose(name).targets
    same = 1e-4  # poses whose targets are nearer to each other are the same [m]
    for pose in robot.poses.values():
        alike = pose.name != name and set(pose.targets) == set(own)
        if alike and all(math.dist(pose.targets[marker], goal) < same for marker, goal in own.items()):
            return pose.name
    return ""


def renamed_pose(robot: Robot, old: str, new: str) -> Robot:
    """A robot with another name for a pose, in its old place (InputError: no such pose, no name, or a taken one)."""
    pose, new = robot.pose(old), checked_name(new)
    if new != old and new in robot.poses:
        raise InputError(f'the pose name "{new}" is already in use. Choose another name')
    poses = {new if name == old else name: own for name, own in robot.poses.items()}
    return replace(robot, poses={**poses, new: replace(pose, name=new)})


def without_pose(robot: Robot, name: str) -> Robot:
    """A robot without a pose (InputError: no such pose)."""
    robot.pose(name)
    return replace(robot, poses={own: pose for own, pose in robot.poses.items() if own != name})


def wishes_after(wishes: Wishes, robot: Robot, renamed: Mapping[str, str] | None = None) -> Wishes:
    """Wishes that name only poses that the robot has now; `renamed` gives new names by their old ones."""
    names = [(renamed or {}).get(name, name) for name in wishes.poses]
    return replace(wishes, poses=tuple(name for name in names if name in robot.poses))


def held_of(robot: Robot, name: str) -> dict[str, HeldPoint]:
    """The targets of a pose, as points that are held (InputError: no such pose)."""
    places = {marker.name: marker.at for marker in robot.markers}
    targets = robot.pose(name).targets
    return {own: HeldPoint(at=places[own], target=target, marker=True) for own, target in targets.items()}


def checked_name(given: str) -> str:
    """A name without spaces at its ends, fit for a robot's file (InputError: empty, too long, wrong letters)."""
    name = given.strip()
    if not name:
        raise InputError("pose name missing. Type one, e.g. wave")
    return check_name(name)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Step:
    """A drag, or another change of what is held."""

    label: str  # such as "drag tip"
    work: Work  # of the document when it was done
    held: Mapping[str, HeldPoint]  # before it; of one that was undone, after it


class Trail:
    """Drags beside the changes of the document: each is undone while the work is the one it was made on.

    So what was dragged after a change is undone before that change, and what was dragged before it after it.
    """

    def __init__(self, document: Document) -> None:
        self._document = document
        self._past: list[_Step] = []
        self._future: list[_Step] = []

    @property
    def undo_label(self) -> str:
        """Label of the drag that undo takes back; "" if the document has to be undone first, or nothing was dragged."""
        return self._label(self._past)

    @property
    def redo_label(self) -> str:
        """Label of the drag that redo makes again; "" if there is none."""
        return self._label(self._future)

    def note(self, label: str, held: Mapping[str, HeldPoint]) -> None:
        """Note that something is done now to what was held; nudges in a row of one point are one step."""
        if label.startswith("nudge ") and label == self.undo_label and not self._future:
            return
        self._past.append(_Step(label=label, work=self._document.work, held=held))
        most_steps = 200  # so many drags can be undone
        del self._past[:-most_steps]
        self._future = []

    def undo(self, held: Mapping[str, HeldPoint]) -> Mapping[str, HeldPoint]:
        """Return the points held before the last step; `held` are held now. Call only if there is an `undo_label`."""
        return self._move(self._past, self._future, held)

    def redo(self, held: Mapping[str, HeldPoint]) -> Mapping[str, HeldPoint]:
        """Return the points held after the step that was undone last. Call only if there is a `redo_label`."""
        return self._move(self._future, self._past, held)

    def _label(self, steps: list[_Step]) -> str:
        return steps[-1].label if steps and steps[-1].work is self._document.work else ""

    def _move(self, source: list[_Step], goal: list[_Step], held: Mapping[str, HeldPoint]) -> Mapping[str, HeldPoint]:
        step = source.pop()
        goal.append(_Step(label=step.label, work=step.work, held=held))
        return step.held
