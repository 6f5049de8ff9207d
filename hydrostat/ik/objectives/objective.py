"""`Objective`: contract of all terms of inverse kinematics, and checks of their arguments."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.geometry import Mesh
from hydrostat.mechanics import FactorizedHessian, FrictionCableEnergy
from hydrostat.robot import Robot
from hydrostat.simulation import Equilibrium, Simulation

Rows = Float[np.ndarray, " rows"]
Jacobian = Float[np.ndarray, "rows winches"]


@dataclass(frozen=True, kw_only=True, eq=False)
class EquilibriumState:
    """State that objectives depend on: a robot at equilibrium under given contractions.

    Attributes:
        nodes: node positions [m].
        contractions: contraction of each winch [m], then the value of each drive [rad or m].
        elongations: elongation of each cable beyond its free length [m]; negative when slack.
        tensions: tension of each cable [N]; at its winch for cables with friction.
        history: history variables of the physics, as in an `Equilibrium`.
    """

    nodes: Nodes
    contractions: Vector
    elongations: Vector
    tensions: Vector
    history: Vector = field(default_factory=lambda: np.zeros(0))

    @staticmethod
    def at(simulation: Simulation, pose: Equilibrium) -> "EquilibriumState":
        """Return the state of a pose that objectives depend on."""
        return posture_of(simulation, pose.nodes, pose.controls, pose.history)


@dataclass(frozen=True, kw_only=True, eq=False)
class StateJacobian:
    """First-order change of the state with the contractions.

    Attributes:
        nodes: d nodes / d contractions.
        elongations: d elongations / d contractions.
        tensions: d tensions / d contractions [N/m].
    """

    nodes: Float[np.ndarray, "nodes dim winches"]
    elongations: Float[np.ndarray, "cables winches"]
    tensions: Float[np.ndarray, "cables winches"]

    @staticmethod
    def at(simulation: Simulation, pose: Equilibrium) -> "StateJacobian":
        """Return sensitivities of a state to contractions: ds/da = B + (dl/dx)^T dx/da, and dT/da = T' ds/da.

        Cables with friction continue to slip as they do, and their tension is that at the winch.

        Raises:
            NotConvergedError: the Hessian is singular: the pose is at a snap-through.
        """
        if simulation.friction is not None:
            stiffness = simulation.stiffness(pose)
            return rubbing_moves(simulation, simulation.friction, EquilibriumState.at(simulation, pose), stiffness)
        cables, nodes = simulation.cables, simulation.jacobian(pose)
        elongations = winch_to_cable_matrix(simulation) + cables.columns(pose.nodes).T @ nodes.reshape(
            pose.nodes.size, -1
        )
        tangents = cables.law.tangent(cables.elongations(pose.nodes, pose.controls))
        return StateJacobian(nodes=nodes, elongations=elongations, tensions=tangents[:, None] * elongations)


class Residual(ABC):
    """Objective on one robot: half the square of a residual in meters.

    `hydrostat.testing.check_objective` tests a residual.
    """

    @abstractmethod
    def residual(self, posture: EquilibriumState) -> Rows:
        """Return the residual that the search minimizes [m], (rows,); the number of rows is the same in every state."""

    @abstractmethod
    def jacobian(self, posture: EquilibriumState, moves: StateJacobian) -> Jacobian:
        """Return d residual / d contractions, (rows, winches)."""

    def errors(self, posture: EquilibriumState) -> Mapping[str, float]:
        """Return the remaining error of each goal, by name [m]. Empty for a term without a goal, such as effort."""
        return {}


class Objective(ABC):
    """Objective for inverse kinematics; `bind` returns its `Residual` for a robot. Pass several as a list."""

    @abstractmethod
    def bind(self, simulation: Simulation) -> Residual:
        """Return the residual on this robot (InputError: it names parts that the robot does not have)."""


def checked_objectives(given: object) -> tuple[Objective, ...]:
    """Objectives in a list (InputError: no list, or something in it that is no objective)."""
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise InputError(f"objectives must be a list, such as [Effort()], not {describe(given)}")
    for wish in given:
        if isinstance(wish, type):
            raise InputError(f"got the class {wish.__name__}. Pass an instance: {wish.__name__}(...)")
        if not isinstance(wish, Objective):
            raise InputError(f"an objective must be one such as MarkerTarget(...) or Effort(), not {describe(wish)}")
    return tuple(given)


def posture_of(
    simulation: Simulation, nodes: Nodes, contractions: Vector, history: Vector | None = None
) -> EquilibriumState:
    """Return the state of nodes at given contractions [m], after a loading path with this `history`."""
    elongations = simulation.cables.elongations(nodes, contractions)
    if simulation.friction is None or history is None:
        tensions = simulation.cables.law.tension(elongations)
    else:
        tensions = simulation.tensions(nodes, contractions, history)
    return EquilibriumState(
        nodes=nodes,
        contractions=contractions,
        elongations=elongations,
        tensions=tensions,
        history=np.zeros(0) if history is None else history,
    )


def full_travels(robot: Robot) -> Vector:
    """Largest contraction of each winch [m], then largest distance of each drive from rest [rad or m]."""
    return np.array([winch.travel for winch in robot.winches] + [max(map(abs, one.limits)) for one in robot.drives])


def winch_to_cable_matrix(simulation: Simulation) -> Float[np.ndarray, "cables winches"]:
    """B: contraction of each cable per meter of its winch's contraction; 0 for other winches, and drives."""
    cables, winches = simulation.cables, np.arange(simulation.robot.num_controls)
    return np.where(cables.winches[:, None] == winches, cables.ratios[:, None], 0.0)


