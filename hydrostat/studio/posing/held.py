"""Records of a gesture: `HeldPoint`, a dragged point; `PoseTargets`, all targets; `PoseState`, all together."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Nodes, Points
from hydrostat.geometry import Anchors, Mesh, locate
from hydrostat.robot import Point, Robot
from hydrostat.studio.view.things import Ghost, RobotShape


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

    def known(self, name: str) -> str:
        """The name, if a point that is held or a marker has it, else ""."""
        found = name in self.targets.held or any(marker.name == name for marker in self.robot.markers)
        return name if found else ""

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
