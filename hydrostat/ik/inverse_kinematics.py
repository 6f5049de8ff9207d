"""`solve_ik`: the contractions that bring a robot nearest to a pose, by descents from several beginnings."""
# Of the thesis (docs/thesis.md): R31 to R33, E18

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count, islice

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.errors import InputError, NotConvergedError
from hydrostat.given import check_type
from hydrostat.ik.ik_result import IKResult, IKStatus
from hydrostat.ik.limits import Limits, bounds
from hydrostat.ik.objectives.effort import keeps_taut
from hydrostat.ik.objectives.marker_target import MarkerTarget, named_targets
from hydrostat.ik.objectives.objective import Objective, checked_objectives
from hydrostat.ik.objectives.pose_regularizer import ClosenessKind, PoseRegularizer
from hydrostat.ik.search.descend import descend, least_effort
from hydrostat.ik.search.inverse_search import Descent, InverseSearch, SearchBudget, SearchProgress, reached_pose
from hydrostat.ik.search.problem import IKOptions, InverseProblem, InverseState
from hydrostat.mechanics import NewtonStatus
from hydrostat.robot import PoseTarget
from hydrostat.simulation import (
    Equilibrium,
    Simulation,
    friction_hysteresis,
    not_converged,
    require_static_obstacles,
    without_contact_friction,
)


def anchor_untargeted_markers(
    search: InverseSearch, found: Descent, target: PoseTarget | None, start: Equilibrium | None
) -> tuple[InverseSearch, Descent]:
    """Return the answer with markers without a target moved back to rest where their motion gains too little.

    It makes |r| + d^2 / (4 size) stationary, with what is missed in all, |r|, and the distance d of these markers from
    rest. A few descents do, in which d^2 weighs |r| / (2 size) with the last |r|. The answer is as it was where the
    target is in reach or names all markers, and where `options.hold_free_markers` is off.
    """
    problem, simulation = search.problem, search.problem.simulation
    size = simulation.robot.body.mesh.size
    names = () if target is None else tuple(m.name for m in simulation.robot.markers if m.name not in target.targets)
    rows = len(found.state.residual)
    if not problem.options.hold_free_markers or not names or found.state.error <= _MAX_MISS * size:
        return search, found
    rounds = 3
    for _ in range(rounds):
        if search.budget.over:
            break
        missed = float(np.linalg.norm(found.state.residual[:rows]))
        calm = PoseRegularizer(
            pose=simulation.rest, of=ClosenessKind.MARKERS, markers=names, weight=float(np.sqrt(0.5 * missed / size))
        )
        wary = InverseSearch(problem.with_term(calm.bind(simulation)), origin=start, budget=search.budget)
        wary.steps = search.steps
        history = found.state.history if simulation.assembly.has_history else None
        begun = wary.problem.state(found.state.values, found.state.result, history)
        calmer = descend(wary, begun)
        if calmer.within_limits < found.within_limits:
            break
        wary.solves += search.solves
        search, found = wary, calmer.after(found.iterations + calmer.iterations)
    return search, found


_MAX_MISS = 1e-3  # missed by more than this, in sizes of the body, a target is out of reach


Targets = PoseTarget | Mapping[str, Sequence[float] | Vector]  # where markers should go [m]: a pose, or points by name


