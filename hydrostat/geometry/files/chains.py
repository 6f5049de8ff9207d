"""Lines that end where others begin become rings and chains."""

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from hydrostat.errors import OutlineError
from hydrostat.geometry.files.rings import place
from hydrostat.geometry.outline import Ring

_SAME = 1e-6
_GAP = 1e-3

_Ends = Int[np.ndarray, "lines 2"]


def join(lines: list[Ring], name: str) -> list[tuple[Ring, bool]]:
    """Join open lines at their ends, whichever way each runs.

    Ends that are a millionth of the drawing apart are one; a free end and the free end nearest to it are one when they
    are a thousandth apart or less. A line drawn twice counts once. Lines with a free end that lead nowhere stay open.

    Args:
        lines: points of each, finite.
        name: what errors call the file.

    Returns:
        Rings and chains, and whether each is closed.

    Raises:
        OutlineError: lines branch, so that it is not clear which of them are the outline.
    """
    if not lines:
        return []
    extent = float(np.ptp(np.concatenate(lines), axis=0).max()) or 1.0
    ends = _meet(np.array([[line[0], line[-1]] for line in lines]), extent)
    kept = _once(lines, ends, extent)
    lines, ends = [lines[index] for index in kept], ends[kept]
    dead = _dead_ends(ends)
    walks = _walks(ends, np.flatnonzero(~dead)) + _walks(ends, np.flatnonzero(dead))
    joined = []
    for walk in walks:
        line, start, end = _line(lines, ends, walk)
        if start != end and not dead[walk[0][0]]:
            raise OutlineError(
                f"{name}: lines branch at {place(line[0])} and {place(line[-1])}: leave only the outline and its holes"
            )
        joined.append((line, start == end))
    return joined


def _meet(points: Float[np.ndarray, "lines 2 2"], extent: float) -> _Ends:
    """A number for each end of each line, the same for those that meet."""
    flat = points.reshape(-1, 2)
    cells = np.concatenate(
        [np.floor(flat / (2.0 * _SAME * extent) + shift) for shift in ((0, 0), (0, 0.5), (0.5, 0), (0.5, 0.5))]
    )
    grid = np.repeat(np.arange(4), len(flat))
    _, cell = np.unique(np.column_stack([grid, cells]), axis=0, return_inverse=True)
    count = len(flat) + int(cell.max()) + 1
    numbers = _joined(np.tile(np.arange(len(flat)), 4), cell.ravel() + len(flat), count)[: len(flat)]
    free = np.flatnonzero(np.bincount(numbers)[numbers] == 1)
    if len(free) > 1:
        found = KDTree(flat[free]).query(flat[free], k=2)
        distance, near = np.asarray(found[0]), np.asarray(found[1])
        other = near[:, 1]
        mutual = (other[other] == np.arange(len(free))) & (distance[:, 1] <= _GAP * extent)
        mutual &= free // 2 != free[other] // 2
        numbers = _joined(numbers[free[mutual]], numbers[free[other[mutual]]], count)[numbers]
    return numbers.reshape(-1, 2)


def _joined(first: Int[np.ndarray, " _"], second: Int[np.ndarray, " _"], count: int) -> Int[np.ndarray, " _"]:
    """The part that each of `count` numbers belongs to when the pairs of first and second are joined."""
    joins = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    return np.asarray(connected_components(joins, directed=False)[1])


def _once(lines: list[Ring], ends: _Ends, extent: float) -> Int[np.ndarray, " kept"]:
    """The lines that are no repetition of another and have a length."""
    seen, kept = set(), []
    for index, (line, (start, end)) in enumerate(zip(lines, ends.tolist(), strict=True)):
        middle = _middle(line)
        key = (min(start, end), max(start, end), *np.round(middle / (100 * _SAME * extent)).tolist())
        if key not in seen and (start != end or np.ptp(line, axis=0).max() > 2 * _GAP * extent or len(line) > 3):
            kept.append(index)
        seen.add(key)
    return np.array(kept, dtype=int)


def _middle(line: Ring) -> Float[np.ndarray, " 2"]:
    """The place half way along a line."""
    lengths = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    return np.array([np.interp(0.5 * lengths[-1], lengths, line[:, axis]) for axis in range(2)])


def _dead_ends(ends: _Ends) -> np.ndarray:
    """Which lines are on no way from a place back to itself: (lines,) of bool."""
    at = _at(ends, np.arange(len(ends)))
    degree = {here: len(lines) for here, lines in at.items()}
    dead = np.zeros(len(ends), dtype=bool)
    todo = [here for here, count in degree.items() if count == 1]
    while todo:
        here = todo.pop()
        for line in at[here]:
            if not dead[line] and degree[here] == 1:
                dead[line] = True
                there = int(ends[line].sum()) - here
                degree[here] -= 1
                degree[there] -= 1
                if degree[there] == 1:
                    todo.append(there)
    return dead


def _at(ends: _Ends, chosen: Int[np.ndarray, " _"]) -> dict[int, list[int]]:
    """The chosen lines at each place, one that returns to it twice."""
    at: dict[int, list[int]] = {}
    for line in chosen.tolist():
        for here in ends[line].tolist():
            at.setdefault(here, []).append(line)
    return at


def _walks(ends: _Ends, chosen: Int[np.ndarray, " _"]) -> list[list[tuple[int, bool]]]:
    """Ways through places where two of the chosen lines meet, each as lines and whether they are walked forward."""
    at = _at(ends, chosen)
    used: set[int] = set()
    walks = []
    for start in sorted(at, key=lambda here: len(at[here]) == 2):  # branches and free ends first
        for first in at[start]:
            walk: list[tuple[int, bool]] = []
            here, line = start, first
            while line not in used:
                used.add(line)
                forward = int(ends[line, 0]) == here
                walk.append((line, forward))
                here = int(ends[line, 1 if forward else 0])
                line = next((other for other in at[here] if other not in used), line) if len(at[here]) == 2 else line
            if walk:
                walks.append(walk)
    return walks


def _line(lines: list[Ring], ends: _Ends, walk: list[tuple[int, bool]]) -> tuple[Ring, int, int]:
    """The points along a walk and the numbers of its two ends."""
    pieces = [lines[line] if forward else lines[line][::-1] for line, forward in walk]
    (first, ahead), (last, onward) = walk[0], walk[-1]
    points = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    return points, int(ends[first, 0 if ahead else 1]), int(ends[last, 1 if onward else 0])
