"""A shaded picture: the share of the sky that each point sees, and its color by light, hatching and lines."""

import numpy as np
from jaxtyping import Float

from hydrostat.arrays import Vector
from hydrostat.kernel import native

Pixels = Float[np.ndarray, "rows columns"]


def sky_shares(depth: Pixels, normals: Float[np.ndarray, "rows columns 3"], reach: float) -> Pixels:
    """Share of the sky that each pixel sees past its neighbors, 0 to 1 (screen-space ambient occlusion).

    Args:
        depth: towards the eye [pixels]; -inf where nothing is.
        normals: unit normals.
        reach: distance up to which neighbors shade [pixels].
    """
    sky = np.empty(depth.shape, dtype=np.float32)
    native.sky_shares(np.ascontiguousarray(depth), np.ascontiguousarray(normals, dtype=float), reach, sky)
    return sky


def paint(
    depth: Pixels,
    shown: Float[np.ndarray, "rows columns values"],
    sky: Float[np.ndarray, "height width"],
    look: Vector,
    table: Float[np.ndarray, "colors 3"],
    inks: Float[np.ndarray, "3 3"],
    shares: Vector,
) -> Float[np.ndarray, "height width 4"]:
    """Red, green, blue and cover of an image, 0 to 1, from the samples within its pixels.

    Args:
        depth: depth of each sample towards the eye [samples].
        shown: normal and whether it is held, of each sample, then its distances to the three sides of its facet in
            samples, if edges of the mesh are drawn: 4 or 7 values.
        sky: share of the sky that each pixel sees.
        look: samples along a side of a pixel, along a point (1/72 inch), of the least step in depth that is an edge;
            how far the sky is up, and towards the eye; how far hatching is moved to the right, in samples: 6 numbers.
        table: colors from no light to full light.
        inks: colors of hatching, mesh and edges.
        shares: strength of each of them.
    """
    image = np.empty((*sky.shape, 4))
    samples = (np.ascontiguousarray(array, dtype=np.float32) for array in (shown, sky))
    native.paint(np.ascontiguousarray(depth), *samples, look, table, inks, shares, image)
    return image
