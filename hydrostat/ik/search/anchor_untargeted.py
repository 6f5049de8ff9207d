"""`anchor_untargeted_markers`: markers without a target stay at rest if a target is out of reach."""

import numpy as np

from hydrostat.ik.objectives.pose_regularizer import ClosenessKind, PoseRegularizer
from hydrostat.ik.search.descend import descend
from hydrostat.ik.search.inverse_search import Descent, InverseSearch
from hydrostat.robot import PoseTarget
from hydrostat.simulation import Equilibrium


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
    if not problem.options.hold_free_markers or not names or found.state.error <= _MISSED * size:
        return search, found
    for _ in range(_ROUNDS):
        if search.patience.over:
            break
        missed = float(np.linalg.norm(found.state.residual[:rows]))
        calm = PoseRegularizer(
            pose=simulation.rest, of=ClosenessKind.MARKERS, markers=names, weight=float(np.sqrt(0.5 * missed / size))
        )
        wary = InverseSearch(problem.with_term(calm.bind(simulation)), origin=start, patience=search.patience)
        wary.steps = search.steps
        history = found.state.history if simulation.assembly.has_history else None
        begun = wary.problem.state(found.state.values, found.state.result, history)
        calmer = descend(wary, begun)
        if calmer.allowed < found.allowed:
            break
        wary.solves += search.solves
        search, found = wary, calmer.after(found.iterations + calmer.iterations)
    return search, found


_MISSED = 1e-3  # missed by more than this, in sizes of the body, a target is out of reach
_ROUNDS = 3
