"""`continue_branch`: numerical continuation (pseudo-arclength) of equilibria, without a jump to others (E20)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.mechanics import NewtonResult, NewtonStatus
from hydrostat.simulation.branches.bordered import Bordered, PathPoint, Tangent
from hydrostat.simulation.branches.branch import Branch, BranchPoint, BranchStatus, CriticalKind, CriticalPoint
from hydrostat.simulation.controls import split_controls
from hydrostat.simulation.equilibrium import Equilibrium, check_pose
from hydrostat.simulation.simulation import Contractions, Simulation
from hydrostat.simulation.static_obstacles import require_static_obstacles


@dataclass(frozen=True, kw_only=True)
class BranchOptions:
    """Step and accuracy options of branch continuation.

    A step is measured along the branch: by the share of the way, and by the root mean square displacement of the nodes
    as a share of the body's size.

    Of the critical points within one step at most one is seen; shorter steps see more.

    Attributes:
        first_step: length of the first step.
        largest_step: maximum step length.
        smallest_step: minimum step length; a shorter step is not tried.
        steps: maximum number of steps.
        distance: largest distance of a node from its predicted position to the equilibrium, as a share of the body's
            size and of the step: 0.1 in a step of 0.02 lets no jump of more than 0.2 % of the body pass.
        iterations: maximum number of Newton iterations in a step; a few suffice near the branch, and no other branch is
            near.
        turn: minimum cosine of the angle between the directions of the branch before and after a step.

    Raises:
        InputError: a length, a count or a distance that is not above 0, or a turn that is no cosine below 1.
    """

    first_step: float = 0.01
    largest_step: float = 0.02
    smallest_step: float = 1e-7
    steps: int = 2000
    distance: float = 0.1
    iterations: int = 5
    turn: float = 0.8

    def __post_init__(self) -> None:
        """Check that all options are within their ranges."""
        for name in ("first_step", "largest_step", "smallest_step", "steps", "distance", "iterations"):
            value = getattr(self, name)
            if not 0 < value < np.inf:
                raise InputError(
                    f"{name} must be finite and above 0, not {value:g}; {getattr(type(self), name):g} is usual"
                )
        if not -1.0 <= self.turn < 1.0:
            raise InputError(f"turn must be a cosine, at least -1 and below 1, not {self.turn:g}; 0.8 is usual")


def continue_branch(
    simulation: Simulation,
    start: Equilibrium,
    contractions: Contractions,
    *,
    around_folds: bool = False,
    options: BranchOptions | None = None,
) -> Branch:
    """Follow a branch of equilibria from a pose to other contractions along a straight line, by numerical continuation.

    Unlike `Simulation.solve` it never jumps to another branch: it uses pseudo-arclength continuation (Keller 1977),
    with the predictor dx/da and steps that are shortened until the equilibrium is close to the prediction.

    Args:
        simulation: simulation of the robot.
        start: start equilibrium, stable or not.
        contractions: contractions and drive values at the end of the branch [m].
        around_folds: True to follow the unstable part after a loss of stability; False to end the branch there.
        options: step lengths.

    Raises:
        InputError: a start that is not an equilibrium, contractions that do not fit, or cables with friction.
    """
    goal = simulation.as_contractions(contractions)
    if simulation.assembly.has_history:
        raise InputError(
            "with friction or hysteresis equilibria are no branch, for every way ends elsewhere; remove it to follow "
            "one, or compare ways by hs.find_equilibria"
        )
    require_static_obstacles(simulation.robot, "a branch of equilibria")
    rest = simulation.robot.body.mesh.nodes
    check_pose(start, rest.shape, len(goal))
    return _Follower(simulation, start, goal, around_folds, options or BranchOptions()).run()


class _Follower:
    """One branch; `run` is the loop, each method one part of it."""

    def __init__(
        self, simulation: Simulation, start: Equilibrium, goal: Vector, around: bool, options: BranchOptions
    ) -> None:
        self.simulation, self.start, self.goal = simulation, start, goal
        self.around, self.options = around, options
        self.system = Bordered(simulation, start.controls, goal)
        self.points: list[BranchPoint] = []
        self.critical: list[CriticalPoint] = []

    def run(self) -> Branch:
        """Steps until the branch ends."""
        place = self._begin(self.start.nodes)
        self._keep(place)
        step = self.options.first_step
        status = BranchStatus.STEP_LIMIT
        if (self.start.controls == self.goal).all():
            return self._branch(BranchStatus.ARRIVED)
        for _ in range(self.options.steps):
            trial = self._step(place, step)
            if trial is None:
                step *= 0.5
                if step < self.options.smallest_step:
                    status = BranchStatus.STUCK
                    break
                continue
            ended = self._advance(place, trial, step)
            if ended is not None:
                status = ended
                break
            place, step = trial, self._next_step(trial, step)
        return self._branch(status)

    def _begin(self, nodes: Nodes) -> PathPoint:
        """Start as a place on the branch, in the direction of growing share."""
        still = Tangent(np.zeros(nodes.size), 1.0)
        place = self.system.correct(nodes, 0.0, still)
        same = 1e-5  # A start this near to an equilibrium, as a share of the body's size, is one
        if place is None or not place.distance < same:
            raise InputError("start must be an equilibrium at its own contractions; solve for it first")
        return place if place.tangent.rate > 0 else place.reverse_direction()

    def _step(self, place: PathPoint, step: float) -> PathPoint | None:
        """Equilibrium one step on; None if it is not where it was predicted."""
        trial = self._raw_step(place, step)
        if trial is None or self.system.dot(place.tangent, trial.tangent) < self.options.turn:
            return None
        return trial

    def _raw_step(self, place: PathPoint, step: float) -> PathPoint | None:
        nodes = self.system.bend(place.nodes, step * place.tangent.move)
        share = place.share + step * place.tangent.rate
        reach, iterations = self.options.distance * step, self.options.iterations
        return self.system.correct(nodes, share, place.tangent, reach=reach, iterations=iterations)

    def _next_step(self, trial: PathPoint, step: float) -> float:
        """Longer where the branch is straight, shorter where it bends."""
        bent = trial.distance / (self.options.distance * step)
        return min(step * float(np.clip(np.sqrt(0.3 / max(bent, 1e-9)), 0.4, 2.0)), self.options.largest_step)

    def _advance(self, place: PathPoint, trial: PathPoint, step: float) -> BranchStatus | None:
        """Keep what is found between two places, and the second one; a reason if the branch ends."""
        found = self._find_critical(place, trial, step)
        if found is not None:
            kind, there = found
            if not 0.0 <= there.share <= 1.0:
                return self._land(place, there)
            self._mark(kind, there)
            if not self.around:
                return BranchStatus[kind.name]
            place = there
        if not 0.0 <= trial.share <= 1.0:
            return self._land(place, trial)
        self._keep(trial)
        return None

    def _land(self, place: PathPoint, beyond: PathPoint) -> BranchStatus:
        """End the branch at the share that lies between two places, 0 or 1."""
        share = 1.0 if beyond.share > 1.0 else 0.0
        part = (share - place.share) / (beyond.share - place.share)
        if abs(place.tangent.rate) < _FOLD_RATIO * abs(beyond.tangent.rate):
            part = np.sqrt(part)
        guess = place.nodes + part * (beyond.nodes - place.nodes)
        still = Tangent(np.zeros(guess.size), 1.0)
        reach = self.system.farthest(beyond.nodes - place.nodes, beyond.share - place.share)
        landed = self.system.correct(guess, share, still, reach=reach, before=place.tangent)
        if landed is None:
            return BranchStatus.STUCK
        self._keep(landed)
        return BranchStatus.ARRIVED if share == 1.0 else BranchStatus.BACK

    def _find_critical(self, place: PathPoint, trial: PathPoint, step: float) -> tuple[CriticalKind, PathPoint] | None:
        """Fold where the share turns back, else a bifurcation where stability changes."""
        if place.tangent.rate * trial.tangent.rate < 0:
            return CriticalKind.FOLD, self._find_fold(place, trial, step)
        if place.stiffness.definite != trial.stiffness.definite:
            return CriticalKind.BIFURCATION, self._find_change(place, trial, step)
        return None

    def _find_fold(self, place: PathPoint, trial: PathPoint, step: float) -> PathPoint:
        """Return the point where d share / d length is 0, by Brent's method."""
        from scipy.optimize import brentq  # Imported here: not every command needs it.

        known = {0.0: place, step: trial}

        def rate(length: float) -> float:
            known[length] = known.get(length) or self._raw_step(place, length) or trial
            return known[length].tangent.rate

        brentq(rate, 0.0, step, xtol=_CRITICAL_TOLERANCE * step, maxiter=60)
        return min(known.values(), key=lambda found: abs(found.tangent.rate))

    def _find_change(self, place: PathPoint, trial: PathPoint, step: float) -> PathPoint:
        """Return the point where the definiteness of the Hessian changes, by bisection."""
        low, high, there = 0.0, step, trial
        while high - low > _CRITICAL_TOLERANCE * step:
            middle = 0.5 * (low + high)
            found = self._raw_step(place, middle)
            if found is None or found.stiffness.definite != place.stiffness.definite:
                high, there = middle, found or there
            else:
                low = middle
        return there

    def _mark(self, kind: CriticalKind, place: PathPoint) -> None:
        self.critical.append(CriticalPoint(kind=kind, share=float(place.share), index=len(self.points)))
        self._keep(place)

    def _keep(self, place: PathPoint) -> None:
        self.points.append(
            BranchPoint(share=float(place.share), pose=_solve_at(self.simulation, self.system.controls, place))
        )

    def _branch(self, status: BranchStatus) -> Branch:
        return Branch(
            begin=self.start.controls,
            goal=self.goal,
            points=tuple(self.points),
            critical=tuple(self.critical),
            status=status,
        )


def _solve_at(simulation: Simulation, controls: Callable[[float], Vector], place: PathPoint) -> Equilibrium:
    """Place on a branch as a pose like any other."""
    contractions = controls(place.share)
    positions = simulation.marker_anchors.positions(place.nodes)
    energy = simulation.assembly.value(place.nodes, contractions)
    return Equilibrium(
        robot=simulation.robot,
        **split_controls(simulation.robot, contractions),
        nodes=place.nodes,
        markers={marker.name: at for marker, at in zip(simulation.robot.markers, positions, strict=True)},
        tensions=simulation.tensions(place.nodes, contractions),
        energy=energy,
        result=NewtonResult(
            nodes=place.nodes,
            status=NewtonStatus.CONVERGED,
            residual=place.residual,
            allowed=place.allowed,
            energy=energy,
            iterations=place.iterations,
            stable=place.stiffness.definite,
            buckled=False,
            stiffness=None,
        ),
    )


_FOLD_RATIO = 0.1
"""Ratio of the rates of the share at two points below which the first is a fold: the share is quadratic there."""

_CRITICAL_TOLERANCE = 1e-7
"""Critical points are found to this share of a step."""
