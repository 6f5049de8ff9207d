"""How far each pixel of a picture is in colour from the plain ground it was taken or drawn on."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter

from hydrostat.arrays import Vector

_FAINT = 16.0
_GRAIN = 1.0
_MOST_SAMPLES = 40_000
_DARKEST_SHADOW = 0.4

Field = Float[np.ndarray, "rows columns"]
"""A value for each pixel."""


@dataclass(frozen=True, eq=False)
class Contrast:
    """A picture against its ground, in steps of colour from 0 to 255 and more.

    Attributes:
        field: distance in colour of each pixel from the ground there.
        strong: level halfway between ground and what stands out most (Otsu 1979).
        faint: level that the noise of the ground does not reach.
        shaded: which pixels have the colour of the ground, only darker, as in a soft shadow.
        edge: share of the picture's border that stands out from the ground.
    """

    field: Field
    strong: float
    faint: float
    shaded: Bool[np.ndarray, "rows columns"]
    edge: float


def contrast(pixels: Float[np.ndarray, "rows columns 3"]) -> Contrast:
    """Compare a picture with its ground: a colour that changes slowly (a quadratic of the place), as light does.

    The ground is fitted to the border of the picture and then to all that is like it; what stands out is left out of
    the fit, so a body may reach the border in places.

    Args:
        pixels: red, green, blue from 0 to 255.
    """
    border = np.zeros(pixels.shape[:2], dtype=bool)
    width = max(2, round(0.02 * min(border.shape)))
    border[:width] = border[-width:] = border[:, :width] = border[:, -width:] = True
    grain = np.abs(np.diff(pixels, axis=0)).max(axis=2)[border[1:] & border[:-1]]
    if float(np.median(grain)) > _GRAIN:
        pixels = gaussian_filter(pixels, (0.8, 0.8, 0.0))
    ground, noise = _ground(pixels, border, np.median(pixels[border], axis=0))
    field = np.linalg.norm(pixels - ground, axis=2)
    for _ in range(2):
        ground, noise = _ground(pixels, field < _faint(noise), ground)
        field = np.linalg.norm(pixels - ground, axis=2)
    faint = _faint(noise)
    edge = float((field[border] > faint).mean())
    return Contrast(field, max(_otsu(field), faint), faint, _shaded(pixels, ground, 0.5 * faint), edge)


def _faint(noise: float) -> float:
    return max(_FAINT, 2.5 * noise)


def _ground(
    pixels: Float[np.ndarray, "rows columns 3"],
    like: Bool[np.ndarray, "rows columns"],
    first: Float[np.ndarray, "... 3"],
) -> tuple[Float[np.ndarray, "rows columns 3"], float]:
    """A quadratic colour through the pixels that are like the ground, and how far 95 % of them are from it at most."""
    rows, columns = pixels.shape[:2]
    y, x = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    where = np.flatnonzero(like)
    where = where[:: max(1, len(where) // _MOST_SAMPLES)]
    px, py = x.ravel()[where], y.ravel()[where]
    basis = np.stack([np.ones_like(px), px, py, px * px, px * py, py * py], axis=1)
    colours = pixels.reshape(-1, 3)[where]
    away = np.linalg.norm(colours - np.broadcast_to(first, pixels.shape).reshape(-1, 3)[where], axis=1)
    factors = np.zeros((6, 3))
    for _ in range(6):
        kept = away <= max(3.0 * float(np.median(away)), 6.0)
        factors = np.linalg.lstsq(basis[kept], colours[kept], rcond=None)[0]
        away = np.linalg.norm(colours - basis @ factors, axis=1)
    kept = away <= max(3.0 * float(np.median(away)), 6.0)
    whole = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2) @ factors
    return whole, float(np.quantile(away[kept], 0.95))


def _otsu(field: Field) -> float:
    """Halfway between the means of the two classes that lie farthest apart (Otsu 1979)."""
    counts, edges = np.histogram(field, bins=512)
    middles = 0.5 * (edges[1:] + edges[:-1])
    below, total = np.cumsum(counts)[:-1], counts.sum()
    sums, whole = np.cumsum(counts * middles)[:-1], float((counts * middles).sum())
    low, high = _mean(sums, below), _mean(whole - sums, total - below)
    best = int(np.argmax(below * (total - below) * (high - low) ** 2))
    return float(0.5 * (low[best] + high[best]))


def _mean(sums: Vector, counts: np.ndarray) -> Vector:
    return sums / np.maximum(counts, 1)


def _shaded(pixels: np.ndarray, ground: np.ndarray, tolerance: float) -> Bool[np.ndarray, "rows columns"]:
    """Which pixels are the ground times a number below one."""
    share = np.einsum("rcd,rcd->rc", pixels, ground) / np.maximum(np.einsum("rcd,rcd->rc", ground, ground), 1.0)
    off = np.linalg.norm(pixels - share[..., None] * ground, axis=2)
    return (off < tolerance) & (share < 1.0) & (share > _DARKEST_SHADOW)
