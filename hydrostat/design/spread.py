"""`spread_columns`: first-order second moments, how far each manufacturing tolerance takes the markers of a pose."""

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.design.uncertainty import BuildTolerances
from hydrostat.simulation import CableSensitivities, Equilibrium, Simulation

Columns = Float[np.ndarray, "rows tolerances"]


def spread_columns(
    simulation: Simulation,
    pose: Equilibrium,
    sensitivities: CableSensitivities,
    uncertainty: BuildTolerances,
    markers: int,
) -> Columns:
    """Moves of the first `markers` rows of `sensitivities` by one standard deviation of each independent tolerance [m].

    The sum of their squares is the variance of the rows, to first order. Tolerances are those of `BuildTolerances`:
    coordinates of holes, winch after winch and cable after cable; then knots, spools, stiffnesses of cables and of
    body; friction is last. Pins are left out: they are stiff compared with the body.
    """
    robot = simulation.robot
    sewing = uncertainty.sewing * _holes(simulation, sensitivities.points[:markers])
    several = np.bincount(simulation.cables.winches, minlength=len(robot.winches))[simulation.cables.winches] > 1
    knots = uncertainty.slack * sensitivities.slack[:markers] * several
    spools = uncertainty.spool * sensitivities.contractions[:markers] * pose.contractions
    stiff = (
        -(sensitivities.fields[:markers].reshape(markers, -1) @ simulation.cables.columns(pose.nodes)) * pose.tensions
    )
    body = float(np.hypot(uncertainty.young, uncertainty.thickness)) * stiff.sum(axis=1)
    low, high = uncertainty.friction
    mean_square = (low**2 + low * high + high**2) / 3
    rubs = np.sqrt(mean_square) * friction_column(simulation, pose, sensitivities.fields[:markers])
    return np.column_stack([sewing, knots, spools, uncertainty.stiffness * stiff, body, rubs])


def friction_column(
    simulation: Simulation, pose: Equilibrium, fields: Float[np.ndarray, "rows nodes dim"]
) -> Float[np.ndarray, " rows"]:
    """Sensitivity of rows to the friction coefficient of all cables, at 0 and while all slip towards their winch [m].

    Behind turns of Theta in all a segment is pulled with T (1 - mu Theta). The cable's own law keeps the mean along its
    length, so the tensions differ from T by -mu T (Theta - its mean); the body gives way to these.
    """
    cables, points = simulation.cables, simulation.route_points
    spans = points.spans(points.positions(pose.nodes))
    lengths = np.linalg.norm(spans, axis=1)
    units = spans / lengths[:, None]
    joined = np.append(False, points.cables[1:] == points.cables[:-1])
    cosines = np.clip(np.einsum("sd,sd->s", units, np.roll(units, 1, axis=0)), -1.0, 1.0)
    turned = _since_winch(np.where(joined, np.arccos(cosines), 0.0), points.cables)
    rests = np.linalg.norm(points.spans(points.rests), axis=1)
    count = len(cables.winches)
    mean = np.bincount(points.cables, rests * turned, count) / np.bincount(points.cables, rests, count)
    extra = -pose.tensions[points.cables] * (turned - mean[points.cables])
    along = np.einsum("rsd,sd->rs", points.spans(points.values(fields)), units)
    return -along @ extra


def _since_winch(turns: Vector, cables: np.ndarray) -> Vector:
    """Sums of turns along each cable, this one included."""
    total = np.cumsum(turns)
    first = np.searchsorted(cables, cables, side="left")
    return total - total[first] + turns[first]


def _holes(simulation: Simulation, points: Float[np.ndarray, "rows points dim"]) -> Columns:
    """Sensitivities to places of holes: winches, which move the beginnings of their cables too, then via points."""
    robot, counts = simulation.robot, simulation.route_points.counts
    firsts = np.cumsum([0, *counts])[:-1]
    moving = ~simulation.route_points.world[firsts]
    by_winch = np.zeros((len(points), len(robot.winches), points.shape[2]))
    for first, winch in zip(firsts[moving], simulation.cables.winches[moving], strict=True):
        by_winch[:, winch] += points[:, first]
    others = np.delete(points, firsts, axis=1)
    return np.concatenate([by_winch, others], axis=1).reshape(len(points), -1)
