"""`solve_ik`: the contractions that bring the markers nearest to a pose."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Nodes, Vector
from hydrostat.errors import InputError
from hydrostat.geometry.anchors import locate
from hydrostat.ik.reached_pose import InverseReason, ReachedPose
from hydrostat.robot import Point, Pose
from hydrostat.simulation import Simulation, SolvedPose


@dataclass(frozen=True, kw_only=True)
class InverseOptions:
    """How inverse kinematics searches (M7).

    Attributes:
        effort: marker error, as a fraction of the body's size, that full travel of one winch is worth: a small
            regulariser that keeps idle winches at rest (E18).
        tolerance: marker error, as a fraction of the body's size, at which a pose counts as reached.
        progress: the search ends when a step lowers the objective, or promises to, by less than this fraction.
        iterations: most Gauss-Newton steps.
        first_step: largest change of a contraction in the first step, as a fraction of the winch's whole range.
    """

    effort: float = 1e-3
    tolerance: float = 1e-6
    progress: float = 1e-6
    iterations: int = 60
    first_step: float = 0.3


def solve_ik(
    simulation: Simulation,
    targets: Pose | Mapping[str, Point],
    *,
    start: SolvedPose | None = None,
    options: InverseOptions | None = None,
) -> ReachedPose:
    """Bounded Gauss-Newton on the marker errors, through the sensitivities of the equilibrium (R31 to R33, E18).

    Contractions stay between -release and travel of each winch. A slack cable has no sensitivity, so before every
    step it is taken in to the edge of taut, where it can be recruited (E15). The answer is the best equilibrium seen.

    Args:
        simulation: the robot's physics.
        targets: where markers should go [m].
        start: a pose to begin from; the rest pose if left out.
        options: tolerances and limits.

    Raises:
        InputError: a marker that does not exist, or a robot without winches.
    """
    pose = targets if isinstance(targets, Pose) else Pose(name="target", targets=dict(targets))
    return _Search(simulation, pose, options or InverseOptions()).run(start)


class _Search:
    """One run: the problem's constants, and the counts."""

    def __init__(self, simulation: Simulation, target: Pose, options: InverseOptions) -> None:
        robot = simulation.robot
        if not robot.cables:
            raise InputError(
                "the robot has no cables to pull; add winches and cables, or let `hydrostat design` find them"
            )
        self.simulation, self.target, self.options = simulation, target, options
        self.low = np.array([-winch.release for winch in robot.winches])
        self.high = np.array([winch.travel for winch in robot.winches])
        self.anchors = locate(robot.body.mesh, np.array([_marker_place(simulation, name) for name in target.targets]))
        self.goals = np.array(list(target.targets.values()), dtype=float)
        size = robot.body.mesh.size
        self.reached = options.tolerance * size
        self.effort = options.effort * size / self.high
        self.solves = 0

    def run(self, start: SolvedPose | None) -> ReachedPose:
        """Steps until nothing is left to gain."""
        best = start or self._solve(np.clip(np.zeros_like(self.high), self.low, self.high), None)
        if best is None:
            raise AssertionError("the rest pose is an equilibrium")
        radius = self.options.first_step
        for iteration in range(self.options.iterations):
            if self._errors(best.nodes).max() <= self.reached:
                return self._done(best, InverseReason.REACHED, iteration)
            taut = self._taut(best)
            step, promise = self._step(taut, radius)
            gain_wanted = self.options.progress * self._objective(best)
            if self._objective(best) - (self._objective(taut) - promise) <= gain_wanted:
                return self._done(best, InverseReason.OPTIMAL, iteration)
            trial = self._solve(taut.contractions + step, taut)
            ratio = -np.inf if trial is None else (self._objective(taut) - self._objective(trial)) / promise
            radius = _next_radius(radius, ratio, np.abs(step / (self.high - self.low)).max())
            gained = 0.0 if trial is None else self._objective(best) - self._objective(trial)
            if trial is not None and gained > 0:
                best = trial
            if gained <= gain_wanted and ratio > 0.25:
                return self._done(best, InverseReason.OPTIMAL, iteration + 1)
            if radius < 1e-6:
                reason = InverseReason.NO_EQUILIBRIUM if trial is None else InverseReason.OPTIMAL
                return self._done(best, reason, iteration + 1)
        return self._done(best, InverseReason.ITERATION_LIMIT, self.options.iterations)

    def _solve(self, contractions: Vector, start: SolvedPose | None) -> SolvedPose | None:
        self.solves += 1
        solved = self.simulation.solve(contractions, start=start, strict=False)
        return solved if solved.result.converged else None

    def _taut(self, pose: SolvedPose) -> SolvedPose:
        """The pose with every winch taken in until the first of its cables begins to pull."""
        contractions = pose.contractions.copy()
        for index in range(len(contractions)):
            own = [cable for cable in self.simulation.cables if cable.control == index]
            gaps = [cable.law.smoothing - cable.stretch(pose.nodes, pose.contractions) for cable in own]
            contractions[index] += max(min(gaps, default=0.0), 0.0)
        contractions = np.clip(contractions, self.low, self.high)
        if (contractions == pose.contractions).all():
            return pose
        return self._solve(contractions, pose) or pose

    def _step(self, pose: SolvedPose, radius: float) -> tuple[Vector, float]:
        """Best bounded step of the linearised problem, and by how much it promises to lower the objective."""
        from scipy.optimize import lsq_linear

        moves = self.simulation.jacobian(pose)
        jacobian = np.einsum("pc,pcdw->pdw", self.anchors.weights, moves[self.anchors.stencils])
        matrix = np.vstack([jacobian.reshape(-1, len(self.high)), np.diag(self.effort)])
        residual = self._residual(pose)
        reach = radius * (self.high - self.low)
        low = np.maximum.reduce([self.low - pose.contractions, -reach, -self._until_slack(pose, moves)])
        high = np.minimum(self.high - pose.contractions, reach)
        free = high > low
        step = np.zeros_like(low)
        step[free] = lsq_linear(matrix[:, free], -residual, (low[free], high[free]), method="bvls").x
        after = residual + matrix @ step
        return step, float(residual @ residual - after @ after) / 2

    def _until_slack(self, pose: SolvedPose, moves: Float[np.ndarray, "nodes dim winches"]) -> Vector:
        """How far each winch can let out before its last cable is slack, to first order [m]: a cable cannot push."""
        reach = np.zeros_like(self.low)
        for cable in self.simulation.cables:
            stretch = cable.stretch(pose.nodes, pose.contractions)
            tangent = cable.law.tangent(stretch)
            if tangent > 0:
                rate = 1.0 + float(np.sum(cable.length_gradient(pose.nodes) * moves[cable.stencils[0], :, cable.control]))
                until = cable.law.tension(stretch) / tangent / max(rate, 1e-6)
                reach[cable.control] = max(reach[cable.control], until)
        return reach

    def _residual(self, pose: SolvedPose) -> Float[np.ndarray, " rows"]:
        """Marker errors, then effort, all [m]."""
        offsets = self.anchors.positions(pose.nodes) - self.goals
        return np.concatenate([offsets.ravel(), self.effort * pose.contractions])

    def _objective(self, pose: SolvedPose) -> float:
        residual = self._residual(pose)
        return float(residual @ residual) / 2

    def _errors(self, nodes: Nodes) -> Float[np.ndarray, " markers"]:
        return np.linalg.norm(self.anchors.positions(nodes) - self.goals, axis=1)

    def _done(self, pose: SolvedPose, reason: InverseReason, iterations: int) -> ReachedPose:
        errors = self._errors(pose.nodes)
        if errors.max() <= self.reached:
            reason = InverseReason.REACHED
        return ReachedPose(
            target=self.target,
            pose=pose,
            errors={name: float(error) for name, error in zip(self.target.targets, errors, strict=True)},
            reason=reason,
            iterations=iterations,
            solves=self.solves,
        )


def _next_radius(radius: float, ratio: float, used: float) -> float:
    """Trust radius after a step that gained `ratio` times what it promised and used `used` of the range."""
    if ratio < 0.25:
        return 0.25 * min(radius, used)
    return min(2 * radius, 1.0) if ratio > 0.75 and used > 0.9 * radius else radius


def _marker_place(simulation: Simulation, name: str) -> Point:
    markers = {marker.name: marker.at for marker in simulation.robot.markers}
    if name not in markers:
        known = f"its markers are: {', '.join(markers)}" if markers else "it has no markers"
        raise InputError(f'the robot has no marker "{name}"; {known}')
    return markers[name]
