"""`ReachedPose`: what inverse kinematics found for one pose."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from hydrostat.errors import InputError
from hydrostat.painters import draw_record
from hydrostat.robot import Pose, html_repr
from hydrostat.simulation import SolvedPose


class InverseReason(StrEnum):
    """Why inverse kinematics ended."""

    REACHED = "every goal is reached"
    OPTIMAL = "as near as these winches come hereabouts"
    STUCK = "no step brings it nearer, though there is more to gain"
    TOO_TIGHT = "no pose found that keeps the limits on tension"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    NO_EQUILIBRIUM = "no equilibrium could be found on the way"


@dataclass(frozen=True, kw_only=True, eq=False)
class ReachedPose:
    """The best pose that the winches can make.

    Attributes:
        target: what was asked for; None if only objectives were.
        pose: the equilibrium found; its `contractions` are the answer.
        errors: what is left of each goal, such as the distance of a marker from its target [m].
        reason: why the search ended.
        iterations: Gauss-Newton steps taken.
        solves: equilibria approached.
        optimality: how much the length of the residual would still fall for each metre that one channel moves, as far
            as it may [m/m]; near 0 at an optimum, but not where a pose is reached.
        held: the limits that keep it from coming nearer, in words.
        friction_band: how far each marker is from where the same contractions leave it when they are come to from a
            tenth above [m]; empty without friction, in answers of a `Tracker`, and where that way cannot be followed.
    """

    target: Pose | None
    pose: SolvedPose
    errors: Mapping[str, float]
    reason: InverseReason
    iterations: int
    solves: int
    optimality: float = 0.0
    held: tuple[str, ...] = ()
    friction_band: Mapping[str, float] = field(default_factory=dict)

    def without_factors(self) -> "ReachedPose":
        """The same with a pose that keeps no factorised Hessian, to be kept with many others."""
        return replace(self, pose=self.pose.without_factors())

    def __repr__(self) -> str:
        """What it is, in one line."""
        goal = "objectives" if self.target is None else repr(self.target.name)
        return f"<ReachedPose for {goal}: rms error {1e3 * self.rms_error:.3g} mm; {self.reason}; {self.pose!r}>"

    def _repr_html_(self) -> str:
        """The line, what is to be minded, and a picture, for a notebook."""
        words = "\n".join([repr(self), *self.held, *self.pose.notes])
        return html_repr(words, draw_record("reached", self.pose.robot, self))

    @property
    def wanted(self) -> Pose:
        """The targets of the markers (InputError: only objectives were asked for)."""
        if self.target is None:
            raise InputError("this was asked for by objectives alone, there is no pose of targets")
        return self.target

    @property
    def rms_error(self) -> float:
        """Root of the mean squared error over the goals [m]."""
        return float(np.sqrt(np.mean(np.square(list(self.errors.values()))))) if self.errors else 0.0
