"""`PointTarget`: any points of the body at places, not only markers."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hydrostat.errors import InputError
from hydrostat.geometry import locate
from hydrostat.ik.objectives.marker_target import MarkerResidual
from hydrostat.ik.objectives.objective import Objective, Residual, by_name, not_negative, place
from hydrostat.robot import Point
from hydrostat.simulation import Simulation


@dataclass(frozen=True, kw_only=True)
class PointTarget(Objective):
    """Targets for material points, for example where a hand holds a body.

    Attributes:
        points: position of each point in the rest shape [m]; a point outside the body stands for the nearest one on it.
        targets: target position of each point [m], by the same names.
        weight: weight of these errors relative to a marker's error.
    """

    points: Mapping[str, Point]
    targets: Mapping[str, Point]
    weight: float = 1.0

    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot.

        Raises:
            InputError: no points, one without a target or the other way round, a place that is not in the body's space,
                not finite or not in metres, or a weight below 0.
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
