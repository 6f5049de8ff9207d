"""`suggest_measurements`: most informative poses and hung masses for the parameters of a robot."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Int
from hydrostat.errors import InputError
from hydrostat.geometry import find_crossings
from hydrostat.identification.kinds import kind_names, named_model
from hydrostat.identification.marker_predictor import MarkerPredictor
from hydrostat.identification.measurements import Measurements
from hydrostat.robot import Robot
from hydrostat.units import MM

NOISE = 0.01
"""Standard deviation of a measured coordinate about a good model, as a share of the body's size."""

IDLE_SHARE = 0.4
"""Share of the winches that do not contract in a candidate."""

WITH_HISTORY = {"friction", "hysteresis"}
"""Kinds of parameters that strokes up and down show."""

STROKE = (0.5, 1.0, 0.5, 0.0)
"""Rows of a stroke, as shares of its largest contractions: up, down and to rest."""

STROKES = 12
"""Strokes of which the best are chosen; at least as many as are asked for."""

CANDIDATES = 60
"""Poses of which the best are chosen; at least three for each that is asked for."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SuggestedMeasurements:
    """Suggested measurements, the most informative first.

    Attributes:
        commands: contraction of each winch [m], (rows, winches).
        markers: names of all markers.
        masses: mass to hang at each marker [kg], (rows, markers).
        deviations: standard deviation of each parameter after these measurements, over that of its guess.
        candidates: number of poses they were chosen from.
        noise: assumed standard deviation of a measured coordinate about a good model [m].
        in_order: True if the rows are one motion, in strokes up and down.
    """

    commands: Float[np.ndarray, "rows winches"]
    markers: tuple[str, ...]
    masses: Float[np.ndarray, "rows markers"]
    deviations: dict[str, float]
    candidates: int
    noise: float
    in_order: bool


def suggest_measurements(
    robot: Robot,
    count: int,
    *,
    fit: Sequence[str] | None = None,
    masses: Sequence[float] = (),
    tension: float = np.inf,
    seed: int = 0,
) -> SuggestedMeasurements:
    """Choose poses and hung masses most informative about the parameters (D-optimal, exact sensitivities as assumed).

    If friction or hysteresis is fitted, whole strokes of four rows are chosen (`STROKE`), solved as one motion.

    Args:
        robot: robot as it is assumed to be built; all its markers are measured.
        count: measurements to make.
        fit: kinds of parameters, as in `identify`; those that are fitted by default if left out.
        masses: masses that can be hung at a marker, one at a time [kg].
        tension: most tension of a cable [N].
        seed: seed of the candidates.

    Raises:
        InputError: no markers, masses without gravity, or fewer poses within the limits than asked for.
    """
    if not robot.markers:
        raise InputError(f"{robot.name}: no [[marker]] in robot.toml. Add one for each point to measure.")
    if count < 1:
        raise InputError(f"--suggest {count}: must be 1 or more")
    if masses and robot.gravity is None:
        raise InputError('--hang: the robot has no gravity. Add gravity = "-y" to robot.toml.')
    fit = kind_names(fit)
    model, in_order = named_model(robot, fit), bool(WITH_HISTORY.intersection(fit or ()))
    if in_order and count < len(STROKE):
        raise InputError(f"--suggest {count}: a stroke that shows friction takes {len(STROKE)} photographs. Ask more.")
    shares = np.array(STROKE if in_order else (1.0,))
    each, tried = len(shares), max(STROKES, count) if in_order else max(CANDIDATES, 3 * count)
    commands, hung = _candidates(robot, tried, masses, np.random.default_rng(seed))
    commands, hung = np.kron(commands, shares[:, None]), np.repeat(hung, each, axis=0)
    names = tuple(marker.name for marker in robot.markers)
    places = np.zeros((len(commands), len(names), robot.body.mesh.dim))
    rows = Measurements(commands=commands, markers=names, places=places, masses=hung, in_order=in_order)
    predictor = MarkerPredictor(model, rows)
    found = predictor.predict(np.zeros(len(model.parameters)), with_jacobian=True)
    assert found.jacobian is not None
    is_able = [
        pose is not None
        and has_equilibrium
        and pose.tensions.max(initial=0.0) <= tension
        and not str(find_crossings(robot.body.mesh, pose.nodes))
        for pose, has_equilibrium in zip(predictor.poses, found.has_equilibrium, strict=True)
    ]
    able = np.flatnonzero(np.reshape(is_able, (-1, each)).all(axis=1))
    if len(able) < count // each:
        raise InputError(
            f"--suggest {count}: {each * len(able)} of {len(commands)} poses tried are within the limits. "
            "Ask fewer, or allow more tension."
        )
    noise, parameters = NOISE * robot.body.mesh.size, len(model.parameters)
    jacobians = found.jacobian.reshape(len(commands) // each, -1, parameters)[able] / noise
    chosen = choose_measurements(jacobians, count // each)
    information = np.eye(parameters) + np.einsum("rci,rcj->ij", jacobians[chosen], jacobians[chosen])
    kept = np.sqrt(np.diag(np.linalg.inv(information)))
    taken = (each * able[chosen][:, None] + np.arange(each)).ravel()
    return SuggestedMeasurements(
        commands=commands[taken],
        markers=names,
        masses=hung[taken],
        deviations=dict(zip((parameter.name for parameter in model.parameters), kept.tolist(), strict=True)),
        candidates=each * len(able),
        noise=noise,
        in_order=in_order,
    )


def choose_measurements(
    jacobians: Float[np.ndarray, "candidates coordinates parameters"], count: int
) -> Int[np.ndarray, " count"]:
    """Measurements whose information has the largest determinant: greedy choice, then exchanges (Fedorov 1972).

    Args:
        jacobians: changes of the coordinates of each candidate in standard deviations of the noise, by parameters in
            standard deviations of their guesses.
        count: measurements to choose, each at most once.

    Returns:
        Indices of the candidates, in the order in which a greedy choice takes them.
    """
    prior = np.eye(jacobians.shape[2])
    alone = np.einsum("rci,rcj->rij", jacobians, jacobians)
    chosen: list[int] = []
    for _ in range(count):
        chosen.append(_best(prior + alone[chosen].sum(axis=0), alone, chosen))
    improved = True
    while improved:
        improved = False
        for place in range(count):
            others = chosen[:place] + chosen[place + 1 :]
            base = prior + alone[others].sum(axis=0)
            best = _best(base, alone, others)
            if _log_det(base + alone[best]) > _log_det(base + alone[chosen[place]]) + 1e-9:
                chosen[place], improved = best, True
    ordered: list[int] = []
    for _ in range(count):
        left = [row for row in range(len(alone)) if row not in chosen or row in ordered]
        ordered.append(_best(prior + alone[ordered].sum(axis=0), alone, left))
    return np.array(ordered)


def _best(base: np.ndarray, alone: np.ndarray, taken: Sequence[int]) -> int:
    """Candidate that adds most to a base, but for those that are taken."""
    gains = np.linalg.slogdet(base + alone)[1]
    gains[list(taken)] = -np.inf
    return int(np.argmax(gains))


def _log_det(matrix: np.ndarray) -> float:
    return float(np.linalg.slogdet(matrix)[1])


def _candidates(
    robot: Robot, count: int, masses: Sequence[float], rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Contractions [m] in whole millimeters and hung masses [kg]: rest, each winch alone, then random ones."""
    travel = np.array([winch.travel for winch in robot.winches])
    idle = rng.random((count, len(travel))) < IDLE_SHARE
    pulls = [np.zeros(len(travel)), *np.eye(len(travel)), *np.where(idle, 0.0, rng.random((count, len(travel))))]
    loads = [np.zeros(len(robot.markers))]
    loads += [mass * row for mass in masses for row in np.eye(len(robot.markers))]
    rows = {}
    for index, pull in enumerate(pulls):
        for load in loads[:1] if not masses else (loads[0], loads[1 + index % (len(loads) - 1)]):
            command = MM * np.round(pull * travel / MM)
            rows.setdefault((*command, *load), (command, load))
    commands, hung = zip(*rows.values(), strict=True)
    return np.array(commands), np.array(hung)
