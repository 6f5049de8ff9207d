"""`LinearModel`: first-order effect of contractions near a state, with slack cables.

`solve_nonnegative` and `solve_upper` are small solvers without the imports of SciPy's packages.
"""

from collections.abc import Collection
from copy import copy
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float, Vector
from hydrostat.ik.limits import Bounds
from hydrostat.ik.objectives.objective import EquilibriumState, StateJacobian, rubbing_moves, winch_to_cable_matrix
from hydrostat.lazy import load_compiled
from hydrostat.mechanics import CableEnergy, FactorizedHessian
from hydrostat.simulation import Simulation


@dataclass(frozen=True, eq=False)
class Channels:
    """Slack state of the channels where a linear model begins."""

    # contraction of a slack channel, without effect, until its first cable is taut [m]; negative where that is reversed
    gaps: Vector
    beyond: Vector  # further release of a channel until it is slack, after its tension is 0 to first order [m]
    first: np.ndarray  # that cable, by channel; for a taut channel, the cable that stays taut longest
    active: np.ndarray  # True for a channel with a cable that can become taut within the limits
    two_way: np.ndarray  # True for a channel with cables that are wound both ways round
    between: np.ndarray  # True for one of these that is slack: it can move either way


def channels(
    cables: CableEnergy, posture: EquilibriumState, values: Vector, bounds: Bounds, *, turned: Collection[int] = ()
) -> Channels:
    """Compute the distance of each channel from becoming taut or slack, at channel contractions `values` [m].

    The first cable of a channel between its cables is the nearest to taut, of `turned` ones the nearest on the other
    side.
    """
    count = len(values)
    first = np.zeros(count, dtype=np.int64)
    gaps, beyond = np.full(count, np.inf), np.zeros(count)
    law = cables.law
    fall = posture.tensions / np.maximum(law.tangent(posture.elongations), np.finfo(float).tiny)
    two_way, between = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    pulled, ways = posture.elongations / np.abs(cables.ratios), np.sign(cables.ratios)
    for channel in range(count):
        own = np.flatnonzero(bounds.cables == channel)
        if own.size:
            cable = own[np.argmax(pulled[own])]
            two_way[channel] = ways[own].min() < ways[own].max()
            between[channel] = two_way[channel] and pulled[cable] <= _EDGE * law.smoothing[cable]
            if channel in turned:
                others = own[ways[own] != ways[cable]]
                cable = others[np.argmax(pulled[others])]
            first[channel] = cable
            gaps[channel] = ways[cable] * max(-pulled[cable], 0.0)
            left = max(posture.elongations[cable] - fall[cable], 0.0) + 0.01 * law.smoothing[cable]
            beyond[channel] = left / cables.ratios[cable]
    gaps[bounds.driven] = 0.0
    room = np.where(gaps < 0, values - bounds.low, bounds.high - values)
    return Channels(gaps, beyond, first, np.abs(gaps) <= room, two_way, between)


_EDGE = 0.1  # a channel whose tautest cable is longer by less than this share of its smoothing is still slack


def stack_jacobians(
    simulation: Simulation, posture: EquilibriumState, stiffness: FactorizedHessian, taut: np.ndarray
) -> StateJacobian:
    """Sensitivities to contractions, by the implicit function theorem: H dx/da = -d2E/dx da (R33, E16).

    A slack cable has none (E15); those in `taut` are taken as if they had just become taut.
    """
    if simulation.friction is not None:
        return rubbing_moves(simulation, simulation.friction, posture, stiffness, taut)
    cables = simulation.cables
    loose = np.zeros(len(cables.winches), dtype=bool)
    loose[taut] = posture.elongations[taut] <= 0
    tangents = cables.law.tangent(np.where(loose, 0.5 * cables.law.smoothing, posture.elongations))
    own = winch_to_cable_matrix(simulation)
    moves = stiffness.response(np.diag(tangents)) @ own
    if simulation.robot.drives:
        first = len(simulation.robot.winches)
        pushed = simulation.assembly.control_derivative(posture.nodes, posture.contractions)[:, first:].toarray()
        moves[:, first:] -= stiffness.solve(pushed)
    elongations = own + stiffness.columns.T @ moves
    return StateJacobian(
        nodes=moves.reshape(*posture.nodes.shape, -1), elongations=elongations, tensions=tangents[:, None] * elongations
    )


