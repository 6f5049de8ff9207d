"""`IKResult`: result of inverse kinematics for one pose."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from hydrostat.errors import InputError
from hydrostat.painters import draw_record, html_repr
from hydrostat.result_table import Columns, Tabular
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Equilibrium


class IKStatus(StrEnum):
    """Reason for the end of an inverse-kinematics search."""

    REACHED = "target reached"
    LOCAL_OPTIMUM = "local optimum"
    STALLED = "stalled: line search failed before convergence"
    INFEASIBLE = "infeasible: no pose found within the tension limits"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    NO_EQUILIBRIUM = "no equilibrium found on the way"


REACHED_TOLERANCE = 3e-3
"""Distance from its target, as a share of the body's size, within which each goal counts as reached in words."""


@dataclass(frozen=True, kw_only=True, eq=False)
class IKResult(Tabular):
    """Result of inverse kinematics: the best pose found within the limits.

    Attributes:
        target: requested marker targets; None if only objectives were given.
        pose: equilibrium found; its `contractions` are the solution.
        errors: remaining error of each goal, such as the distance of a marker from its target [m].
        status: reason why the search ended.
        iterations: number of Gauss-Newton steps taken.
        solves: number of solved equilibria.
        optimality: largest admissible decrease of the residual norm per meter of one channel's contraction [m/m]; near
            0 at an optimum, but not if the target is reached.
        active_limits: limits that keep the pose from coming closer to the target.
        friction_hysteresis: distance of each marker from its position when the same contractions are reached from a
            tenth above [m]; empty without friction, in results of a `Tracker`, or if that path cannot be followed.
    """

    target: PoseTarget | None
    pose: Equilibrium
    errors: Mapping[str, float]
    status: IKStatus
    iterations: int
    solves: int
    optimality: float = 0.0
    active_limits: tuple[str, ...] = ()
    friction_hysteresis: Mapping[str, float] = field(default_factory=dict)

    def columns(self) -> Columns:
        """Return a table of the pose, and the error of each marker."""
        errors = {f"error_{name}_m": np.array([float(error)]) for name, error in self.errors.items()}
        return {**self.pose.columns(), **errors}

    def without_factors(self) -> "IKResult":
        """Return the same result without the factorized Hessian of its pose, to keep many results in memory."""
        return replace(self, pose=self.pose.without_factors())

    @property
    def is_close(self) -> bool:
        """True if every goal is within 0.3 % of the body's size of its target."""
        return max(self.errors.values(), default=0.0) <= REACHED_TOLERANCE * self.pose.robot.body.mesh.size

    @property
    def outcome(self) -> str:
        """Reason for the end of the search, as text; for an optimum close to its targets, with the distance."""
        if self.status is not IKStatus.LOCAL_OPTIMUM or not self.errors:
            return str(self.status)
        if not self.is_close:
            return f"{self.status}: target not reached"
        return f"reached within {_round_up(1e3 * max(self.errors.values())):g} mm"

    def __repr__(self) -> str:
        """Return a one-line summary."""
        goal = "objectives" if self.target is None else repr(self.target.name)
        return f"<IKResult for {goal}: rms error {1e3 * self.rms_error:.3g} mm; {self.outcome}; {self.pose!r}>"

    def _repr_html_(self) -> str:
        """Summary, warnings and a picture, for a notebook."""
        words = "\n".join([repr(self), *self.active_limits, *self.pose.warnings])
        return html_repr(words, draw_record("reached", self.pose.robot, self))

    @property
    def pose_target(self) -> PoseTarget:
        """Targets of the markers (InputError: only objectives were given)."""
        if self.target is None:
            raise InputError("this was asked for by objectives alone, there is no pose of targets")
        return self.target

    @property
    def rms_error(self) -> float:
        """Root-mean-square error over the goals [m]."""
        return float(np.sqrt(np.mean(np.square(list(self.errors.values()))))) if self.errors else 0.0


def _round_up(length: float) -> float:
    """A length above 0 with one significant digit, not below what it is."""
    step = 10.0 ** math.floor(math.log10(length))
    return float(f"{math.ceil(length / step - 1e-9) * step:.1g}")
