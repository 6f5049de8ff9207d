"""`sweep`: all that a marker can reach with its winches, found in a process of its own."""

from math import ceil, log2

import numpy as np
from scipy.stats import qmc

from hydrostat.arrays import Vector
from hydrostat.errors import HydrostatError
from hydrostat.robot import Robot
from hydrostat.simulation import Simulation
from hydrostat.studio.jobs import Report

COUNT = 400
"""So many poses are tried."""

PORTION = 8
"""So many are told at once."""

SEED = 8


def sweep(report: Report, robot: Robot, marker: str, tension: float, count: int = COUNT) -> int:
    """Poses for contractions spread evenly over what all winches can do; tells where the marker is, a few at a time.

    Poses that do not converge, are not stable or ask a cable for more than its limit are left out.

    Args:
        report: is told the places, (points, dim) [m].
        robot: whose marker it is.
        marker: its name.
        tension: the most that a cable bears [N].
        count: how many poses are tried.

    Returns:
        How many of them can be held.
    """
    simulation = Simulation(robot)
    last, held, places = simulation.rest, 0, []
    for index, contractions in enumerate(spread(robot, count)):
        report.progress("trying poses", index, count)
        try:
            pose = simulation.solve(contractions, start=last, strict=False)
        except HydrostatError:
            continue
        if pose.result.converged and pose.result.stable and pose.tensions.max(initial=0.0) <= tension:
            last = pose
            held += 1
            places.append(pose.markers[marker])
        if len(places) == PORTION:
            report.part(np.array(places))
            places = []
    if places:
        report.part(np.array(places))
    return held


def spread(robot: Robot, count: int) -> list[Vector]:
    """Contractions of all winches [m], by Sobol's sequence, each near the one before so that solves are short."""
    low = np.array([-winch.release for winch in robot.winches])
    high = np.array([winch.travel for winch in robot.winches])
    drawn = qmc.Sobol(len(robot.winches), rng=SEED).random_base2(max(ceil(log2(count)), 1))[:count]
    left = list(range(count))
    order, here = [], np.clip(-low / (high - low), 0.0, 1.0)
    while left:
        near = left[int(np.argmin(((drawn[left] - here) ** 2).sum(axis=1)))]
        left.remove(near)
        order.append(near)
        here = drawn[near]
    return [low + share * (high - low) for share in drawn[order]]