def solve_ik(
    simulation: Simulation,
    targets: Targets | None = None,
    *,
    limits: Limits | None = None,
    objectives: Sequence[Objective] = (),
    start: Equilibrium | None = None,
    options: IKOptions | None = None,
    seconds: float | None = None,
    progress: SearchProgress | None = None,
) -> IKResult:
    """Solve inverse kinematics by bounded Gauss-Newton with sensitivities of the equilibrium.

    Minimizes half the squared errors of targets and objectives within the limits of the winches. Each step is
    linearized by dx/da; intermediate equilibria are solved only as precisely as needed, the last one exactly. The
    result is a local optimum; if it misses its goal, the search restarts elsewhere a few times. docs/theory/inverse.md.

    With cable friction, the loading path matters. The result is the pose that the robot reaches when the winches move
    in a straight line from `start`, or from rest, to the contractions, as in `Simulation.solve`. The search ignores
    friction on obstacles; the path to the result is then simulated with it, and errors are those at its end.

    Args:
        simulation: simulation of the robot.
        targets: target positions of markers [m].
        limits: limits of the winches, in addition to travel and release.
        objectives: objectives in addition to the targets, or in their place.
        start: start pose, from which rates are measured; the rest pose if left out. If several contractions reach the
            goals, the start does not matter, unless `options.min_tension` is off.
        options: tolerances and limits of the search.
        seconds: time limit, after which the best pose so far is returned [s]; no limit if left out.
        progress: callback at each step, with the number of steps in this descent and its rms error [m].

    Raises:
        InputError: no targets or objectives, unknown names, limits without room, a robot without cables, or other
            path-dependent physics.
        NotConvergedError: no equilibrium at the start of the search.
    """
    check_type(simulation, Simulation, "simulation must be a Simulation(robot)")
    check_type(options, (IKOptions, type(None)), "options must be IKOptions(...)")
    target, budget = as_pose(targets), SearchBudget.of(seconds, progress)
    require_static_obstacles(simulation.robot, "inverse kinematics")
    if (robot := without_contact_friction(simulation.robot)) is not simulation.robot:
        begin = None if start is None else replace(start, history=np.zeros(0))
        found = solve_ik(
            Simulation(robot, options=simulation.options),
            target,
            limits=limits,
            objectives=objectives,
            start=begin,
            options=options,
            seconds=seconds,
            progress=progress,
        )
        return _follow_friction(simulation.with_deadline(budget.deadline), found, start)
    simulation = simulation.with_deadline(budget.deadline)
    given = limits or Limits()
    allowed = bounds(simulation, given)
    if given.rate is not None:
        allowed = allowed.near(allowed.channel((start or simulation.rest).controls))
    terms = [wish.bind(simulation) for wish in wishes(target, objectives)]
    ready = given.rate is not None or any(keeps_taut(wish) for wish in objectives)
    problem = InverseProblem(simulation, terms, allowed, options or IKOptions(), ready=ready)
    search = InverseSearch(problem, origin=start, budget=budget)
    begun = search.begin(start)
    seek, aside = descend, None
    if problem.options.min_tension and problem.redundant(begun):
        seek = least_effort
        if given.rate is None and (start is not None or problem.options.restarts):
            begun, aside = begun if start is None else search.begin(None), begun
    found = seek(search, begun)
    nearly = problem.options.restart_error * simulation.robot.body.mesh.size
    if objectives or not found.within_limits or found.state.error > nearly:  # else a restart would gain too little
        found = _best(search, found, seek)
    # The answer does not depend on where it begins, unless squares are less than this share from there
    plainly = 0.98
    if aside is not None and found.status not in _ENDS:  # none is worse than where it began, or than a plain descent
        found = _better(search, found, descend(search, aside), share=plainly)
    search, found = anchor_untargeted_markers(search, found, target, start)
    reached = reached_pose(search, found, target)
    if not simulation.assembly.has_history:
        return reached
    return replace(reached, friction_hysteresis=_band(simulation, reached.pose))


def _follow_friction(simulation: Simulation, found: IKResult, start: Equilibrium | None) -> IKResult:
    """Solve an answer that was found without obstacle friction again, with friction along its loading path."""
    pose = simulation.solve(found.pose.controls, start=start, strict=False)
    if pose.result.status is NewtonStatus.TIME_LIMIT:
        found = replace(found, status=IKStatus.TIME_LIMIT)
    elif not pose.result.converged:
        raise not_converged(pose.result, simulation.diagnose(pose))
    targets = {} if found.target is None else found.target.targets
    errors = {
        name: float(np.linalg.norm(pose.markers[name] - targets[name])) if name in targets else error
        for name, error in found.errors.items()
    }
    return replace(found, pose=pose, errors=errors)


def _band(simulation: Simulation, pose: Equilibrium) -> Mapping[str, float]:
    """Return the friction hysteresis of the markers; empty if the path there and back cannot be followed."""
    try:
        return friction_hysteresis(simulation, pose)
    except NotConvergedError:
        return {}


def as_pose(targets: Targets | None) -> PoseTarget | None:
    """Targets as a pose; None if there are none."""
    if targets is None or isinstance(targets, PoseTarget):
        return targets
    return PoseTarget(name="target", targets=dict(named_targets(targets))) if targets else None