class LinearModel:
    """Residuals and tensions to first order, and the step that promises most.

    The unknowns are the contractions of the channels, each beginning where its first cable is taut. A cable cannot
    push, so the tension of that cable must not fall below 0: a channel that would have to push follows instead with
    tension 0, which is what a slack one does to the body. So one bounded problem knows who joins and who lets go (E15).
    """

    def __init__(
        self,
        posture: EquilibriumState,
        residual: Float[np.ndarray, " rows"],
        matrix: Float[np.ndarray, "rows channels"],
        tensions: Float[np.ndarray, "cables channels"],
        places: Channels,
        bounds: Bounds,
        values: Vector,
    ) -> None:
        """Residual and its Jacobian, that of tensions, and limits at contractions `values` of the channels."""
        self.residual, self.matrix, self.places, self.bounds, self.values = residual, matrix, places, bounds, values
        self._pulls = _first_pulls(posture, tensions, places, bounds)
        self._loads = bounds.loads @ posture.tensions, bounds.loads @ tensions, bounds.most
        spans = np.diag(1.0 / bounds.span)[bounds.driven]
        self._efforts = np.append(posture.tensions, spans @ values), np.vstack([tensions, spans])
        self.active = places.active
        self.range = bounds.span

    def best(self, effort: Vector, radius: float, curvature: np.ndarray | None = None) -> tuple[Vector, float]:
        """Step of the channels [m] that minimizes residual and effort, and the decrease of half their squares.

        Where no step keeps the limits on tension, it goes as far towards them as it can. The effort is the residual
        that a tension of each cable is worth [m/N], then that of the range of each drive [m]; the radius is the largest
        step as a share of each range, the curvature (channels, channels) what Gauss-Newton leaves out of the Hessian.
        """
        active = self.active
        scale = self.range[active]
        matrix, right = self._squares(effort)
        matrix, aim = matrix * scale, -right
        flat = 1e-12  # least curvature of a model, as a share of the largest
        if curvature is not None:
            hessian = matrix.T @ matrix + curvature[np.ix_(active, active)] * scale[:, None] * scale
            values, axes = np.linalg.eigh(hessian)
            bends = np.abs(values)  # downhill of a crest too, as far as the radius allows
            root = np.sqrt(np.maximum(bends, flat * bends.max(initial=0.0)))[:, None] * axes.T
            if bends.any():
                matrix, aim = root, np.linalg.solve(root.T, -matrix.T @ right)
        limits, room = self._limits(radius)
        step = None
        # of an excess that one step takes back: the first possible
        shares = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.0)
        for share in shares:
            step = least_squares(matrix, aim, limits * scale, np.maximum(room, share * room))
            if step is not None:
                break
        full = np.zeros_like(self.values)
        if step is None:
            return full, 0.0
        after = aim - matrix @ step
        full[active] = scale * step
        return full, 0.5 * float(aim @ aim - after @ after)

    def with_residual(self, residual: Float[np.ndarray, " rows"]) -> "LinearModel":
        """Return the same model with another residual, that of other goals."""
        other = copy(self)
        other.residual = residual
        return other

    def gradient(self, residual: Vector | None = None) -> Vector:
        """Gradient of half the squares of the residual, or of another one, along each channel [m]."""
        return self.matrix.T @ (self.residual if residual is None else residual)

    def alike(self, other: "LinearModel") -> bool:
        """Return True if the same cables are taut in both models."""
        return bool(((self.places.gaps != 0) == (other.places.gaps != 0)).all())

    def descent_rate(self, effort: Vector) -> float:
        """Steepest fall of the length of residual and effort along a channel, as far as the limits allow [m/m].

        Multipliers of the limits that hold are those that leave least of the gradient; 0 at an optimum (Karush, Kuhn
        and Tucker).
        """
        matrix, right = self._squares(effort)
        length = float(np.linalg.norm(right))
        if length == 0.0 or not self.active.any():
            return 0.0
        gradient = matrix.T @ right / length
        limits, room = self._limits(1.0)
        # a limit holds when less than this share of what the channels' ranges could use of it is left
        holds = 1e-9
        rows = limits[room <= holds * np.abs(limits) @ self.range[self.active]]
        if len(rows):
            rows = rows / np.linalg.norm(rows, axis=1)[:, None]
            gradient = gradient + rows.T @ solve_nonnegative(rows.T, -gradient)
        return float(np.abs(gradient).max())

    def apply_step(self, step: Vector) -> Vector:
        """Contractions of the channels after a step [m]; slack ones that do not join stay as they are."""
        places = self.places
        pulls, rates = self._pulls
        slack = pulls + rates @ step <= 1e-9 * (np.abs(rates) @ self.range)
        joins = self.active & ~slack & (places.gaps != 0)
        leaves = self.active & slack & (places.gaps == 0)
        stays = self.active & ~slack & (places.gaps == 0)
        ends = self.values.copy()
        ends[joins] += (step + places.gaps)[joins]
        ends[leaves] += (step - places.beyond)[leaves]
        ends[stays] += step[stays]
        low, high = self.bounds.low, self.bounds.high
        # a step that ends within this share of the range of a channel from its limit ends on it
        rounding = 1e-12
        hair = rounding * self.bounds.span  # what least squares leave of the way to a limit
        return np.where(ends > high - hair, high, np.where(ends < low + hair, low, ends))

    def _squares(self, effort: Vector) -> tuple[np.ndarray, Vector]:
        """Jacobian with respect to active channels, and values, of residual and effort."""
        tensions, rises = self._efforts
        matrix = np.vstack([self.matrix, effort[:, None] * rises])[:, self.active]
        return matrix, np.concatenate([self.residual, effort * tensions])

    def _limits(self, radius: float) -> tuple[np.ndarray, np.ndarray]:
        """Rows and room of all limits on the step of the active channels [m], [N]."""
        active, bounds = self.active, self.bounds
        begin = self.values[active] + self.places.gaps[active]
        reach = radius * self.range[active]
        eye = np.eye(int(active.sum()))
        pulls, rates = self._pulls
        loads, rises, largest = self._loads
        rows = [eye, -eye, -rates[np.ix_(active, active)], rises[:, active]]
        room = [
            np.minimum(bounds.high[active] - begin, reach),
            np.minimum(begin - bounds.low[active], reach),
            pulls[active],
            largest - loads,
        ]
        return np.vstack(rows), np.concatenate(room)