def rubbing_moves(
    simulation: Simulation,
    friction: FrictionCableEnergy,
    posture: EquilibriumState,
    stiffness: FactorizedHessian,
    taut: Int[np.ndarray, " some"] | None = None,
) -> StateJacobian:
    """Return the state Jacobian for cables with friction: points at the capstan limit slip on, the others stick.

    Slack cables among `taut` count as if they had just become taut.
    """
    nodes, contractions = posture.nodes, posture.contractions
    cables = friction.with_history(posture.history[: len(friction.history)], nodes, contractions)
    compliance = stiffness.compliance_to(cables.span_columns(nodes))
    tensions = cables.tension_derivatives(nodes, contractions, compliance, taut)
    moves = -compliance.moves @ tensions
    return StateJacobian(
        nodes=moves.reshape(*nodes.shape, -1),
        elongations=winch_to_cable_matrix(simulation) + simulation.cables.columns(nodes).T @ moves,
        tensions=cables.at_winches(tensions),
    )


def numbers(given: object) -> Float[np.ndarray, "..."] | None:
    """Convert a value to real numbers; None if it is anything else, such as text with a unit."""
    try:
        found = np.asarray(given)
    except (TypeError, ValueError):
        return None
    return found.astype(float) if found.dtype.kind in "iuf" else None


def describe(given: object) -> str:
    """Describe a value in an error of one line: a number, a short text, or its type."""
    found = numbers(given)
    if found is not None and found.ndim == 0:
        return f"{found:g}"
    words = repr(given)
    longest = 60  # as many letters of what is given are told
    if len(words) <= longest and "\n" not in words:
        return words
    kind = type(given).__name__
    return f"{'an' if kind[0] in 'AEIOU' else 'a'} {kind}"


def not_negative(what: str, given: object) -> float:
    """Return a number of 0 or more (InputError: it is anything else)."""
    found = numbers(given)
    if found is None or found.ndim or not 0 <= found < np.inf:
        raise InputError(f"{what} must be 0 or more, not {describe(given)}")
    return float(found)


def above_zero(what: str, given: object, *, unit: str = "") -> float:
    """Return a number above 0, infinity included (InputError: it is anything else)."""
    found = numbers(given)
    if found is None or found.ndim or not found > 0:
        raise InputError(f"{what} must be a number above 0{unit and ' '}{unit}, not {describe(given)}")
    return float(found)


def by_name(what: str, given: object, example: str) -> Mapping[str, Any]:
    """Something for each name (InputError: it is anything else)."""
    if not isinstance(given, Mapping):
        raise InputError(f"{what} must be given by name, such as {example}, not {describe(given)}")
    return given


def place(what: str, given: object, mesh: Mesh, *, held: Bool[np.ndarray, " dim"] | None = None) -> Vector:
    """Place to go for a part of a body at rest [m], which counts along the axes that are held, or along all.

    What is no place, of another dimension, not finite, or so far away that it cannot be in meters, is an InputError.
    """
    found = numbers(given)
    if found is None or found.ndim != 1:
        raise InputError(f"{what} must be {mesh.dim} coordinates [m], not {describe(given)}")
    if len(found) != mesh.dim:
        raise InputError(f"{what} has {len(found)} coordinates, the body {mesh.dim} dimensions")
    if not np.isfinite(found).all():
        raise InputError(f"{what} is not finite: {tuple(found.tolist())}")
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    ways = np.maximum(np.maximum(low - found, found - high), 0.0)
    way = float(np.linalg.norm(ways if held is None else ways[held]))
    farthest = 100.0  # sizes of its body that a target may be away; in millimeters it is a thousand
    if way > farthest * mesh.size:
        raise InputError(
            f"{what} is {way:.4g} m away from a body of {mesh.size:.3g} m. "
            "Check its unit: millimeters in robot.toml, meters in Python"
        )
    return found
