"""`Network`: a designed robot with everything that tells how good it is and how it came about."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from hydrostat.arrays import Nodes, Vector
from hydrostat.design.fibres import Fibres
from hydrostat.design.judge import rms_error
from hydrostat.design.region import Route
from hydrostat.ik import ReachedPose
from hydrostat.robot import Pose, Robot


@dataclass(frozen=True, kw_only=True, eq=False)
class Activation:
    """The muscle fibres that bring a body into a pose (R36, R38).

    Attributes:
        target: the pose asked for.
        fibres: all candidate muscles.
        tensions: of each fibre [N], not negative.
        nodes: positions of the nodes in the activated pose [m].
        errors: distance of each targeted marker from its target [m].
    """

    target: Pose
    fibres: Fibres
    tensions: Vector
    nodes: Nodes
    errors: Mapping[str, float]

    @property
    def rms_error(self) -> float:
        """Root of the mean squared distance over the targeted markers [m]."""
        return float(np.sqrt(np.mean(np.square(list(self.errors.values())))))


@dataclass(frozen=True, kw_only=True, eq=False)
class Network:
    """Winches and cables that were designed, and what led to them.

    Attributes:
        robot: the robot with the new network.
        activations: one for each pose (Fig 3.9a).
        candidates: for each pose, the fibres that passed the threshold, strongest first (Fig 3.9b).
        trees: routes that were grown from them [m] (Fig 3.9c).
        reached: what the new network reaches of each pose by its own winches; the true score (E24).
        score: the thesis's score of the network, between 0 and 1 (R43).
        tried: networks that were judged by their poses before this one was chosen.
        seconds: CPU time of the design [s].
    """

    robot: Robot
    activations: tuple[Activation, ...]
    candidates: tuple[Int[np.ndarray, " candidates"], ...]
    trees: tuple[Route, ...]
    reached: tuple[ReachedPose, ...]
    score: float
    tried: int
    seconds: float

    @property
    def rms_error(self) -> float:
        """Root of the mean squared marker error over all poses [m]."""
        return rms_error(self.reached)
