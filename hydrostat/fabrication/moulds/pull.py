"""`find_pull`: the direction along which a mold of two halves comes off with the least undercut."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import numpy as np
from manifold3d import Manifold

from hydrostat.arrays import Bool, Float, Vector
from hydrostat.fabrication.moulds.release import FineSurface, Release, axes_along, fine_surface, release

_DEPTH = 0.05
"""Share of undercut that a mold may have more for being flat instead of as deep as the body is long: deep molds are
hard to print and to fill."""


_FLATS = 6  # flat faces whose normals are tried: along walls that are flat the good directions are few and sharp


@dataclass(frozen=True, eq=False, kw_only=True)
class Pull:
    """Pull by which the halves come off."""

    direction: Float[np.ndarray, "3"]  # unit vector along which the upper half is drawn, in the coordinates of the body
    height: float  # height of the parting plane along it [mm]
    share: float  # share of the surface that is undercut: neither half comes off it
    surface: FineSurface  # the surface that was looked at
    undercut: Bool[np.ndarray, " triangles"]  # True for each of its triangles that is undercut
    directions: Float[np.ndarray, "tried 3"]  # all that were tried
    shares: Vector  # share for each of them, at its best height


def half_sphere(count: int) -> Float[np.ndarray, "count 3"]:
    """Unit vectors spread evenly over half of all directions, along a spiral of golden angles."""
    steps = np.arange(count) + 0.5
    heights = 1.0 - steps / count
    radii = np.sqrt(1.0 - heights**2)
    angles = np.pi * (1 + np.sqrt(5)) * steps
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles), heights])


def best_height(surface: FineSurface, freed: Release) -> tuple[float, float]:
    """The height of the plane [mm] with the least area undercut, of equal ones nearest to the middle; its share."""
    order = np.argsort(freed.heights, kind="stable")
    areas = surface.areas[order]
    held_below = np.concatenate([[0.0], np.cumsum(areas * ~freed.downward[order])])
    held_above = np.concatenate([[0.0], np.cumsum(areas * ~freed.upward[order])])
    held = (held_below + held_above[-1] - held_above) / areas.sum()
    sorted_heights = freed.heights[order]
    planes = (sorted_heights[1:] + sorted_heights[:-1]) / 2
    held = held[1:-1]
    middle = (sorted_heights[0] + sorted_heights[-1]) / 2
    apart = 1e-7
    held = np.where(np.diff(sorted_heights) > apart * surface.size, held, np.inf)  # no plane within a level face
    # shares that differ by less are the same: then the parting is nearest to the middle of the body
    level = 2e-3
    good = np.flatnonzero(held <= held.min() + level)
    chosen = good[int(np.argmin(np.abs(planes[good] - middle)))]
    return float(planes[chosen]), float(held[chosen])


def find_pull(solid: Manifold, *, count: int = 150) -> Pull:
    """The best direction and height for a flat parting of a body [mm]: of `count` on half a sphere, and then nearby.

    The results of the last bodies are kept: other options of a mold need no new search.
    """
    surface = fine_surface(solid)
    return _find_pull(surface.vertices.tobytes(), surface.triangles.tobytes(), count)


@lru_cache(maxsize=8)
def _find_pull(vertices: bytes, triangles: bytes, count: int) -> Pull:
    """Search the best pull of a surface, whose arrays are given as bytes."""
    surface = FineSurface(np.frombuffer(vertices).reshape(-1, 3), np.frombuffer(triangles, int).reshape(-1, 3))
    tried = np.vstack([_own_axes(surface), np.eye(3), _flat_directions(surface), half_sphere(count)])
    shares, costs = _rate_directions(surface, tried)
    best = 3
    leaders = tried[np.argsort(costs, kind="stable")[:best]]
    rings = (9.0, 4.5, 2.2, 1.1, 0.5)  # angles at which neighbors of the best direction are tried [degrees]
    for angle in np.radians(rings):
        near = np.vstack([_ring(leader, angle) for leader in leaders])
        more_shares, more_costs = _rate_directions(surface, near)
        tried = np.vstack([tried, near])
        shares, costs = np.concatenate([shares, more_shares]), np.concatenate([costs, more_costs])
        leaders = tried[np.argsort(costs, kind="stable")[:1]]
    direction = _upright(leaders[0])
    freed = release(surface, direction)
    height, share = best_height(surface, freed)
    return Pull(
        direction=direction,
        height=height,
        share=share,
        surface=surface,
        undercut=freed.undercut(height),
        directions=tried,
        shares=shares,
    )


def _rate_directions(surface: FineSurface, directions: Float[np.ndarray, "tried 3"]) -> tuple[Vector, Vector]:
    """Share of undercut of each direction, and what it costs with the depth of the mold."""
    shares = np.array([best_height(surface, release(surface, direction))[1] for direction in directions])
    depths = np.ptp(surface.vertices @ directions.T, axis=0)
    return shares, shares + _DEPTH * depths / surface.size


def _own_axes(surface: FineSurface) -> Float[np.ndarray, "3 3"]:
    """Main axes of the surface: those of a box, a cylinder, a hand."""
    places = surface.middles - np.average(surface.middles, axis=0, weights=surface.areas)
    return np.linalg.eigh(places.T @ (places * surface.areas[:, None]))[1].T


def _flat_directions(surface: FineSurface) -> Float[np.ndarray, "tried 3"]:
    """Normals of the largest flat faces, and the directions along each two of them."""
    signs = np.where(
        surface.normals[np.arange(len(surface.normals)), np.abs(surface.normals).argmax(axis=1)] < 0, -1.0, 1.0
    )
    normals = signs[:, None] * surface.normals
    groups = np.unique((50 * normals).round(), axis=0, return_inverse=True)[1].reshape(-1)
    areas = np.bincount(groups, weights=surface.areas)
    largest = np.argsort(-areas, kind="stable")[:_FLATS]
    flats = [np.average(normals[groups == group], axis=0, weights=surface.areas[groups == group]) for group in largest]
    flat_share = 0.02
    kept = [flat for flat, group in zip(flats, largest, strict=True) if areas[group] > flat_share * areas.sum()]
    found = [*kept, *(np.cross(one, other) for one, other in combinations(kept, 2))]
    lengths = [float(np.linalg.norm(direction)) for direction in found]
    crossed = 0.2
    along = [direction / length for direction, length in zip(found, lengths, strict=True) if length > crossed]
    return np.array(along).reshape(-1, 3)


def _ring(direction: Float[np.ndarray, "3"], angle: float) -> Float[np.ndarray, "around 3"]:
    """Directions at an angle [radians] to one, all round."""
    one, two, _ = axes_along(direction)
    around = 6
    turns = 2 * np.pi * np.arange(around)[:, None] / around
    return np.cos(angle) * direction + np.sin(angle) * (np.cos(turns) * one + np.sin(turns) * two)


def _upright(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Turn a direction round if its largest coordinate is negative; tiny ones are rounding."""
    direction = np.where(np.abs(direction) < 1e-9, 0.0, direction)
    largest = direction[int(np.argmax(np.abs(direction)))]
    return direction * np.sign(largest) / np.linalg.norm(direction)
