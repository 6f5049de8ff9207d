"""`MarkerTarget`, `PointTarget`: markers, or any points of the body, at their targets."""
# Of the thesis (docs/thesis.md): R31, E19

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from hydrostat.arrays import Bool, Float, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Anchors, locate
from hydrostat.given import Point, list_choices
from hydrostat.ik.objectives.objective import (
    EquilibriumState,
    Jacobian,
    Objective,
    Residual,
    Rows,
    StateJacobian,
    by_name,
    describe,
    not_negative,
    place,
)
from hydrostat.robot import PoseTarget, Robot
from hydrostat.simulation import Simulation
from hydrostat.units import quote


@dataclass(frozen=True, kw_only=True)
class PointTarget(Objective):
    """Targets for material points, for example where a hand holds a body.

    Attributes:
        points: position of each point in the rest shape [m]; a point outside the body is replaced by the nearest one on
            it.
        targets: target position of each point [m], by the same names.
        weight: weight of these errors relative to a marker's error.
    """

    points: Mapping[str, Point]
    targets: Mapping[str, Point]
    weight: float = 1.0

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot.

        Raises:
            InputError: no points, a point without a target or a target without a point, a position outside the body's
                space, not finite or not in meters, or a weight below 0.
        """
        mesh = simulation.robot.body.mesh
        points = by_name("points of the body", self.points, '{"knuckle": (0.1, 0.02)}')
        targets = by_name("targets of points", self.targets, '{"knuckle": (0.1, 0.02)}')
        if not points:
            raise InputError("points of the body must name at least one point")
        for name in {*points} ^ {*targets}:
            has, lacks = ("place on the body", "target") if name in points else ("target", "place on the body")
            raise InputError(f'point "{name}" has a {has} but no {lacks}; give it one')
        rest = np.array([place(f"point {name}", points[name], mesh) for name in points])
        goals = np.array([place(f"target {name}", targets[name], mesh) for name in points])
        weights = np.full(len(points), not_negative("weight of points", self.weight))
        return MarkerResidual(tuple(points), locate(mesh, rest), goals, weights, np.ones(goals.shape, dtype=bool))


AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class MarkerTarget(Objective):
    """Targets for markers: the residual is weight x (position - target) of each marker, along the constrained axes.

    Attributes:
        targets: target position of each marker [m].
        weights: weight of each marker; 1 by default.
        free: axes along which a marker is unconstrained, such as {"tip": "x"} or {"tip": "xz"}.
    """

    targets: Mapping[str, Point]
    weights: Mapping[str, float] = field(default_factory=dict)
    free: Mapping[str, str] = field(default_factory=dict)

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot.

        Raises:
            InputError: no targets, an unknown marker, a target outside the body's space, not finite or not in meters, a
                weight below 0, or an unknown axis.
        """
        robot = simulation.robot
        mesh = robot.body.mesh
        targets = named_targets(self.targets)
        names = tuple(targets)
        weights = by_name("weights of markers", self.weights, '{"tip": 2.0}')
        free = by_name("free axes of markers", self.free, '{"tip": "x"}')
        for given in (weights, free):
            for name in given:
                if name not in targets:
                    raise InputError(f'marker "{name}" has a weight or free axes but no target; give it one')
        chosen = [_index(robot, name) for name in names]
        anchors = simulation.marker_anchors.select_points(chosen)
        scales = np.array([not_negative(f"weight of marker {name}", weights.get(name, 1.0)) for name in names])
        held = np.array([_held_axes(name, free.get(name, ""), mesh.dim) for name in names])
        goals = np.array(
            [place(f"target {name}", targets[name], mesh, held=axes) for name, axes in zip(names, held, strict=True)]
        )
        return MarkerResidual(names, anchors, goals, scales, held)


def named_targets(given: object) -> Mapping[str, Point]:
    """Places by the names of markers; those of a pose (InputError: none, or anything else such as a pose's name)."""
    if isinstance(given, PoseTarget):
        return given.targets
    if isinstance(given, str):
        raise InputError(f'targets must be places by name, not "{given}"; those of a pose are robot.pose("{given}")')
    found = by_name("targets", given, '{"tip": (0.1, 0.02)}')
    if not found:
        raise InputError("targets must name at least one marker")
    return {name: tuple(point.tolist()) if isinstance(point, np.ndarray) else point for name, point in found.items()}


class MarkerResidual(Residual):
    """Points of the body that have goals."""

    def __init__(
        self,
        names: Sequence[str],
        anchors: Anchors,
        goals: Points,
        weights: Vector,
        held: Bool[np.ndarray, "markers dim"],
    ) -> None:
        """Take the names of markers, their anchors, targets, weights and constrained axes."""
        self.names, self.anchors, self.goals, self.held = tuple(names), anchors, goals, held
        self._scales = weights[:, None] * held
        self._counts = weights > 0

    def residual(self, posture: EquilibriumState) -> Rows:
        """Scaled distance of each point from its target, along each constrained axis [m]."""
        return (self._scales * self._offsets(posture)).ravel()

    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        """Jacobian of the residual by the contractions."""
        moved: Float[np.ndarray, "markers dim winches"] = np.einsum(
            "pc,pcdw->pdw", self.anchors.weights, moves.nodes[self.anchors.stencils]
        )
        return (self._scales[:, :, None] * moved).reshape(self._scales.size, -1)

    def errors(self, posture: EquilibriumState) -> Mapping[str, float]:
        """Distance of each marker from its target along the constrained axes [m]; markers of weight 0 are left out."""
        distances = np.linalg.norm(self.held * self._offsets(posture), axis=1)
        found = zip(self.names, distances.tolist(), self._counts, strict=True)
        return {name: distance for name, distance, counts in found if counts}

    def _offsets(self, posture: EquilibriumState) -> Points:
        return self.anchors.positions(posture.nodes) - self.goals


def _index(robot: Robot, name: str) -> int:
    names = [marker.name for marker in robot.markers]
    if name not in names:
        raise InputError(f"unknown marker {quote(name)}. {list_choices('markers', names, name)}")
    return names.index(name)


def _held_axes(name: str, free: object, dim: int) -> list[bool]:
    if not isinstance(free, str) or set(free) - set(AXES[:dim]):
        raise InputError(f'free axes of marker {name} must be of "{AXES[:dim]}", not {_quote(free)}')
    return [axis not in free for axis in AXES[:dim]]


def _quote(given: object) -> str:
    return f'"{given}"' if isinstance(given, str) else describe(given)
