"""`Thickness`: thickness of a body everywhere on its boundary, and the number of elements across."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hydrostat.arrays import Float, Int, Points
from hydrostat.geometry.mesh import Mesh, joined_groups
from hydrostat.lazy import load_compiled

_ASIDE = (0.011, -0.007, -0.004)
"""Offset of a ray's start from the center of its facet, as weights: from there it hits edges in regular meshes."""


_MERGE_DISTANCE = 1.5  # middles of thin places this many elements apart are of one part
_LIMB_RATIO = 1.5  # a part is a limb if it is this many times as long as thick


@dataclass(frozen=True, eq=False)
class Thickness:
    """Thickness of the body inside of each facet of the boundary."""

    chords: Float[np.ndarray, " facets"]  # thickness along the inward normal of the facet [m]
    middles: Float[np.ndarray, "facets dim"]  # middle of the chord [m]
    # length of the mesh's edges about the facet [m]: of a regular element of the same size
    spacing: Float[np.ndarray, " facets"]
    areas: Float[np.ndarray, " facets"]  # area of the facet [m^2], its length in the plane [m]

    @property
    def across(self) -> Float[np.ndarray, " facets"]:
        """Number of elements across the body at each facet."""
        return self.chords / self.spacing

    def part(self, share: float) -> tuple[float, float]:
        """Thickness [m] and elements across that `share` of the boundary fall below."""
        weights = self.areas / self.areas.sum()
        found = []
        for values in (self.chords, self.across):
            order = np.argsort(values, kind="stable")
            found.append(float(values[order][np.searchsorted(np.cumsum(weights[order]), share)]))
        return found[0], found[1]

    def thin_parts(self, least: float) -> list["ThinPart"]:
        """Limbs and sheets with fewer than `least` elements across, thinnest first.

        Tips, corners and notches are no limbs: what is not longer than `_LIMB_RATIO` times its thickness is left out.
        """
        thin = np.flatnonzero(self.across < least)
        if not len(thin):
            return []
        middles = self.middles[thin]
        reach = _MERGE_DISTANCE * float(np.median(self.spacing[thin]))
        neighbors = 20  # as many of them are looked at: in a mesh with fine and coarse places more would be near
        gaps, near = build_point_tree(middles).query(middles, k=min(neighbors, len(thin)), distance_upper_bound=reach)
        gaps, near = gaps.reshape(len(thin), -1), near.reshape(len(thin), -1)
        one, two = np.nonzero(np.isfinite(gaps))[0], near[np.isfinite(gaps)]
        labels = joined_groups(np.stack([one, two]), len(thin))
        found = []
        for part in range(labels.max() + 1):
            members = thin[labels == part]
            spread = self.middles[members] - self.middles[members].mean(axis=0)
            axis = np.linalg.svd(spread, full_matrices=False)[2][0]
            length = float(np.ptp(spread @ axis))
            at = members[np.argsort(self.across[members])[3 * len(members) // 4]]
            chord, across = float(self.chords[at]), float(self.across[at])
            if length > _LIMB_RATIO * chord:
                found.append(ThinPart(chord, across, self.middles[at], length))
        return sorted(found, key=lambda part: part.across)

    @staticmethod
    def measure(mesh: Mesh) -> "Thickness":
        """Rays from every facet of the boundary, along its normal through the body, from element to element."""
        corners = mesh.nodes[mesh.boundary]
        weights = np.full(mesh.dim, 1 / mesh.dim) + _ASIDE[: mesh.dim] - np.mean(_ASIDE[: mesh.dim])
        starts = np.einsum("c,fcd->fd", weights, corners)
        inward, areas = _normals(corners)
        chords = _march(mesh, mesh.boundary_elements, starts, inward)
        return Thickness(chords, starts + 0.5 * chords[:, None] * inward, _smooth_spacing(mesh), areas)


def _normals(corners: Float[np.ndarray, "facets corners dim"]) -> tuple[Points, Float[np.ndarray, " facets"]]:
    """Unit normals into the body, and areas."""
    if corners.shape[2] == 2:
        along = corners[:, 1] - corners[:, 0]
        inward = np.column_stack([-along[:, 1], along[:, 0]])
        areas = np.linalg.norm(inward, axis=1)
        return inward / areas[:, None], areas
    inward = np.cross(corners[:, 2] - corners[:, 0], corners[:, 1] - corners[:, 0])
    double = np.linalg.norm(inward, axis=1)
    return inward / double[:, None], double / 2


def _smooth_spacing(mesh: Mesh) -> Float[np.ndarray, " facets"]:
    """Mean spacing of the elements about the nodes of each facet, for those at the boundary alone may be cut small."""
    total, count = np.zeros(len(mesh.nodes)), np.zeros(len(mesh.nodes))
    each = np.repeat(mesh.spacings[:, None], mesh.dim + 1, axis=1)
    np.add.at(total, mesh.elements, each)
    np.add.at(count, mesh.elements, 1.0)
    return (total[mesh.boundary] / count[mesh.boundary]).mean(axis=1)


def _march(
    mesh: Mesh, elements: Int[np.ndarray, " rays"], starts: Points, directions: Points
) -> Float[np.ndarray, " rays"]:
    """Length [m] of each ray in the body, from a start in its element to where no element follows."""
    beyond = _neighbors(mesh)
    spans = np.swapaxes(mesh.nodes[mesh.elements[:, 1:]] - mesh.nodes[mesh.elements[:, :1]], 1, 2)
    derivatives = np.linalg.inv(spans)
    run, here, rays = np.zeros(len(starts)), elements.copy(), np.arange(len(starts))
    came = np.full(len(starts), -2)
    most_steps = 10_000
    for _ in range(most_steps):
        if not len(rays):
            break
        inverse = derivatives[here[rays]]
        local = np.einsum("rij,rj->ri", inverse, starts[rays] - mesh.nodes[mesh.elements[here[rays], 0]])
        change = np.einsum("rij,rj->ri", inverse, directions[rays])
        weight = np.column_stack([1 - local.sum(axis=1), local])
        rate = np.column_stack([-change.sum(axis=1), change])
        ahead = (rate < 0) & (beyond[here[rays]] != came[rays, None])
        ends = np.where(ahead, -weight / np.where(ahead, rate, 1.0), np.inf)
        face = np.argmin(ends, axis=1)
        end = ends[np.arange(len(rays)), face]
        run[rays] = np.where(np.isfinite(end), np.maximum(end, run[rays]), run[rays])
        after = np.where(np.isfinite(end), beyond[here[rays], face], -1)
        came[rays] = here[rays]
        here[rays] = after
        rays = rays[after >= 0]
    return run


def _neighbors(mesh: Mesh) -> Int[np.ndarray, "elements corners"]:
    """Element beyond the facet opposite each corner; -1 where the body ends."""
    count, corners = len(mesh.elements), mesh.dim + 1
    facets = np.sort(np.concatenate([np.delete(mesh.elements, corner, axis=1) for corner in range(corners)]), axis=1)
    order = np.lexsort(facets.T)
    same = np.flatnonzero((facets[order][1:] == facets[order][:-1]).all(axis=1))
    one, two = order[same], order[same + 1]
    beyond = np.full(count * corners, -1)
    beyond[one], beyond[two] = two % count, one % count
    return beyond.reshape(corners, count).T


@dataclass(frozen=True, eq=False)
class ThinPart:
    """Part of the body that is thin and goes on for longer than it is thick."""

    thickness: float  # thickness that three quarters of the part do not reach [m]: a point or a notch is no limb
    across: float  # number of elements across
    place: Float[np.ndarray, " dim"]  # middle of the body there [m]
    length: float  # length of the part [m]


def build_point_tree(points: Points) -> Any:
    """Build `scipy.spatial.KDTree`, or the compiled class beneath it, which loads 0.1 s sooner."""
    compiled = load_compiled("scipy.spatial._ckdtree")
    if compiled is not None and hasattr(compiled, "cKDTree"):
        return compiled.cKDTree(points, leafsize=_LEAF)
    from scipy.spatial import KDTree

    return KDTree(points, leafsize=_LEAF)


_LEAF = 10
"""Points in a leaf, as in KDTree: the order of pairs depends on it."""
