"""`remove_via_points`: holes that do not earn their stitch, left out several at a time."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrostat.design.routes.evaluator import Trial
from hydrostat.design.routes.growth import Growth
from hydrostat.design.routes.layout import Layout
from hydrostat.design.routes.refine import moves_of, pushed_back
from hydrostat.design.routes.search_rules import RULES

Hole = tuple[int, int]  # numbers of a cable and of a point of it


def remove_via_points(growth: Growth, trial: Trial) -> Trial:
    """Remove via points that do not earn their stitch, those first that cost least by the linear model.

    Each hole is sewn a little beside its mark, and each rubs: with fewer, less goes wrong. Holes are left out half of
    them at a time, fewer where that costs too much; one that fails alone is kept.
    """
    worth = growth.proposals.options.simplicity * RULES.hole_worth
    kept: set[bytes] = set()
    size: int | None = None
    while True:
        holes = [hole for hole in _by_cost(growth, trial, worth) if _key(trial.layout, hole) not in kept]
        if not holes or len(kept) >= RULES.hole_failures:
            return trial
        size = -(-len(holes) // 2) if size is None else min(size, len(holes))
        chosen = holes[:size]
        found = _without(growth, trial, chosen, (1 + worth) ** size * trial.cost)
        if found is not None:
            trial, size = found, 2 * size
        elif size == 1:
            kept.add(_key(trial.layout, chosen[0]))
        else:
            size //= 2


def _by_cost(growth: Growth, trial: Trial, worth: float) -> list[Hole]:
    """Via points that may go and cost little, in the order of the cost without them by the linear model."""
    layout, evaluator = trial.layout, growth.evaluator
    twins = {route.twin for route in layout.routes}
    rows = [(weight, *moves_of(trial, pose)) for pose, weight in enumerate(evaluator.weights)]
    missed = [evaluator.residual(trial.simulation, index, pose.nodes) for index, pose in enumerate(trial.poses)]
    found = []
    for number, route in enumerate(layout.routes):
        if route.kept is not None or route.twin is not None or number in twins:
            continue
        for point in range(max(route.lead, 0) + 1, len(route.points) - 1):
            if len(route.points) - 1 - route.lead < RULES.min_points:
                continue
            place, step = layout.place_of(number, point), _to_line(route.points[point - 1 : point + 2])
            square = trial.built_error**2
            for (weight, moves, pulls), own, columns in zip(rows, missed, trial.columns, strict=True):
                free = np.linalg.qr(weight[:, None] * pulls)[0]
                after = own - weight * (moves[:, place] @ step)
                change = after - free @ (free.T @ (after - own))
                square += float(change @ change - own @ own) - float(((weight[:, None] * columns[:, place]) ** 2).sum())
            if square < ((1 + RULES.hole_promise * worth) * trial.built_error) ** 2:
                found.append((square, number, point))
    return [(number, point) for _, number, point in sorted(found)]


def _to_line(points: np.ndarray) -> np.ndarray:
    """Step of the middle one of three points to the straight line between the others."""
    along = points[2] - points[0]
    share = (points[1] - points[0]) @ along / max(float(along @ along), 1e-300)
    return points[0] + np.clip(share, 0.0, 1.0) * along - points[1]


def _without(growth: Growth, trial: Trial, holes: Sequence[Hole], allowed: float) -> Trial | None:
    """Leave out holes, as a step of the search."""
    return growth.evaluator.keep("holes left out", lambda: [_solve_without(growth, trial, holes, allowed)])[0]


def _solve_without(growth: Growth, trial: Trial, holes: Sequence[Hole], allowed: float) -> Trial | None:
    """The network without some holes; None if it cannot be built, or costs more than allowed [m]."""
    routes, region = list(trial.layout.routes), growth.proposals.graph.region
    for number in {number for number, _ in holes}:
        route = routes[number]
        left = np.setdiff1d(np.arange(len(route.points)), [point for cable, point in holes if cable == number])
        points, new = route.points[left], np.flatnonzero(np.diff(left) > 1)
        if len(points) - route.lead < RULES.min_points or not region.sees(points[new], points[new + 1]).all():
            return None
        routes[number] = replace(route, points=points)
    less = pushed_back(
        replace(trial.layout, routes=tuple(routes)), region, RULES.hole_reach * growth.proposals.graph.size
    )
    if less is None:
        return None
    found = growth.evaluator.reach_poses(less, trial, iterations=RULES.hole_ik_steps, worst=allowed)
    return found if found is not None and found.cost <= allowed else None


def _key(layout: Layout, hole: Hole) -> bytes:
    """Mark of a hole that does not change where others of its cable go."""
    number, point = hole
    return number.to_bytes(2, "big") + layout.routes[number].points[point].tobytes()
