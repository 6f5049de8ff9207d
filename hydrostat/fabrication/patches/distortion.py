"""`Distortion`: how much the cloth of a patch has to give to lie on the body."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hydrostat.fabrication.patches.patch import Patch


@dataclass(frozen=True, eq=False, kw_only=True)
class Distortion:
    """Of the map from flat cloth to the body, triangle by triangle.

    Attributes:
        longest: ratio of length in the direction of most stretch: above 1 the cloth has to stretch.
        shortest: the same in the direction of least: below 1 it has to shrink, or wrinkles.
        areas: of the triangles on the body [mm^2], their weights.
    """

    longest: Float[np.ndarray, " triangles"]
    shortest: Float[np.ndarray, " triangles"]
    areas: Float[np.ndarray, " triangles"]

    @property
    def gives(self) -> Float[np.ndarray, " triangles"]:
        """How much the cloth has to give in its worst direction: 0.1 for 10 %, stretched or squeezed."""
        return np.maximum(self.longest, 1 / self.shortest) - 1

    @property
    def area_ratios(self) -> Float[np.ndarray, " triangles"]:
        """Area on the body to area of the flat cloth."""
        return self.longest * self.shortest

    def give(self, share: float) -> float:
        """The give that this share of the area does not exceed."""
        return quantile(self.gives, self.areas, share)

    def text(self) -> str:
        """The figures in words."""
        lengths = np.concatenate([self.shortest, self.longest]), np.tile(self.areas, 2)
        low, high = (quantile(*lengths, share) for share in (0.05, 0.95))
        small, large = (quantile(self.area_ratios, self.areas, share) for share in (0.05, 0.95))
        return (
            f"cloth gives {self.give(0.95):.1%} (95 % of the area; half of it {self.give(0.5):.1%}, at worst "
            f"{self.gives.max():.0%}); lengths {low:.3f} to {high:.3f}, "
            f"areas {small:.3f} to {large:.3f} of the flat ones"
        )


def quantile(values: Float[np.ndarray, " _"], weights: Float[np.ndarray, " _"], share: float) -> float:
    """The value that this share of the weights does not exceed."""
    order = np.argsort(values, kind="stable")
    heaped = np.cumsum(weights[order])
    return float(values[order][min(int(np.searchsorted(heaped, share * heaped[-1])), len(values) - 1)])


def distortion(patch: Patch) -> Distortion:
    """The distortion of a patch."""
    flat, solid = patch.flat[patch.disc.triangles], patch.disc.vertices[patch.disc.triangles]
    from_flat = np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
    to_solid = np.stack([solid[:, 1] - solid[:, 0], solid[:, 2] - solid[:, 0]], axis=2)
    stretches = np.linalg.svd(to_solid @ np.linalg.inv(from_flat), compute_uv=False)
    return Distortion(longest=stretches[:, 0], shortest=stretches[:, 1], areas=patch.disc.areas)
