"""`InverseProblem`: residuals of inverse kinematics in a state, and the step of its linear model."""

# Of the thesis (docs/thesis.md): M7, E18

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.ik.limits import Bounds
from hydrostat.ik.objectives.objective import (
    EquilibriumState,
    Jacobian,
    Residual,
    Rows,
    StateJacobian,
    full_travels,
    posture_of,
    winch_to_cable_matrix,
)
from hydrostat.ik.search.linear_model import LinearModel, channels, least_squares, stack_jacobians
from hydrostat.mechanics import NewtonResult
from hydrostat.simulation import Simulation, require_static_obstacles


@dataclass(frozen=True, kw_only=True)
class IKOptions:
    """Options for the inverse-kinematics solver.

    Attributes:
        effort: marker error, as a fraction of the body's size, that is equivalent to the tension at full travel of a
            winch: a small regularizer against co-contraction. It falls with the error, so it does not hide targets.
        tolerance: error, as a fraction of the body's size, at which a goal counts as reached.
        progress: minimum relative decrease of the objective that the linearized problem must predict; the search ends
            below it.
        iterations: maximum number of steps from one start.
        largest_step: largest change of a contraction in one step, as a fraction of the winch's total range.
        min_tension: True to choose, among equally good contractions, those with the least tension, for any start.
        restarts: maximum number of restarts while a target is missed by more than `restart_error`; 0 to save time.
        restart_error: largest marker error, as a fraction of the body's size, at which a local optimum is accepted
            without a restart: robots are built less precisely. With `objectives`, every local optimum is restarted.
        hold_free_markers: True to keep markers without a target where they are. This changes nothing if the target is
            in reach. Otherwise they move a distance d from rest only if this gains about d^2 over four times the body's
            size.
    """

    effort: float = 1e-3
    tolerance: float = 1e-6
    progress: float = 1e-10
    iterations: int = 100
    largest_step: float = 0.3
    min_tension: bool = True
    restarts: int = 3
    restart_error: float = 3e-3
    hold_free_markers: bool = True

    def __post_init__(self) -> None:
        for name, least in (
            ("effort", 0.0),
            ("tolerance", 0.0),
            ("progress", 0.0),
            ("restart_error", 0.0),
            ("iterations", 0),
            ("restarts", 0),
        ):
            value = getattr(self, name)
            whole = name in ("iterations", "restarts")
            if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not value >= least:
                kind = "a whole number" if whole else "a number"
                raise InputError(f"{name} of inverse kinematics must be {kind} of {least:g} or more, not {value!r}")
        step = self.largest_step
        if isinstance(step, bool) or not isinstance(step, (int, float)) or not 0 < step <= 1:
            raise InputError(f"largest_step of inverse kinematics must be a share above 0, at most 1, not {step!r}")


@dataclass(frozen=True, kw_only=True, eq=False)
class InverseState:
    """State of a search."""

    values: Vector  # contraction of each channel [m]
    result: NewtonResult  # nodes near equilibrium, and the Hessian there
    posture: EquilibriumState  # equilibrium state of these nodes, to first order if they are not at rest yet
    residual: Rows  # residual of all terms [m]
    errors: Mapping[str, float]  # remaining error of each goal [m]
    excess: float  # excess of the largest tension over its limit, as a share of the limit
    sharp: bool  # True if the nodes are at equilibrium

    @property
    def history(self) -> Vector:
        """History variables of the physics."""
        return self.posture.history

    @property
    def error(self) -> float:
        """Largest remaining error of a goal [m]; infinite without goals."""
        return max(self.errors.values(), default=np.inf)


class ModelStep(NamedTuple):
    """Step of the linear model: its end point, its predicted decrease of the objective [m^2], and the model."""

    values: Vector
    promise: float
    model: LinearModel


