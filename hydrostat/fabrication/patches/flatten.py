"""`flatten`: lay a disc flat, no triangle on its back; `Distortion`: how much its cloth then has to give."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Float
from hydrostat.errors import InputError
from hydrostat.fabrication.patches.patch import Disc, Patch


@dataclass(frozen=True, eq=False, kw_only=True)
class Distortion:
    """Distortion of the map from flat cloth to the body, triangle by triangle."""

    # ratio of length in the direction of most stretch: above 1 the cloth has to stretch
    longest: Float[np.ndarray, " triangles"]
    # the same in the direction of least: below 1 it has to shrink, or wrinkles
    shortest: Float[np.ndarray, " triangles"]
    areas: Float[np.ndarray, " triangles"]  # areas of the triangles on the body [mm^2], their weights

    @property
    def gives(self) -> Float[np.ndarray, " triangles"]:
        """Strain of the cloth in its worst direction: 0.1 for 10 %, stretched or compressed."""
        return np.maximum(self.longest, 1 / self.shortest) - 1

    @property
    def area_ratios(self) -> Float[np.ndarray, " triangles"]:
        """Area on the body to area of the flat cloth."""
        return self.longest * self.shortest

    def give(self, share: float) -> float:
        """The give that this share of the area does not exceed."""
        return quantile(self.gives, self.areas, share)


def quantile(values: Float[np.ndarray, " _"], weights: Float[np.ndarray, " _"], share: float) -> float:
    """The value that this share of the weights does not exceed."""
    order = np.argsort(values, kind="stable")
    heaped = np.cumsum(weights[order])
    return float(values[order][min(int(np.searchsorted(heaped, share * heaped[-1])), len(values) - 1)])


def distortion(patch: Patch) -> Distortion:
    """The distortion of a patch (InputError: a triangle of it has no area)."""
    flat, solid = patch.flat[patch.disc.triangles], patch.disc.vertices[patch.disc.triangles]
    from_flat = np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
    to_solid = np.stack([solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]], axis=2)
    try:
        stretches = np.linalg.svd(to_solid @ np.linalg.inv(from_flat), compute_uv=False)
    except np.linalg.LinAlgError:
        told = "the skin of this body cannot be flattened into patches. Print or cast the body, or make it simpler"
        raise InputError(told) from None
    return Distortion(longest=stretches[:, 0], shortest=stretches[:, 1], areas=patch.disc.areas)


ENERGY_TOLERANCE = 5e-4
"""Relative change of the energy in one such time below which it has settled: it moves seams by less than cloth does."""


_TOOTH = 0.1
"""Height of a tooth, as a share of the root of the patch's area: how much the length of the rim counts. Enough that the
two sides of most seams differ by a few percent only, while patches distort little more."""


def flatten(disc: Disc, *, settled: float = ENERGY_TOLERANCE) -> Patch:
    """The flat image with the least symmetric Dirichlet energy, by scalable locally injective maps.

    The energy counts stretch and squeeze alike and grows without bound before a triangle would turn over (Rabinovich,
    Poranne, Panozzo, Sorkine-Hornung 2017). It begins with Tutte's map onto a circle, which turns none over, and ends
    at a relative change of `settled`. A tooth on each edge of the rim, a triangle whose tip is free, holds the length
    of that edge only: seams keep their lengths.
    """
    import igl

    toothed = _add_teeth(disc, _TOOTH * float(np.sqrt(disc.areas.sum())))
    energy, none = igl.MappingEnergyType.SYMMETRIC_DIRICHLET, np.zeros(0, dtype=np.int32)
    triangles = np.asfortranarray(toothed.triangles.astype(np.int32))
    solid, start = np.asfortranarray(toothed.vertices), np.asfortranarray(_tutte(toothed))
    data = igl.slim_precompute(solid, triangles, start, energy, none, np.zeros((0, 2), order="F"), 0.0)
    flat, before = start, np.inf
    steps = 5  # solves at a time
    most = 40  # maximum number of rounds of such solves
    for _ in range(most):
        flat = np.array(igl.slim_solve(data, steps))[:, :2]
        now = _energy(Patch(disc=toothed, flat=flat))
        if before - now < settled * now:
            break
        before = now
    return Patch(disc=disc, flat=flat[: len(disc.vertices)])


def _add_teeth(disc: Disc, height: float) -> Disc:
    """The disc with a triangle so high [mm] on each edge of its rim, in the plane of the one inside."""
    starts, ends = disc.rim, np.roll(disc.rim, -1)
    apex = {(a, b): c for a, b, c in _corners(disc)}
    inner = disc.vertices[[apex[edge] for edge in zip(starts.tolist(), ends.tolist(), strict=True)]]
    one, along = disc.vertices[starts], disc.vertices[ends] - disc.vertices[starts]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    out = one - inner
    out -= (out * along).sum(axis=1, keepdims=True) * along
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    tips = (one + disc.vertices[ends]) / 2 + height * out
    number = len(disc.vertices) + np.arange(len(starts))
    return Disc(
        vertices=np.concatenate([disc.vertices, tips]),
        triangles=np.concatenate([disc.triangles, np.column_stack([starts, number, ends])]),
        rim=np.column_stack([starts, number]).ravel(),
        of=np.concatenate([disc.of, np.full(len(starts), -1)]),
    )


def _corners(disc: Disc) -> list[list[int]]:
    """All triangles three times, from each corner."""
    return np.concatenate([np.roll(disc.triangles, -step, axis=1) for step in range(3)]).tolist()


def _energy(patch: Patch) -> float:
    """Mean of the squares of all stretches and of their inverses: 4 where nothing is distorted."""
    bent = distortion(patch)
    squares = bent.longest**2 + bent.shortest**2
    return float(np.average(squares + squares / bent.area_ratios**2, weights=bent.areas))


def _tutte(disc: Disc) -> Float[np.ndarray, "vertices 2"]:
    """Onto a circle of the patch's area, every inner vertex in the middle of its neighbors."""
    around = disc.vertices[disc.rim]
    lengths = np.linalg.norm(np.roll(around, -1, axis=0) - around, axis=1)
    angles = 2 * np.pi * np.concatenate([[0.0], np.cumsum(lengths)[:-1]]) / lengths.sum()
    radius = np.sqrt(disc.areas.sum() / np.pi)
    flat = np.zeros((len(disc.vertices), 2))
    flat[disc.rim] = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ends = np.sort(disc.triangles[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2), axis=1)
    one, other = np.unique(ends, axis=0).T
    count, weights = len(flat), np.ones(2 * len(one))
    from scipy.sparse import csc_array, csr_array
    from scipy.sparse.linalg import splu  # Imported here: not every command needs it.

    beside = csr_array((weights, (np.concatenate([one, other]), np.concatenate([other, one]))), shape=(count, count))
    inner = np.setdiff1d(np.arange(count), disc.rim)
    if len(inner):
        rows = beside[inner]
        degrees = csr_array((rows.sum(axis=1), (np.arange(len(inner)), np.arange(len(inner)))))
        flat[inner] = splu(csc_array(degrees - rows[:, inner])).solve(rows @ flat)
    return flat
