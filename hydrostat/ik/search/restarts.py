"""`restarts`: other places to begin from, when a search ends short of its goal."""

from collections.abc import Callable, Iterator
from itertools import count

import numpy as np

from hydrostat.arrays import Vector
from hydrostat.ik.search.inverse_search import InverseSearch
from hydrostat.ik.search.problem import InverseState

SEED = 0


def restarts(search: InverseSearch, best: Callable[[], InverseState]) -> Iterator[InverseState]:
    """States to begin from: each the pose that leads at once from rest to other contractions.

    A body with several poses at the same contractions ends on the branch that its way leads to (E20), and the errors of
    markers have local optima. So first the best contractions are tried from rest; then in turn ones near them and ones
    anywhere. Only channels that move what is missed are changed: the fingers that are right stay. It ends after a few
    jumps that lead nowhere.

    Args:
        search: the problem.
        best: the best state so far.
    """
    state = best()
    found = search.jump(state.values)
    if found is not None and not _same(found, state):
        yield found
    draw = np.random.default_rng(SEED)
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
    moved = np.flatnonzero(_concerned(search, state))
    kind, turn = number % 3, number // 3
    values = state.values.copy()
    span = bounds.span[moved]
    if kind == 0:
        values[moved] = np.clip(0.0, bounds.low, bounds.high)[moved]
        alone = moved[turn % len(moved)]
        values[alone] = bounds.high[alone] * 2.0 ** -(turn // len(moved))
    elif kind == 1:
        values[moved] += _NEAR * span * draw.standard_normal(len(moved))
    else:
        values[moved] = bounds.low[moved] + span * draw.uniform(size=len(moved))
    return np.clip(values, bounds.low, bounds.high)


def _concerned(search: InverseSearch, state: InverseState) -> np.ndarray:
    """Which channels act mostly on what is missed."""
    slopes = search.problem.slopes(state) ** 2
    missed = state.residual**2 / max(float(np.max(state.residual**2, initial=0.0)), np.finfo(float).tiny)
    share = (missed @ slopes) / np.maximum(slopes.sum(axis=0), np.finfo(float).tiny)
    return share >= _CONCERNED * share.max(initial=0.0)


def _same(first: InverseState, second: InverseState) -> bool:
    nodes = second.result.nodes
    return bool(np.abs(first.result.nodes - nodes).max() < _APART * np.ptp(nodes, axis=0).max())


_FAILURES = 6
"""Jumps that lead to no pose, after which there are no more."""

_NEAR = 0.03
"""How far contractions near the best ones are from them: a share of the range, in the root of the mean square."""

_CONCERNED = 0.3
"""Channels that act on what is missed at least this well, beside the one that does so best."""

_APART = 1e-6
"""Poses that differ by less, in sizes of the body, are one."""
