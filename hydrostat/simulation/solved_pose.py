"""`SolvedPose`: a robot in quasi-static equilibrium under given contractions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.mechanics import NewtonResult


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
            until now [m]; empty without friction.
    """

    contractions: Vector
    nodes: Nodes
    markers: Mapping[str, Vector]
    tensions: Vector
    energy: float
    result: NewtonResult
    history: Vector = field(default_factory=lambda: np.zeros(0))

    def without_factors(self) -> "SolvedPose":
        """Pose without its factorised Hessian, to be kept with many others: that takes megabytes."""
        return replace(self, result=replace(self.result, stiffness=None))


def largest_distance(one: Nodes, other: Nodes) -> float:
    """Largest distance of a node between two poses [m]."""
    return float(np.linalg.norm(one - other, axis=1).max())