class InverseProblem:
    """One problem of inverse kinematics: a robot, terms, limits. States are seen, linearized and judged here."""

    def __init__(
        self,
        simulation: Simulation,
        terms: Sequence[Residual],
        bounds: Bounds,
        options: IKOptions,
        *,
        ready: bool = False,
    ) -> None:
        """State the problem; if `ready`, slack cables are kept just short of taut, so they can act without delay.

        A robot without cables, or physics beside the cables that remember the way, is an InputError.
        """
        robot = simulation.robot
        simulation.body.check_held()
        if not robot.cables and not robot.drives:
            raise InputError(
                "the robot has no cables to pull; add winches and cables, or let `hydrostat design` find them"
            )
        require_static_obstacles(simulation.robot, "inverse kinematics")
        if robot.body.has_hysteresis:
            raise InputError("inverse kinematics does not model hysteresis. Remove hysteresis from the material.")
        own = simulation.friction or simulation.cables
        others = [energy for energy in simulation.assembly.energies if energy is not own]
        idle, winches = (simulation.robot.body.mesh.nodes, np.zeros(robot.num_controls)), len(robot.winches)
        if any(
            (energy.controls is not None and (energy.controls < winches).any())
            or energy.has_history
            or energy.low_rank_hessian(*idle) is not None
            for energy in others
        ):
            raise InputError(
                "inverse kinematics knows no energy beside the cables that follows winches, remembers the way or "
                "couples many nodes; leave it out of the simulation's energies"
            )
        self.simulation, self.terms, self.bounds, self.options = simulation, tuple(terms), bounds, options
        size = robot.body.mesh.size
        self.reached = options.tolerance * size  # error [m] at which a goal counts as reached
        self.size = size  # of the body [m]
        by_tension = np.full(len(robot.cables), size / _full_tension(simulation))  # of a tension, at weight 1 [m/N]
        self.worth = np.append(by_tension, np.full(len(robot.drives), size))  # then of the range of a drive [m]
        self._ready = ready

    def with_term(self, term: Residual) -> "InverseProblem":
        """Return the same problem with one more term."""
        return InverseProblem(self.simulation, [*self.terms, term], self.bounds, self.options, ready=self._ready)

    def state(
        self, values: Vector, result: NewtonResult, history: Vector | None = None, *, whole: bool = True
    ) -> InverseState:
        """State of nodes near equilibrium: residuals where they come to rest, to first order.

        Where the way there counts, it has left `history`, and the nodes rest already; `whole` tells whether all of it
        was followed.
        """
        contractions = self.bounds.spread @ values
        allowed = self.simulation.solver.force_tolerance(result.nodes, contractions) if history is None else np.inf
        sharp = bool(result.residual <= allowed) if history is None else whole
        nodes = result.nodes if sharp or history is not None else self._resting(result, contractions)
        posture = posture_of(self.simulation, nodes, contractions, history)
        errors: dict[str, float] = {}
        for term in self.terms:
            errors.update(term.errors(posture))
        excess = self.bounds.loads @ posture.tensions / self.bounds.most - 1.0
        return InverseState(
            values=values,
            result=result,
            posture=posture,
            residual=np.concatenate([np.zeros(0), *(term.residual(posture) for term in self.terms)]),
            errors=errors,
            excess=max(float(excess.max(initial=0.0)), 0.0),
            sharp=sharp,
        )

    def idle(self, state: InverseState) -> InverseState:
        """Move slack channels to where terms want them, or else towards rest or taut; no node moves."""
        places = channels(self.simulation.cables, state.posture, state.values, self.bounds)
        gaps = places.gaps
        slack = (gaps > 0) & np.isfinite(gaps) & ~places.two_way
        if not slack.any():
            return state
        edge = state.values + np.where(slack, gaps, 0.0)
        wanted = np.clip(edge if self._ready else np.minimum(edge, 0.0), self.bounds.low, self.bounds.high)
        values = np.where(slack, np.minimum(wanted, edge), state.values)
        direct = self._direct(state.posture)[:, slack] * self.bounds.span[slack]
        if direct.any():
            matrix = np.vstack([direct, _REGULARIZATION_WEIGHT * np.eye(direct.shape[1])])
            right = np.concatenate([-state.residual, np.zeros(direct.shape[1])])
            up = (np.minimum(edge, self.bounds.high) - state.values)[slack] / self.bounds.span[slack]
            down = (state.values - self.bounds.low)[slack] / self.bounds.span[slack]
            eye = np.eye(direct.shape[1])
            step = least_squares(matrix, right, np.vstack([eye, -eye]), np.concatenate([up, down]))
            if step is not None:
                values[slack] = state.values[slack] + self.bounds.span[slack] * np.clip(step, -down, up)
        return state if (values == state.values).all() else self._idle_slack(state, values)

    def _idle_slack(self, state: InverseState, values: Vector) -> InverseState:
        history = state.history if self.simulation.assembly.has_history else None
        return self.state(values, state.result, history, whole=False)

    def step(self, state: InverseState, weight: float, radius: float, curvature: np.ndarray | None = None) -> ModelStep:
        """Compute the next step from a state: contractions of the channels [m] and the predicted decrease."""
        model = self.linear(state)
        step, promise = model.best(weight * self.worth, radius, curvature)
        for channel in np.flatnonzero(model.places.between).tolist():
            other = self.linear(state, turned=(channel,))
            way, more = other.best(weight * self.worth, radius, curvature)
            if more > promise:
                model, step, promise = other, way, more
        return ModelStep(model.apply_step(step), promise, model)

    def linear(self, state: InverseState, *, turned: Collection[int] = ()) -> LinearModel:
        """Return the linear model of a state: the first-order effect of the contractions.

        Channels between cables that are wound both ways round move towards the nearest, `turned` ones to the other.
        """
        assert state.result.stiffness is not None
        places = channels(self.simulation.cables, state.posture, state.values, self.bounds, turned=turned)
        taut = places.first[places.active & ~self.bounds.driven]
        moves = stack_jacobians(self.simulation, state.posture, state.result.stiffness, taut)
        matrix = self._rows(state.posture, moves)
        edge = 1e-9  # a channel this near to taut, in shares of its range, is at the edge of it
        loose = np.abs(places.gaps) > edge * self.bounds.span
        if loose.any():  # a slack channel that follows a step stays where it is
            matrix[:, loose] -= self._direct(state.posture)[:, loose]
        tensions = moves.tensions @ self.bounds.spread
        return LinearModel(state.posture, state.residual, matrix, tensions, places, self.bounds, state.values)

    def descent_rate(self, state: InverseState, weight: float) -> float:
        """Steepest decrease of the residual norm along a channel that can move that way [m/m]."""
        return self.linear(state).descent_rate(weight * self.worth)

    def redundant(self, state: InverseState) -> bool:
        """Return True if some change of the contractions has no effect on the residual."""
        model = self.linear(state)
        moves = (model.matrix * model.range)[:, model.active]
        if not moves.size:
            return False
        values = np.linalg.svd(moves, compute_uv=False)
        idle = 1e-3  # a change that moves less than this share of what the best one moves counts as none
        return moves.shape[0] < moves.shape[1] or bool(values[-1] < idle * values[0])

    def jacobian(self, state: InverseState) -> Jacobian:
        """D residual / d contractions of the channels; slack ones as if they had just become taut."""
        return self.linear(state).matrix

    def objective(self, state: InverseState, weight: float) -> float:
        """Half the squares of residual and effort [m^2]."""
        driven = self.bounds.driven
        turned = state.values[driven] / self.bounds.span[driven]
        effort = weight * self.worth * np.append(state.posture.tensions, turned)
        return 0.5 * float(state.residual @ state.residual + effort @ effort)

    def weight(self, state: InverseState) -> float:
        """Weight of the effort: a share of the error, for then it fades as fast as the search converges."""
        return effort_weight(state.residual, self.size, self.options.effort)

    def _rows(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        rows = [np.zeros((0, len(self.bounds.channels))), *(term.jacobian(posture, moves) for term in self.terms)]
        return np.vstack(rows) @ self.bounds.spread

    def _direct(self, posture: EquilibriumState) -> Jacobian:
        """Jacobian of terms that look at contractions or slack, while no cable pulls more."""
        own = winch_to_cable_matrix(self.simulation)
        still = StateJacobian(
            nodes=np.zeros((*posture.nodes.shape, own.shape[1])), elongations=own, tensions=np.zeros_like(own)
        )
        return self._rows(posture, still)

    def _resting(self, result: NewtonResult, contractions: Vector) -> Nodes:
        """Return the equilibrium of the nodes if the forces were linear."""
        if result.stiffness is None or result.stiffness.singular:
            return result.nodes
        gradient = self.simulation.forces(result.nodes, contractions)
        return result.nodes - result.stiffness.solve(gradient).reshape(result.nodes.shape)


def effort_weight(residual: Rows, size: float, most: float) -> float:
    """Weight of the effort where so much is left [m], of a body of a size [m]: at most `most`."""
    error = float(np.sqrt(residual @ residual)) / size
    share = 0.1  # weight of the effort, as a share of the error in sizes of the body
    return max(min(most, share * error), _REGULARIZATION_WEIGHT)


_REGULARIZATION_WEIGHT = 1e-8  # of the effort; enough to keep the linearized problem well posed


def _full_tension(simulation: Simulation) -> float:
    """Largest cable tension at full travel of its winch if the body were linear [N]."""
    robot, cables = simulation.robot, simulation.cables
    if not robot.cables:
        return 1.0
    travel = cables.compute_contractions(full_travels(robot))
    rest = simulation.rest
    compliance = simulation.stiffness(rest).compliance_to(cables.columns(rest.nodes)).compliance.diagonal()
    return float((travel / (1.0 / cables.law.stiffness + compliance)).max())
