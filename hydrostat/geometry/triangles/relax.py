"""Move the nodes of a draft until its triangles are almost equilateral; repair the few that stay narrow."""

from collections.abc import Iterator

import numpy as np
from shapely import contains_xy

from hydrostat.arrays import Bool, Elements, Points, Vector
from hydrostat.geometry.mesh import angles
from hydrostat.geometry.triangles.divide import Spacing
from hydrostat.geometry.triangles.draft import Division, Draft, doubled_areas

_EQUILATERAL = 2.0 * np.sqrt(3.0)


def push_apart(draft: Draft, spacing: Spacing, steps: int) -> Draft:
    """Let neighbors that are too close push each other apart (DistMesh, Persson & Strang 2004)."""
    first_inside = int(draft.starts[-1])
    for _ in range(steps):
        points, triangles = draft.points, draft.triangles
        bars = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        across = points[bars[:, 0]] - points[bars[:, 1]]
        length = np.linalg.norm(across, axis=1)
        wanted = 1.1 * spacing(0.5 * (points[bars[:, 0]] + points[bars[:, 1]]))
        push = (np.maximum(wanted - length, 0.0) / np.maximum(length, 1e-12))[:, None] * across
        force = np.zeros_like(points)
        np.add.at(force, bars[:, 0], push)
        np.add.at(force, bars[:, 1], -push)
        moved = draft.interior + 0.2 * force[first_inside:]
        stays = contains_xy(draft.polygon, moved[:, 0], moved[:, 1])
        draft = Draft(draft.divisions, np.where(stays[:, None], moved, draft.interior))
    return draft


def smooth(draft: Draft, power: float, rounds: int, iterations: int = 40) -> Draft:
    """Minimize the sum over triangles of (mean ratio) ** power, with a new triangulation between rounds.

    The mean ratio is (a^2 + b^2 + c^2) / (4 sqrt(3) area): one for an equilateral triangle, without bound for a
    flat one. Boundary nodes that are no corners slide along their ring.
    """
    for _ in range(rounds):
        candidates = (_minimize(draft, power, iterations, slide) for slide in (True, False))
        moved = next((moved for moved in candidates if sound(moved)), draft)
        if not _score(moved, power) < _score(draft, power) - 1e-3:
            return draft
        draft = moved
    return draft


def sound(draft: Draft) -> bool:
    """Return True if nodes on the rings are in order and all sides exist, near the outline."""
    parts = draft.divisions
    ordered = all(bool((part.ends > part.stations).all()) for part in parts)
    stray = 0.18  # no smoothing takes a side of the mesh farther from the outline than this, in element sizes
    near = max(float(part.sagitta().max()) for part in parts) < stray
    return ordered and near and draft.polygon.is_valid and not draft.missing_sides.size


def _score(draft: Draft, power: float) -> float:
    """Mean over triangles of (mean ratio) ** power."""
    return _energy(draft.points, draft.triangles, power)[0] / len(draft.triangles)


def _energy(points: Points, triangles: Elements, power: float) -> tuple[float, Points]:
    """Sum of (mean ratio) ** power and its gradient by point; infinite where a triangle is turned over."""
    gradient = np.zeros_like(points)
    doubled = doubled_areas(points, triangles)
    if not doubled.min(initial=1.0) > 0.0:
        return np.inf, gradient
    corners = points[triangles]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    squares = np.einsum("tcd,tcd->t", opposite, opposite)
    ratio = squares / (_EQUILATERAL * doubled)
    turned = np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1)
    centered = 6.0 * (corners - corners.mean(axis=1, keepdims=True))
    weight = (power * ratio ** (power - 1.0))[:, None, None]
    derivative = weight * (
        centered / (_EQUILATERAL * doubled)[:, None, None] - (ratio / doubled)[:, None, None] * turned
    )
    for corner in range(3):
        np.add.at(gradient, triangles[:, corner], derivative[:, corner])
    return float((ratio**power).sum()), gradient


def _minimize(draft: Draft, power: float, iterations: int, slide: bool) -> Draft:
    """Draft moved at fixed triangles, its boundary nodes only if they may slide."""
    from scipy.optimize import minimize  # Imported here: bodies in space are read sooner.

    slides = ~np.concatenate([part.fixed for part in draft.divisions]) & slide
    triangles = draft.triangles
    start = np.concatenate([np.zeros(int(slides.sum())), draft.interior.ravel()])

    def objective(variables: Vector) -> tuple[float, Vector]:
        moved = _move_points(draft, variables, slides)
        value, gradient = _energy(moved.points, triangles, power)
        if not np.isfinite(value):
            return 1e12, np.zeros_like(variables)
        tangents = np.concatenate([part.curve.tangents(part.stations, 0.02) for part in moved.divisions])
        along = np.einsum("ij,ij->i", gradient[: len(tangents)], tangents)[slides]
        return value, np.concatenate([along, gradient[len(tangents) :].ravel()])

    best = minimize(objective, start, jac=True, method="L-BFGS-B", options={"maxiter": iterations}).x
    return _move_points(draft, best, slides)


def _move_points(draft: Draft, variables: Vector, slides: Bool[np.ndarray, " boundary"]) -> Draft:
    """Return the draft with its sliding nodes shifted along their rings and its inner points moved."""
    shifts = np.zeros(len(slides))
    shifts[slides] = variables[: int(slides.sum())]
    parts = tuple(
        Division(part.curve, part.stations + shifts[first:last], part.fixed)
        for part, first, last in zip(draft.divisions, draft.starts[:-1], draft.starts[1:], strict=True)
    )
    return Draft(parts, variables[int(slides.sum()) :].reshape(-1, 2))


_GOAL = 31.0  # triangles with a smaller angle than this [degrees] are worth a change


def repair(draft: Draft) -> Draft:
    """Add, remove or split near the narrowest triangle as long as that widens it; the best draft found is kept."""
    changes = 12
    for _ in range(changes):
        least = _least(draft)
        if least >= _GOAL:
            break
        best = _widest(draft)
        if _least(best) < least + 0.5:
            break
        draft = best
    return draft


def _widest(draft: Draft) -> Draft:
    """First change that is good enough, or else the best one."""
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
