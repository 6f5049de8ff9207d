"""`MarkerGoal`: markers at points."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from hydrostat.arrays import Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry.anchors import Anchors
from hydrostat.ik.objectives.objective import Moves, Objective, Posture, Rows, Slopes, Term
from hydrostat.robot import Point, Robot
from hydrostat.simulation import Simulation

AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class MarkerGoal(Objective):
    """Markers where they should be: weight x (position - target) of each, along the axes that are not free (R31, E19).

    Attributes:
        targets: where each marker should go [m].
        weights: how much a marker counts, 1 if left out.
        free: axes along which a marker may be anywhere, such as {"tip": "x"} or {"tip": "xz"}.
    """

    targets: Mapping[str, Point]
    weights: Mapping[str, float] = field(default_factory=dict)
    free: Mapping[str, str] = field(default_factory=dict)

    def on(self, simulation: Simulation) -> Term:
        """The goal on this robot.

        Raises:
            InputError: a marker that it does not have, a target with a wrong number of coordinates or not finite, a
                weight below 0, an axis that there is not.
        """
        robot = simulation.robot
        dim = robot.body.mesh.dim
        names = tuple(self.targets)
        for given in (self.weights, self.free):
            for name in given:
                if name not in self.targets:
                    raise InputError(f'marker "{name}" has a weight or free axes but no target; give it one')
        goals = np.array([_target(name, target, dim) for name, target in self.targets.items()]).reshape(-1, dim)
        chosen = [_index(robot, name) for name in names]
        anchors = simulation.marker_anchors.chosen(chosen)
        scales = np.array([_weight(name, self.weights.get(name, 1.0)) for name in names]).reshape(-1)
        held = np.array([_held(name, self.free.get(name, ""), dim) for name in names], dtype=bool).reshape(-1, dim)
        return _Markers(names, anchors, goals, scales, held)


class _Markers(Term):
    """Marker goals on one robot."""

    def __init__(
        self,
        names: Sequence[str],
        anchors: Anchors,
        goals: Points,
        weights: Vector,
        held: Bool[np.ndarray, "markers dim"],
    ) -> None:
        """Markers by name, where they are stuck, where they should go, how much each counts, along which axes."""
        self.names, self.anchors, self.goals, self.held = tuple(names), anchors, goals, held
        self._scales = weights[:, None] * held

    def residual(self, posture: Posture) -> Rows:
        return (self._scales * self._offsets(posture)).ravel()

    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        moved: Float[np.ndarray, "markers dim winches"] = np.einsum(
            "pc,pcdw->pdw", self.anchors.weights, moves.nodes[self.anchors.stencils]
        )
        return (self._scales[:, :, None] * moved).reshape(self._scales.size, -1)

    def errors(self, posture: Posture) -> Mapping[str, float]:
        distances = np.linalg.norm(self.held * self._offsets(posture), axis=1)
        return dict(zip(self.names, distances.tolist(), strict=True))

    def _offsets(self, posture: Posture) -> Points:
        return self.anchors.positions(posture.nodes) - self.goals


def _index(robot: Robot, name: str) -> int:
    names = [marker.name for marker in robot.markers]
    if name not in names:
        known = f"its markers are: {', '.join(names)}" if names else "it has no markers"
        raise InputError(f'the robot has no marker "{name}"; {known}')
    return names.index(name)


def _target(name: str, target: Point, dim: int) -> Point:
    if len(target) != dim:
        raise InputError(f"target {name} has {len(target)} coordinates, the body {dim} dimensions")
    if not np.isfinite(target).all():
        raise InputError(f"target {name} is not finite: {tuple(target)}")
    return target


def _weight(name: str, weight: float) -> float:
    if not (np.isfinite(weight) and weight >= 0):
        raise InputError(f"weight of marker {name} must be 0 or more, not {weight:g}")
    return weight


def _held(name: str, free: str, dim: int) -> list[bool]:
    wrong = set(free) - set(AXES[:dim])
    if wrong:
        raise InputError(f'free axes of marker {name} must be of "{AXES[:dim]}", not "{free}"')
    return [axis not in free for axis in AXES[:dim]]
