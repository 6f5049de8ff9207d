"""`tensions_along`: what motors should feel while a robot plays, from its simulation."""

from collections.abc import Callable

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.robot import Robot
from hydrostat.simulation import Profile, Simulation

SAMPLES = 80
"""Equilibria along a way, at most."""


def tensions_along(robot: Robot, profile: Profile) -> Callable[[Vector], Vector]:
    """What the cables of each winch pull together [N], by contractions [m] that lie near a profile or its way there.

    Equilibria are solved at even steps of the way, from one to the next; between, the nearest two are mixed by their
    distances. A pose that is not found is left out.
    """
    simulation, known, pulls, pose = Simulation(robot), [], [], None
    for taken in _samples(profile):
        found = simulation.solve(taken, start=pose, strict=False)
        if found.result.converged:
            pose = found
            known.append(taken)
            pulls.append(_by_winch(robot, found.tensions))
    places, forces = np.array(known), np.array(pulls)

    def tensions(contractions: Vector) -> Vector:
        away = np.abs(places - contractions).sum(axis=1)
        first, second = np.argsort(away)[:2] if len(away) > 1 else (0, 0)
        share = away[first] / max(away[first] + away[second], 1e-9)
        return (1 - share) * forces[first] + share * forces[second]

    return tensions


def _samples(profile: Profile) -> list[Vector]:
    """Contractions from rest to the begin of a profile, then along it."""
    begin = profile.at(0.0)
    way = [share * begin for share in np.linspace(0, 1, 8)]
    times = np.linspace(profile.times[0], profile.times[-1], SAMPLES - len(way))
    return [*way, *(profile.at(float(time)) for time in times)]


def _by_winch(robot: Robot, tensions: Vector) -> Vector:
    """Pull at each winch at the radius of its own spool [N]."""
    pulls = dict.fromkeys((winch.name for winch in robot.winches), 0.0)
    for cable, ratio, tension in zip(robot.cables, robot.spool_ratios, tensions.tolist(), strict=True):
        pulls[cable.winch] += ratio * tension
    return np.array(list(pulls.values()))
