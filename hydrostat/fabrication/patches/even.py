"""`relax_patch`: flatten a patch again with less strain in large parts of its cloth, for a little more elsewhere."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.patches.patch import Patch

LOOSE, HELD = 0.1, 0.03
"""The unit in which edges of the rim are counted that are longer or shorter than on the body: where only the cloth
matters, and where the two sides of a seam differ too much."""
_SPARED = 4.0  # a place whose square is so many times more counts less than by its third power: corners may give more


def relax_patch(patch: Patch, *, ease: float = LOOSE) -> Patch:
    """The flat image of least mean sixth power of the give; the rim keeps its length, edge by edge, as well as it can.

    `flatten` has the least mean square, which leaves some places with far more than others. Here s = (|J|^2 +
    |J^-1|^2 - 4) / 4 is about the square of the give of a triangle with the map J from body to cloth; the mean of s^3,
    in units of what cloth gives, is brought down from the patch as it lies by L-BFGS. Where s is far above that unit it
    counts less. No triangle turns over, for s grows without bound before. `ease` is the unit of the rim.
    """
    energy = PatchEnergy(patch, ease)
    from scipy.optimize import minimize  # Imported here: only what is sewn in space needs it.

    steps = 300
    found = minimize(energy, patch.flat.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": steps, "maxcor": 20})
    flat = found.x.reshape(-1, 2)
    return replace(patch, flat=flat) if np.isfinite(found.fun) and found.fun < _NOWHERE else patch


_NOWHERE = 1e12  # energy of images with a triangle on its back


class PatchEnergy:
    """Energy that `relax_patch` minimizes, with its gradient: mean of s^3 over the cloth, and error of the rim."""

    def __init__(self, patch: Patch, ease: float) -> None:
        disc, self._ease = patch.disc, ease
        self._triangles, self._count = disc.triangles, len(disc.vertices)
        self._back = np.linalg.inv(_in_plane(disc.vertices[disc.triangles]))
        self._weights = disc.areas / disc.areas.sum()
        self._ends = np.column_stack([disc.rim, np.roll(disc.rim, -1)])
        self._lengths = np.linalg.norm(np.diff(disc.vertices[self._ends], axis=1)[:, 0], axis=1)
        self._shares = self._lengths / self._lengths.sum()

    def __call__(self, numbers: Float[np.ndarray, " numbers"]) -> tuple[float, Float[np.ndarray, " numbers"]]:
        """The sum of both at the places of all vertices, and its slope by each of these numbers."""
        flat = numbers.reshape(-1, 2)
        bent, slope = self._cloth(flat)
        off, pull = self._rim(flat)
        return bent + off, (slope + pull).ravel()

    def _cloth(self, flat: Float[np.ndarray, "vertices 2"]) -> tuple[float, Float[np.ndarray, "vertices 2"]]:
        corners = flat[self._triangles]
        sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        jacobian = sides @ self._back
        (a, b), (c, d) = jacobian[:, 0].T, jacobian[:, 1].T
        area, square = a * d - b * c, (jacobian**2).sum(axis=(1, 2))
        if area.min() <= 1e-6:
            return _NOWHERE, np.zeros_like(flat)
        give = 0.12  # unit of the cloth's stretch
        bent = np.maximum(square * (1 + area**-2) / 4 - 1, 0.0) / give**2
        spared = 1 + (bent / _SPARED) ** 2
        steep = self._weights * (3 * bent**2 * spared - 2 * bent**4 / _SPARED**2) / spared**2 / (4 * give**2)
        turned = np.stack([np.stack([d, -c], axis=1), np.stack([-b, a], axis=1)], axis=1)
        push = 2 * jacobian * (1 + area**-2)[:, None, None] - (2 * square / area**3)[:, None, None] * turned
        forces = steep[:, None, None] * (push @ np.swapaxes(self._back, 1, 2))
        each = np.stack([-forces.sum(axis=2), forces[:, :, 0], forces[:, :, 1]], axis=1)
        return float(self._weights @ (bent**3 / spared)), self._heaped(self._triangles, each)

    def _rim(self, flat: Float[np.ndarray, "vertices 2"]) -> tuple[float, Float[np.ndarray, "vertices 2"]]:
        ways = flat[self._ends[:, 1]] - flat[self._ends[:, 0]]
        lengths = np.linalg.norm(ways, axis=1)
        off = np.log(lengths / self._lengths) / self._ease
        pulls = (2 * self._shares * off / self._ease / lengths**2)[:, None] * ways
        return float(self._shares @ off**2), self._heaped(self._ends, np.stack([-pulls, pulls], axis=1))

    def _heaped(self, at: np.ndarray, each: np.ndarray) -> Float[np.ndarray, "vertices 2"]:
        """Sums over the corners at each vertex."""
        return np.stack([np.bincount(at.ravel(), each[..., axis].ravel(), self._count) for axis in (0, 1)], axis=1)


def _in_plane(corners: Float[np.ndarray, "triangles 3 3"]) -> Float[np.ndarray, "triangles 2 2"]:
    """Two sides of each triangle as columns, in a frame of its own plane, its normal up."""
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    length = np.linalg.norm(one, axis=1)
    along = (one * other).sum(axis=1) / length
    height = np.linalg.norm(np.cross(one, other), axis=1) / length
    return np.stack([np.stack([length, along], axis=1), np.stack([np.zeros_like(length), height], axis=1)], axis=1)
