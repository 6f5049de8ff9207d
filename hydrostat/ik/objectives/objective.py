"""`Objective`: the contract of every term of what inverse kinematics minimises."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.ik.checks import describe
from hydrostat.simulation import Simulation, SolvedPose

Rows = Float[np.ndarray, " rows"]
Slopes = Float[np.ndarray, "rows winches"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Posture:
    """What an objective may look at: a robot at rest under given contractions.

    Attributes:
        nodes: positions [m].
        contractions: of each winch [m].
        elongations: how much longer each cable is than it should be [m]; negative when slack.
        tensions: of each cable [N].
    """

    nodes: Nodes
    contractions: Vector
    elongations: Vector
    tensions: Vector


@dataclass(frozen=True, kw_only=True, eq=False)
class Moves:
    """How a posture changes with the contractions, to first order.

    Attributes:
        nodes: d nodes / d contractions.
        elongations: d elongations / d contractions.
        tensions: d tensions / d contractions [N/m].
    """

    nodes: Float[np.ndarray, "nodes dim winches"]
    elongations: Float[np.ndarray, "cables winches"]
    tensions: Float[np.ndarray, "cables winches"]


class Term(ABC):
    """An objective on one robot: 1/2 |residual|^2, a residual in metres.

    `hydrostat.testing.check_objective` tells whether a term is right.
    """

    @abstractmethod
    def residual(self, posture: Posture) -> Rows:
        """What should become zero [m], (rows,); as many rows in every posture."""

    @abstractmethod
    def slopes(self, posture: Posture, moves: Moves) -> Slopes:
        """D residual / d contractions, (rows, winches)."""

    def errors(self, posture: Posture) -> Mapping[str, float]:
        """What is left to reach, by name [m]. Empty for a term that only weighs one pose against another, as effort."""
        return {}


class Objective(ABC):
    """A wish, as data; `on` a robot it becomes a `Term`. Parts plug in by list: `solve_ik(..., objectives=[...])`."""

    @abstractmethod
    def on(self, simulation: Simulation) -> Term:
        """The wish on this robot.

        Raises:
            InputError: it names what the robot does not have.
        """


def checked_objectives(given: object) -> tuple[Objective, ...]:
    """Objectives in a list.

    Raises:
        InputError: no list, or something in it that is no objective.
    """
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise InputError(f"objectives must be a list, such as [Effort()], not {describe(given)}")
    for wish in given:
        if isinstance(wish, type):
            raise InputError(f"an objective is wanted, not its class; write {wish.__name__}(...)")
        if not isinstance(wish, Objective):
            raise InputError(f"an objective must be one such as MarkerGoal(...) or Effort(), not {describe(wish)}")
    return tuple(given)


def posture_at(simulation: Simulation, pose: SolvedPose) -> Posture:
    """What an objective may look at in a pose."""
    return posture_of(simulation, pose.nodes, pose.contractions)


def posture_of(simulation: Simulation, nodes: Nodes, contractions: Vector) -> Posture:
    """The same of nodes at some contractions [m]."""
    elongations = simulation.cables.elongations(nodes, contractions)
    tensions = simulation.cables.law.tension(elongations)
    return Posture(nodes=nodes, contractions=contractions, elongations=elongations, tensions=tensions)


def follows(simulation: Simulation) -> Float[np.ndarray, "cables winches"]:
    """B: what a cable takes in when its winch takes in 1 m; 0 for other winches."""
    cables, winches = simulation.cables, np.arange(len(simulation.robot.winches))
    return np.where(cables.winches[:, None] == winches, cables.ratios[:, None], 0.0)


def moves_at(simulation: Simulation, pose: SolvedPose) -> Moves:
    """Derivatives of that posture: ds/da = B + (dl/dx)^T dx/da, and dT/da = T' ds/da (R33).

    Cables that rub are not covered: their tension differs along the cable.

    Raises:
        NotConvergedError: the pose is about to snap, its Hessian is singular.
    """
    cables, nodes = simulation.cables, simulation.jacobian(pose)
    elongations = follows(simulation) + cables.columns(pose.nodes).T @ nodes.reshape(pose.nodes.size, -1)
    tangents = cables.law.tangent(cables.elongations(pose.nodes, pose.contractions))
    return Moves(nodes=nodes, elongations=elongations, tensions=tangents[:, None] * elongations)
