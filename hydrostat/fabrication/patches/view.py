"""`FrontView`: how a body in space is looked at, so that its patches lie as they are worn."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.patches.patch import Patch


@dataclass(frozen=True, eq=False, kw_only=True)
class FrontView:
    """The view of the front."""

    right: Float[np.ndarray, " 3"]  # unit direction that points to the right in it
    up: Float[np.ndarray, " 3"]  # unit direction that points up in it

    def on_paper(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Where points are in it."""
        return points @ np.stack([self.right, self.up], axis=1)


def front_view(thin: Float[np.ndarray, " 3"]) -> FrontView:
    """Look along the thin direction, z up; y up where that is the thin direction."""
    up = _across(np.eye(3)[2], thin)
    if np.linalg.norm(up) < 0.3:
        up = _across(np.eye(3)[1], thin)
    up = up / np.linalg.norm(up)
    return FrontView(right=np.cross(thin, up), up=up)


def upright(patch: Patch, up: Float[np.ndarray, " 3"]) -> Patch:
    """The patch turned on the cloth so that it lies as it is worn, its middle at the origin."""
    corners = patch.disc.vertices[patch.disc.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    normal = normal / np.linalg.norm(normal)
    upward = _across(up, normal)
    if np.linalg.norm(upward) < 0.3:
        upward = _across(np.eye(3)[int(np.abs(normal).argmin())], normal)
    upward = upward / np.linalg.norm(upward)
    worn = corners.mean(axis=1) @ np.stack([np.cross(upward, normal), upward], axis=1)
    flat = patch.flat[patch.disc.triangles].mean(axis=1)
    worn, middle = worn - worn.mean(axis=0), np.average(flat, axis=0, weights=patch.disc.areas)
    one, other = (flat - middle) @ [1, 1j], worn @ [1, 1j]
    turn = np.sum(patch.disc.areas * np.conj(one) * other)
    turned = ((patch.flat - middle) @ [1, 1j]) * (turn / abs(turn))
    return replace(patch, flat=np.stack([turned.real, turned.imag], axis=1))


def _across(direction: Float[np.ndarray, " 3"], normal: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """The part of a direction across another."""
    return direction - (direction @ normal) * normal