def _first_pulls(
    posture: EquilibriumState, tensions: Float[np.ndarray, "cables channels"], places: Channels, bounds: Bounds
) -> tuple[Vector, Float[np.ndarray, "channels channels"]]:
    """Tension of the first cable of each channel, and its derivatives; that of a drive pulls always."""
    if not bounds.driven.any():
        return posture.tensions[places.first], tensions[places.first]
    pulls, rates = np.full(len(places.first), np.inf), np.zeros((len(places.first), len(places.first)))
    winches = ~bounds.driven
    pulls[winches], rates[winches] = posture.tensions[places.first[winches]], tensions[places.first[winches]]
    return pulls, rates


Matrix = Float[np.ndarray, "rows size"]


def least_squares(
    matrix: Matrix,
    right: Float[np.ndarray, " rows"],
    limits: Float[np.ndarray, "limits size"],
    room: Float[np.ndarray, " limits"],
) -> Float[np.ndarray, " size"] | None:
    """Minimize |matrix x - right| with limits x <= room; None if no x is within the limits.

    By a QR factorization it becomes the problem of the least distance, and that one of nonnegative least squares
    (Lawson and Hanson 1974, chapter 23). `matrix` must have full column rank.
    """
    if not matrix.shape[1]:
        return np.zeros(0)
    q, r = np.linalg.qr(matrix)
    aim = q.T @ right
    rows = solve_upper(r, limits.T, transposed=True).T
    nearest = _least_distance(rows, room - rows @ aim)
    return None if nearest is None else solve_upper(r, aim + nearest)


def _least_distance(
    rows: Float[np.ndarray, "limits size"], room: Float[np.ndarray, " limits"]
) -> Float[np.ndarray, " size"] | None:
    """Shortest z with rows z <= room."""
    lengths = np.linalg.norm(rows, axis=1)
    some = lengths > 0
    if (room[~some] < 0).any():
        return None
    rows, room = rows[some] / lengths[some, None], room[some] / lengths[some]
    far = -room.min(initial=0.0)
    if far <= 0.0:
        return np.zeros(rows.shape[1])
    stacked = np.vstack([-rows.T, -room / far])
    pushes = solve_nonnegative(stacked, np.eye(len(stacked))[-1])
    left = stacked @ pushes
    left[-1] -= 1.0
    # what is left of the nonnegative problem is 1 / (1 + |z|^2); below this no z is allowed
    inconsistent = 1e-12
    if -left[-1] < inconsistent:
        return None
    return -far * left[:-1] / left[-1]


def solve_nonnegative(
    matrix: Float[np.ndarray, "rows size"], right: Float[np.ndarray, " rows"]
) -> Float[np.ndarray, " size"]:
    """Minimize |matrix x - right| with x >= 0 (Lawson and Hanson 1974), as `scipy.optimize.nnls` does.

    Raises:
        ValueError: a number that is not finite.
        RuntimeError: too many iterations.
    """
    matrix, right = np.asarray_chkfinite(matrix, float, "C"), np.asarray_chkfinite(right, float)
    solver = load_compiled("scipy.optimize._slsqplib")
    if solver is not None and hasattr(solver, "nnls"):
        try:
            found, _, code = solver.nnls(matrix, right, 3 * matrix.shape[1])
        except (TypeError, ValueError):  # another version of SciPy
            pass
        else:
            if code == _EXCEEDED:
                raise RuntimeError("Maximum number of iterations reached.")
            return found
    from scipy.optimize import nnls

    return nnls(matrix, right)[0]


def solve_upper(
    triangle: Float[np.ndarray, "size size"], right: Float[np.ndarray, "size *columns"], *, transposed: bool = False
) -> Float[np.ndarray, "size *columns"]:
    """Solve with an upper triangle, or with its transpose.

    NumPy exchanges no rows of an upper triangle, thus its LU factors are the triangle itself. A lower one is upper in
    reverse order.
    """
    if transposed:
        return np.linalg.solve(triangle.T[::-1, ::-1], right[::-1])[::-1]
    return np.linalg.solve(triangle, right)


_EXCEEDED = 3
