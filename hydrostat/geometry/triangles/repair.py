"""Mend the few narrow triangles that moving nodes alone cannot."""

from collections.abc import Iterator

import numpy as np

from hydrostat.geometry.quality import angles
from hydrostat.geometry.triangles.draft import Draft
from hydrostat.geometry.triangles.relax import smooth, sound

_GOAL = 31.0
"""Triangles with a smaller angle than this [degrees] are worth a change."""

_CHANGES = 12


def repair(draft: Draft) -> Draft:
    """Add, remove or split near the narrowest triangle as long as that widens it; the best draft found is kept."""
    for _ in range(_CHANGES):
        least = _least(draft)
        if least >= _GOAL:
            break
        best = _widest(draft)
        if _least(best) < least + 0.5:
            break
        draft = best
    return draft


def _widest(draft: Draft) -> Draft:
    """The first change that is good enough, or else the best one."""
    best = draft
    for changed in _changes(draft):
        if sound(changed):
            moved = smooth(changed, power=8.0, rounds=2, iterations=25)
            best = max(best, moved, key=_least)
            if _least(best) >= _GOAL:
                break
    return best


def _least(draft: Draft) -> float:
    """Smallest angle of a draft [degrees]."""
    return float(angles(draft.points, draft.triangles).min())


def _changes(draft: Draft) -> Iterator[Draft]:
    """Drafts with one node more or less at the narrowest triangle."""
    worst = draft.triangles[int(np.argmin(angles(draft.points, draft.triangles)))]
    around = draft.triangles[np.isin(draft.triangles, worst).sum(axis=1) >= 2]
    for node in np.unique(around):
        ring, number = draft.place(int(node))
        if ring < 0:
            yield Draft(draft.divisions, np.delete(draft.interior, number, axis=0))
            continue
        division = draft.divisions[ring]
        if not division.fixed[number] and len(division.stations) > 3:
            yield draft.with_division(ring, division.without(number))
        if int(draft.edges[node, 1]) in around:
            yield draft.with_division(ring, division.split(number))
    for triangle in around:
        yield Draft(draft.divisions, np.vstack([draft.interior, draft.points[triangle].mean(axis=0)]))
