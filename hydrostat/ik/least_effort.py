"""`least_effort`: of the many contractions that reach a goal, those that pull least."""

from hydrostat.ik.descend import Descent, descend
from hydrostat.ik.reached_pose import InverseReason
from hydrostat.ik.search import Search


def least_effort(search: Search, found: Descent) -> Descent:
    """The same goal reached with least squared tensions, where the goal leaves a choice (E18).

    With a heavy effort there is one optimum, near rest, whatever the start. It is followed while the weight of the
    effort falls. Walking along the poses that reach the goal would be slow, as these are curved.

    Args:
        search: the problem.
        found: where it was reached.
    """
    wanted = search.options.unique and found.reason is InverseReason.REACHED
    if not (wanted and search.wasteful(found.state)):
        return found
    state, spent = found.state, found.iterations
    for weight in _WEIGHTS:
        lighter = descend(search, state, weight=weight)
        state, spent = lighter.state, spent + lighter.iterations
    last = descend(search, state)
    spent += last.iterations
    return (last if last.reason is InverseReason.REACHED else found).after(spent)


_WEIGHTS = (1.0, 0.1, 1e-2, 1e-3)
"""Of the effort, one after the other."""