def wishes(target: PoseTarget | None, objectives: Sequence[Objective]) -> list[Objective]:
    """All terms of the objective (InputError: none)."""
    found = [*([MarkerTarget(targets=target.targets)] if target else []), *checked_objectives(objectives)]
    if not found:
        raise InputError("there is nothing to reach: give targets for markers, or objectives")
    return found


def _best(search: InverseSearch, found: Descent, seek: Callable[[InverseSearch, InverseState], Descent]) -> Descent:
    """Best of several beginnings; the first that reaches its goal."""
    if found.status in _ENDS or not found.state.errors:
        return found
    spent = found.iterations
    best = [found.state]
    for begun in islice(restarts(search, lambda: best[-1]), search.problem.options.restarts):
        other = seek(search, begun)
        spent += other.iterations
        if _better(search, found, other) is other:
            found = other
            best.append(other.state)
        if found.status is IKStatus.REACHED:
            break
        if search.budget.over:
            return replace(found, status=IKStatus.TIME_LIMIT).after(spent)
    return found.after(spent)


_ENDS = (IKStatus.REACHED, IKStatus.TIME_LIMIT)
"""After these no other beginning is tried."""


def _better(search: InverseSearch, found: Descent, other: Descent, *, share: float = 1.0) -> Descent:
    """Return the other result if it alone keeps to the limits, or if its objective is below a share of this one's."""
    new, old = (search.problem.objective(one.state, found.weight) for one in (other, found))
    less = other.within_limits >= found.within_limits and new < share * old
    return other if less or (other.within_limits and not found.within_limits) else found


def restarts(search: InverseSearch, best: Callable[[], InverseState]) -> Iterator[InverseState]:
    """States to restart from: poses reached directly from rest by other contractions.

    A body with several poses at the same contractions ends on the branch that its way leads to (E20), and the errors of
    markers have local optima. So first the best contractions are tried from rest; then in turn ones near them and ones
    anywhere. Only channels that move what is missed are changed: the fingers that are right stay. It ends after a few
    jumps that lead nowhere.
    """
    state = best()
    found = search.jump(state.values)
    if found is not None and not _same(found, state):
        yield found
    seed = 0
    draw = np.random.default_rng(seed)
    failures = 0
    for number in count():
        found = search.jump(_contractions(search, best(), number, draw))
        if found is not None:
            yield found
            continue
        failures += 1
        if failures == _FAILURES:  # few contractions of this robot can be jumped to: a way there would be long
            return


def _contractions(search: InverseSearch, state: InverseState, number: int, draw: np.random.Generator) -> Vector:
    """In turn: one concerned channel alone, some near the best, some anywhere."""
    bounds = search.problem.bounds
    moved = np.flatnonzero(_channels_of_misses(search, state))
    kind, turn = number % 3, number // 3
    values = state.values.copy()
    span = bounds.span[moved]
    # distance of contractions near the best ones: a share of the range, in the root of the mean square
    near = 0.03
    if kind == 0:
        values[moved] = np.clip(0.0, bounds.low, bounds.high)[moved]
        alone = moved[turn % len(moved)]
        values[alone] = bounds.high[alone] * 2.0 ** -(turn // len(moved))
    elif kind == 1:
        values[moved] += near * span * draw.standard_normal(len(moved))
    else:
        values[moved] = bounds.low[moved] + span * draw.uniform(size=len(moved))
    return np.clip(values, bounds.low, bounds.high)


def _channels_of_misses(search: InverseSearch, state: InverseState) -> np.ndarray:
    """Return the mask of the channels that act mostly on the missed targets."""
    derivatives = search.problem.jacobian(state) ** 2
    missed = state.residual**2 / max(float(np.max(state.residual**2, initial=0.0)), np.finfo(float).tiny)
    share = (missed @ derivatives) / np.maximum(derivatives.sum(axis=0), np.finfo(float).tiny)
    concerned = 0.3  # channels that act on what is missed at least this well, beside the one that does so best
    return share >= concerned * share.max(initial=0.0)


def _same(first: InverseState, second: InverseState) -> bool:
    nodes = second.result.nodes
    apart = 1e-6  # poses that differ by less, in sizes of the body, are one
    return bool(np.abs(first.result.nodes - nodes).max() < apart * np.ptp(nodes, axis=0).max())


_FAILURES = 6  # jumps that lead to no pose, after which there are no more
