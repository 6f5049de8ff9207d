"""`Objective`: the contract of every term of what inverse kinematics minimises."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.ik.checks import describe
from hydrostat.simulation import Simulation

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
