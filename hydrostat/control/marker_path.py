"""`MarkerPath`: simulated markers along a profile of contractions, with their derivatives."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.control.model_tensions import winch_tensions
from hydrostat.errors import HydrostatError, InputError
from hydrostat.robot import PinDrive, Robot
from hydrostat.simulation import ContractionProfile, Simulation

SPACING = 0.02
"""Largest change of a contraction from one equilibrium along a profile to the next, as a share of the travel."""

POSES = 4000
"""Largest number of equilibria along a profile."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MarkerPath:
    """Simulated markers and pulls along a profile, with exact derivatives with respect to the contractions.

    Attributes:
        times: times of the profile [s].
        places: positions of all markers [m].
        jacobians: derivatives dx/da of these positions.
        pulls: pull of each winch [N], from `winch_tensions`.
        pull_jacobians: derivatives dF/da of these pulls [N/m].
    """

    times: Vector
    places: Float[np.ndarray, "times markers dim"]
    jacobians: Float[np.ndarray, "times markers dim winches"]
    pulls: Float[np.ndarray, "times winches"]
    pull_jacobians: Float[np.ndarray, "times winches winches"]

    @classmethod
    def along(cls, robot: Robot, profile: ContractionProfile) -> "MarkerPath":
        """Simulate the poses of a profile.

        Raises:
            InputError: a robot without markers, or with drives; a profile with too many equilibria.
            HydrostatError: a pose without equilibrium.
        """
        if not robot.markers:
            raise InputError(f"{robot.name}: no [[marker]] in robot.toml. Add one for each tag.")
        PinDrive.require_none(robot.drives, "corrections")
        times = _path_times(robot, profile)
        simulation, pose = Simulation(robot), None
        places, jacobians, pulls, pull_jacobians = [], [], [], []
        network = np.array([winch_tensions(robot, row) for row in np.eye(len(robot.cables))]).T  # (winches, cables)
        for time in times.tolist():
            pose = simulation.solve(profile.at(time), start=pose, strict=False)
            if not pose.result.converged:
                raise HydrostatError(
                    f"the simulated robot reaches no equilibrium at {time:.2f} s. Play without --camera."
                )
            places.append(simulation.marker_anchors.positions(pose.nodes))
            jacobians.append(simulation.marker_jacobian(pose))
            pulls.append(winch_tensions(robot, pose.tensions))
            still = np.zeros_like(pose.nodes)
            pull_jacobians.append([simulation.adjoint(pose, still, tensions=row).contractions for row in network])
        return cls(
            times=times,
            places=np.array(places),
            jacobians=np.array(jacobians),
            pulls=np.array(pulls),
            pull_jacobians=np.array(pull_jacobians),
        )

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Return positions and derivatives at a time [s], linear between poses."""
        return self._mix(time, self.places), self._mix(time, self.jacobians)

    def pulls_at(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Return pulls and their derivatives at a time [s], linear between poses."""
        return self._mix(time, self.pulls), self._mix(time, self.pull_jacobians)

    def _mix(self, time: float, values: np.ndarray) -> np.ndarray:
        place = int(np.clip(np.searchsorted(self.times, time) - 1, 0, max(len(self.times) - 2, 0)))
        after = min(place + 1, len(self.times) - 1)
        length = self.times[after] - self.times[place]
        share = float(np.clip((time - self.times[place]) / length, 0.0, 1.0)) if length > 0 else 0.0
        return (1 - share) * values[place] + share * values[after]


def _path_times(robot: Robot, profile: ContractionProfile) -> Vector:
    """Times between which no contraction changes by more than `SPACING` (InputError: there are too many)."""
    travel = np.array([winch.travel or np.inf for winch in robot.winches])
    fine, step = [0.0], 0.5 * SPACING * travel
    values = np.vstack([profile.at(0.0), profile.values])
    for start, end, one, other in zip([0.0, *profile.times], profile.times, values, values[1:], strict=False):
        count = int(np.ceil((np.abs(other - one) / step).max(initial=1.0))) if end > start else 0
        fine.extend(np.linspace(start, end, count + 1)[1:].tolist())
    times, last = [0.0], values[0]
    for time, after in pairwise(fine):
        if (np.abs(profile.at(after) - last) > 2 * step).any():
            times.append(time)
            last = profile.at(time)
    times += [fine[-1]] * (fine[-1] > times[-1])
    if len(times) > POSES:
        raise InputError(
            f"--camera: the table needs {len(times)} simulated poses, {POSES} at most. Play a shorter one, repeated."
        )
    return np.array(times)
