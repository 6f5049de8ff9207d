"""`SolvedPose`: a robot in quasi-static equilibrium under given contractions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from hydrostat.arrays import Nodes, Points, Vector
from hydrostat.errors import InputError
from hydrostat.geometry.crossings import find_crossings
from hydrostat.geometry.mesh import Mesh
from hydrostat.mechanics import NewtonResult
from hydrostat.robot import Robot

Contractions = Mapping[str, float] | Vector
"""Cable taken in [m]: by the name of a winch (others 0), or an array in winch order."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedPose:
    """An equilibrium.

    Attributes:
        contractions: cable taken in by each winch [m], in winch order.
        nodes: positions of the nodes [m].
        markers: position of each marker [m].
        tensions: of each cable [N], in cable order.
        energy: total energy [J].
        result: how the solver ended: reason, residual [N], iterations, stability; and the factorised Hessian there.
        history: what the physics remember of the way there: how much cable has slipped over each point with friction
            until now, where obstacles with friction hold the skin [m]; empty without friction.
        carried: unknowns of obstacles that move [m]: place and axes of each; empty if none does.
    """

    contractions: Vector
    nodes: Nodes
    markers: Mapping[str, Vector]
    tensions: Vector
    energy: float
    result: NewtonResult
    history: Vector = field(default_factory=lambda: np.zeros(0))
    carried: Points | None = None

    @property
    def unknowns(self) -> Nodes:
        """All that energies are functions of [m]: the nodes, then the rows of obstacles that move."""
        return self.nodes if self.carried is None else np.concatenate([self.nodes, self.carried])

    @property
    def moved_by_none(self) -> bool:
        """Whether its nodes are the very ones that the solver found."""
        return self.result.nodes is (self.nodes if self.carried is None else self.nodes.base)

    def without_factors(self) -> "SolvedPose":
        """Pose without its factorised Hessian, to be kept with many others: that takes megabytes."""
        return replace(self, result=replace(self.result, stiffness=None))


def largest_distance(one: Nodes, other: Nodes) -> float:
    """Largest distance of a node between two poses [m]."""
    return float(np.linalg.norm(one - other, axis=1).max())


def check_apart(mesh: Mesh, nodes: Nodes) -> None:
    """Check that a body whose parts cannot pass through each other does not do so where a solve is to begin.

    Raises:
        InputError: it does; with a place.
    """
    if words := str(find_crossings(mesh, nodes)):
        raise InputError(f"no solve can begin there: {words.partition(':')[0]}")


def check_pose(pose: object, shape: tuple[int, ...], winches: int, history: Vector | None) -> None:
    """Check that a solve can begin from a pose.

    Args:
        pose: what was given.
        shape: of the robot's nodes.
        winches: their number.
        history: of physics that remember the way there; None if none do.

    Raises:
        InputError: it is no pose, one of another robot, not finite, or without slips where cables rub.
    """
    if not isinstance(pose, SolvedPose):
        kind = type(pose).__name__
        raise InputError(f"start must be a solved pose, from `simulation.solve` or a result's `.pose`, not {kind}")
    if not (pose.nodes.shape == shape and np.isfinite(pose.nodes).all()):
        raise InputError(f"start must be a pose of this robot with finite nodes, {shape}, not {pose.nodes.shape}")
    given = len(pose.contractions)
    if given != winches:
        raise InputError(f"start has {given} contractions, the robot {winches} winches")
    if history is not None and len(pose.history) != len(history):
        raise InputError(
            "start must be a pose of these physics, which remember the way, such as slips of cables with friction: "
            f"{len(history)} numbers, not {len(pose.history)}"
        )


def contraction_values(robot: Robot, given: Contractions) -> Vector:
    """Contractions as an array in winch order [m].

    Raises:
        InputError: an unknown winch, a wrong number of values, or a value that is not finite.
    """
    winches, wanted = robot.winches, given
    if isinstance(given, Mapping):
        for name in given:
            robot.winch(name)
        wanted = np.array([given.get(winch.name, 0.0) for winch in winches], dtype=object)
    try:
        values = np.array(wanted, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"contractions must be numbers [m], not {given!r}") from None
    if values.shape != (len(winches),):
        raise InputError(f"{values.size} contractions given for {len(winches)} winches")
    if not np.isfinite(values).all():
        raise InputError("a contraction is not a finite number")
    return values
