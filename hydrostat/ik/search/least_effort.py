"""`least_effort`: of the many contractions that reach a goal, those that pull least."""

from hydrostat.ik.search.descend import Descent, descend
from hydrostat.ik.search.search import Search, State


def least_effort(search: Search, state: State) -> Descent:
    """The goal approached with least squared tensions, where it leaves a choice (E18).

    With a heavy effort the optimum is near rest. It is followed while the weight of the effort falls. Walking along the
    poses that reach the goal would be slow, as these are curved.

    Args:
        search: the problem.
        state: where to begin.
    """
    spent = 0
    for weight in _WEIGHTS:
        lighter = descend(search, state, weight=weight)
        state, spent = lighter.state, spent + lighter.iterations
    found = descend(search, state)
    return found.after(spent + found.iterations)


_WEIGHTS = (1.0, 0.1, 1e-2, 1e-3)
"""Of the effort, one after the other."""
