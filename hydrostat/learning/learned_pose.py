"""`LearnedPose`: contractions for a pose, found by networks, and what is known of them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik import IKStatus
from hydrostat.mechanics import Reason
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Equilibrium


class Tier(StrEnum):
    """Source of an answer; each is better, and takes longer, than the one before."""

    NETWORK = "the inverse network"
    SEARCH = "search on the networks"
    STEP = "exact steps"
    EXACT = "inverse kinematics"


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedPose:
    """Contractions that bring markers near targets: what networks say of them, and what the simulator says.

    Attributes:
        target: requested target.
        tier: source of the answer.
        contractions: cable taken in [m], in the order of the model's winches.
        commands: the same by winch.
        markers: predicted position of each marker [m].
        tensions: predicted tension of each cable [N].
        errors: predicted distance of each requested marker from its target [m].
        spread: disagreement of the networks, root of the mean square [m]: their uncertainty.
        certified: distance of each from its target in the simulator [m]; None without a check.
        reason: why the simulator ended: of an equilibrium, or, for `Tier.EXACT`, of inverse kinematics.
        pose: the equilibrium; None where there is none.
    """

    target: PoseTarget
    tier: Tier
    contractions: Vector
    commands: Mapping[str, float]
    markers: Mapping[str, np.ndarray]
    tensions: Mapping[str, float]
    errors: Mapping[str, float]
    spread: Mapping[str, float]
    certified: Mapping[str, float] | None = None
    reason: Reason | IKStatus | None = None
    pose: Equilibrium | None = None

    def __repr__(self) -> str:
        """Return a description of one line."""
        sort = "expected" if self.certified is None else "certified"
        return f"<LearnedPose for {self.target.name!r} by {self.tier}: {1e3 * self.error:.3g} mm {sort} on average>"

    @property
    def error(self) -> float:
        """Mean distance of the markers from their targets [m]: certified where it is, else expected."""
        return float(np.mean(list((self.errors if self.certified is None else self.certified).values())))

    @property
    def uncertainty(self) -> float:
        """Mean spread of the markers that were asked for [m]."""
        return float(np.mean(list(self.spread.values())))

    def without_factors(self) -> "LearnedPose":
        """The same with a pose that keeps no factorised Hessian, to be kept with many others."""
        return replace(self, pose=None if self.pose is None else self.pose.without_factors())
