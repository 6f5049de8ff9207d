"""`MarkerEstimator`: positions of all markers of some poses on a built robot, from those that were measured."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.design.spread import Columns, spread_columns
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.ik import IKResult
from hydrostat.simulation import CableSensitivities, Simulation, cable_sensitivities

NOISE = 5e-4
"""Standard deviation of each measured coordinate [m]: a ruler or a photo."""

CURVED = 0.15
"""Error of tolerances to first order, as a share of their moves."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MarkerEstimator:
    """Most probable positions of markers on a built robot (a Gaussian process over poses and markers).

    To first order tolerances move the markers, and they are the same in all poses. Measured markers of all poses show
    their most probable values, and these where the others are; noise is averaged.

    Attributes:
        reached: poses that are played, as the model reaches them.
        sensitivities: those of the targets of each pose.
        columns: moves of the targets of each pose by one standard deviation of each tolerance [m].
        noise: standard deviation of each measured coordinate [m].
    """

    reached: Sequence[IKResult]
    sensitivities: Sequence[CableSensitivities]
    columns: Sequence[Columns]
    noise: float = NOISE

    @classmethod
    def of(
        cls,
        simulation: Simulation,
        reached: Sequence[IKResult],
        uncertainty: BuildTolerances,
        *,
        noise: float = NOISE,
    ) -> Self:
        """Estimator for poses of a design (NotConvergedError: a pose that is about to snap).

        Args:
            simulation: model of the robot.
            reached: its poses, as the model reaches them.
            uncertainty: build tolerances.
            noise: standard deviation of each measured coordinate [m].
        """
        names, dim = [marker.name for marker in simulation.robot.markers], simulation.robot.body.mesh.dim
        known = [[names.index(name) for name in one.pose_target.targets] for one in reached]
        sensitivities = [
            cable_sensitivities(simulation, one.pose, own) for one, own in zip(reached, known, strict=True)
        ]
        columns = [
            spread_columns(simulation, one.pose, sensitivity, uncertainty, dim * len(own))
            for one, sensitivity, own in zip(reached, sensitivities, known, strict=True)
        ]
        return cls(reached=reached, sensitivities=sensitivities, columns=columns, noise=noise)

    def estimate(self, measured: Sequence[Mapping[str, Vector | Sequence[float]]]) -> list[dict[str, Vector]]:
        """Positions of all targets of each pose [m], from those of each that were measured [m]."""
        misses = [
            np.concatenate([np.zeros(0), *(np.subtract(to, one.pose.markers[name]) for name, to in seen.items())])
            for one, seen in zip(self.reached, measured, strict=True)
        ]
        moved = self.gain([list(seen) for seen in measured]) @ np.concatenate(misses)
        found = []
        for one, columns, seen in zip(self.reached, self.columns, measured, strict=True):
            names = list(one.pose_target.targets)
            moves = (columns @ moved).reshape(len(names), -1)
            places = {name: one.pose.markers[name] + move for name, move in zip(names, moves, strict=True)}
            found.append(places if columns.any() else {name: np.array(to) for name, to in seen.items()})
        return found

    def gain(self, measured: Sequence[Sequence[str]]) -> Float[np.ndarray, "tolerances rows"]:
        """Most probable tolerances, in standard deviations, by measured moves of these markers of each pose [m]."""
        known = self.known_columns(measured)
        across = known @ known.T
        error = self.noise**2 + CURVED**2 * float((known**2).sum()) / max(len(known), 1) + np.finfo(float).tiny
        return np.linalg.solve(across + error * np.eye(len(known)), known).T

    def known_columns(self, measured: Sequence[Sequence[str]]) -> Columns:
        """Rows of `columns` of these markers of each pose."""
        rows = []
        for one, columns, seen in zip(self.reached, self.columns, measured, strict=True):
            names = list(one.pose_target.targets)
            rows.append(columns.reshape(len(names), -1, columns.shape[1])[[names.index(name) for name in seen]])
        return np.concatenate([part.reshape(-1, part.shape[2]) for part in rows])
