"""`Branch`: the equilibria that hang together while contractions go from one place to another."""

# Of the thesis (docs/thesis.md): E20

from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.result_table import Columns, ResultTable, Tabular
from hydrostat.simulation.equilibrium import Equilibrium
from hydrostat.units import plural


class BranchStatus(StrEnum):
    """Why a branch was followed no further."""

    ARRIVED = "goal reached"
    FOLD = "fold: the robot snaps through"
    BIFURCATION = "bifurcation: the robot buckles to one side"
    BACK = "branch returned to its initial contractions"
    STEP_LIMIT = "step limit reached"
    STUCK = "stalled: minimum step size reached"


class CriticalKind(StrEnum):
    """Kind of critical point, where the Hessian is singular."""

    FOLD = "fold"
    BIFURCATION = "bifurcation"


@dataclass(frozen=True, kw_only=True, eq=False)
class BranchPoint:
    """Equilibrium on a branch.

    Attributes:
        share: share of the way from the first contractions to the goal, 0 to 1.
        pose: equilibrium; `pose.result.stable` distinguishes an energy minimum from a saddle.
    """

    share: float
    pose: Equilibrium

    @property
    def stable(self) -> bool:
        """True if the full Hessian is positive definite."""
        return self.pose.result.stable


@dataclass(frozen=True, kw_only=True)
class CriticalPoint:
    """Point of a branch at which the Hessian is singular.

    Attributes:
        kind: a fold, where the contractions reverse, or a bifurcation, where other branches meet this one.
        share: share of the way from the first contractions to the goal.
        index: index of this point in the points of the branch.
    """

    kind: CriticalKind
    share: float
    index: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch(Tabular):
    """Equilibria along a straight line of contractions.

    Attributes:
        begin: contractions at the start [m], then drive values [rad, m or share].
        goal: contractions and drive values at the intended end.
        points: equilibria in order along the branch.
        critical: folds and bifurcations in the same order.
        status: reason why the branch ends.
    """

    begin: Vector
    goal: Vector
    points: tuple[BranchPoint, ...]
    critical: tuple[CriticalPoint, ...]
    status: BranchStatus

    def __repr__(self) -> str:
        """Return a one-line summary."""
        return f"<Branch of {plural(len(self.points), 'pose')}: {self.status}>"

    def columns(self) -> Columns:
        """Return a table of path share, stability (1 or 0), contractions, markers and tensions, a row for each pose."""
        shares, stable = zip(*((point.share, float(point.stable)) for point in self.points), strict=True)
        columns = {"share": np.array(shares), "stable": np.array(stable)}
        return columns | ResultTable.of(point.pose for point in self.points).columns()

    @property
    def reaches_goal(self) -> bool:
        """True if the branch reaches the goal."""
        return self.status is BranchStatus.ARRIVED

    @property
    def end(self) -> Equilibrium:
        """Last equilibrium of the branch."""
        return self.points[-1].pose

    @property
    def folds(self) -> tuple[float, ...]:
        """Path shares at which the branch reverses."""
        return tuple(point.share for point in self.critical if point.kind is CriticalKind.FOLD)

    def runs(self) -> list[tuple[slice, bool]]:
        """Sections between critical points, these included, with the stability of each section."""
        cuts = sorted({0, *(point.index for point in self.critical), len(self.points) - 1})
        parts = [slice(first, last + 1) for first, last in pairwise(cuts)]
        return [(part, self._stable(part)) for part in parts]

    def _stable(self, part: slice) -> bool:
        """Stability of a part, judged at its middle: at its ends the Hessian is singular."""
        inner = self.points[part][1:-1]
        if not inner:
            return all(point.stable for point in self.points[part])
        return inner[len(inner) // 2].stable

    def lines(self) -> list[str]:
        """Return a report as lines of text."""
        unstable = sum(not point.stable for point in self.points)
        told = f"{len(self.points)} equilibria" + (f", {unstable} of them unstable" if unstable else ", all stable")
        lines = [f"{self.status} at {100 * self.points[-1].share:.1f} % of the path ({told})"]
        for point in self.critical:
            taken = self.begin + point.share * (self.goal - self.begin)
            drives = self.points[0].pose.robot.drives
            count = len(taken) - len(drives)
            where = ", ".join(f"{1e3 * value:.2f}" for value in np.round(taken[:count], 9) + 0.0)
            driven = "".join(
                f", {drive.name} {drive.format_value(value)}"
                for drive, value in zip(drives, taken[count:].tolist(), strict=True)
            )
            lines.append(f"{point.kind} at {100 * point.share:.2f} % of the path (contractions {where} mm{driven})")
        return lines
