"""`TensionLookup`, `tensions_along`, `WinchPull.of_robot`: simulated motor loads."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import ContractionProfile, Equilibrium, Simulation

SAMPLES = 80
"""Equilibria along a way, at most."""
STEPS = 8
"""Equilibria for the pull of one winch."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WinchPull:
    """Cable tension of a winch as a function of its contraction, with all other winches at rest.

    Attributes:
        taut: contraction at which its first cable becomes taut, with the body at rest [m].
        places: contractions in rising order, at least two [m].
        pulls: total cable tension of the winch at these contractions [N].
    """

    taut: float
    places: Vector
    pulls: Vector

    def at(self, contractions: Vector | float) -> Vector:
        """Return the pull at contractions [N]; extrapolated with the last slope."""
        last = max(float(self.pulls[-1] - self.pulls[-2]), 0.0) / float(self.places[-1] - self.places[-2])
        beyond = np.maximum(np.asarray(contractions) - self.places[-1], 0.0)
        return np.interp(contractions, self.places, self.pulls) + last * beyond

    def stiffness(self, beyond: float) -> float:
        """Return the secant stiffness at a distance beyond the taut point [N/m]."""
        return float(self.at(self.taut + beyond)) / beyond

    @staticmethod
    def of_robot(robot: Robot, most: float = 0.02) -> "tuple[WinchPull, ...]":
        """Simulate each winch alone; return its tension curve up to `most` beyond the edge, where it goes taut [m]."""
        simulation, found = Simulation(robot), []
        for index, winch in enumerate(robot.winches):
            slack = [
                cable.slack / ratio
                for cable, ratio in zip(robot.cables, robot.spool_ratios, strict=True)
                if cable.winch == winch.name and ratio > 0
            ]
            taut, pose = min(slack, default=0.0), None
            places, pulls = [-1.0, taut], [0.0, 0.0]
            for taken in np.linspace(taut, min(taut + most, max(winch.travel, taut + 1e-3)), STEPS + 1)[1:].tolist():
                contractions = np.zeros(len(robot.winches))
                contractions[index] = taken
                solved = simulation.solve(contractions, start=pose, strict=False)
                if solved.result.converged:
                    pose = solved
                    places.append(taken)
                    pulls.append(float(winch_tensions(robot, solved.tensions)[index]))
            found.append(WinchPull(taut=taut, places=np.array(places), pulls=np.array(pulls)))
        return tuple(found)


class TensionLookup:
    """Total cable tension of each winch [N] at contractions [m], interpolated between solved poses.

    Between poses, the nearest two are mixed by their distances. One thread may add poses while others query.
    """

    def __init__(self, robot: Robot, *, near: float = np.inf, most: int = 1000) -> None:
        """Nothing is known yet; further than `near` [m] from all poses nothing ever is; the oldest are forgotten."""
        self._robot, self._near, self._most = robot, near, most
        self._known: tuple[np.ndarray, np.ndarray] = (np.zeros((0, robot.num_controls)), np.zeros((0, 0)))

    def add(self, pose: Equilibrium) -> None:
        """Add a pose; a pose that is not in equilibrium is ignored."""
        if pose.result.converged:
            self.store(pose.controls, winch_tensions(self._robot, pose.tensions))

    def store(self, contractions: Vector, pulls: Vector) -> None:
        """Add the pulls of the winches [N] at contractions [m]."""
        places, known = self._known
        more = np.concatenate([known, pulls[None]]) if len(known) else pulls[None]
        self._known = np.concatenate([places, contractions[None]])[-self._most :], more[-self._most :]

    def nearest(self, contractions: Vector) -> Vector:
        """Return the pulls [N] of the nearest poses, at any distance."""
        return self._blend_tensions(contractions, np.inf)

    def __call__(self, contractions: Vector) -> Vector:
        """Pulls [N]; NaN where no pose is near."""
        return self._blend_tensions(contractions, self._near)

    def _blend_tensions(self, contractions: Vector, near: float) -> Vector:
        places, pulls = self._known
        apart = np.abs(places - contractions)
        away = apart.sum(axis=1)
        first, second = np.argsort(away)[:2] if len(away) > 1 else (0, 0)
        if not len(away) or apart[first].max(initial=0.0) > near:
            return np.full(len(contractions), np.nan)
        share = away[first] / max(away[first] + away[second], 1e-9)
        return (1 - share) * pulls[first] + share * pulls[second]


def tensions_along(robot: Robot, profile: ContractionProfile) -> Callable[[Vector], Vector]:
    """Return total cable tensions of each winch [N] by contractions [m], near a profile and the path to its start.

    Equilibria are solved at even steps along the path, each from the one before; between them, the nearest two are
    mixed by their distances. Poses without an equilibrium are left out.
    """
    simulation, known, pose = Simulation(robot), TensionLookup(robot), None
    for taken in _samples(profile):
        found = simulation.solve(taken, start=pose, strict=False)
        known.add(found)
        pose = found if found.result.converged else pose
    return known.nearest


def _samples(profile: ContractionProfile) -> list[Vector]:
    """Contractions from rest to the begin of a profile, then along it."""
    begin = profile.at(0.0)
    way = [share * begin for share in np.linspace(0, 1, 8)]
    times = np.linspace(profile.times[0], profile.times[-1], SAMPLES - len(way))
    return [*way, *(profile.at(float(time)) for time in times)]


def winch_tensions(robot: Robot, tensions: Vector) -> Vector:
    """Return the pull of each winch at the radius of its own spool [N]; reversed cables count negative."""
    pulls = dict.fromkeys((winch.name for winch in robot.winches), 0.0)
    for cable, ratio, tension in zip(robot.cables, robot.spool_ratios, tensions.tolist(), strict=True):
        pulls[cable.winch] += ratio * tension
    return np.array(list(pulls.values()))
