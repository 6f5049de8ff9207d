"""The colors of every picture: one language, safe for color-blind eyes, at home on light and on dark pages."""

from collections.abc import Iterable
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from hydrostat.arrays import Float, Vector
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


class Color:
    """Colors of all pictures. Scales and sets are tuples."""

    INK = "#2b2833"
    MUTED = "#85808f"
    GRID = "#ebe8ee"
    GHOST = "#b4afbc"
    GHOST_FILL = "#f3f1f5"
    PAPER = "#ffffff"
    ERROR = "#c8243f"

    PAGE: ClassVar = {
        INK: "ink",
        MUTED: "muted",
        GRID: "grid",
        GHOST: "ghost",
        GHOST_FILL: "ghost-fill",
        PAPER: "paper",
    }
    """Colors that follow the page: there they become CSS variables of these names, which dark pages change."""

    SHADE = "#7d4527"
    FELT = "#f0c29c"
    FELT_LIGHT = "#f8d9bd"
    SEAM = "#b9774b"
    STITCH = "#fff1e2"
    MESH = "#a8683e"
    DARK = "#2a2732"
    SHEET = "#5f87a6"
    LIGHT = "#fffdfb"

    WINCHES = ("#0b5fa5", "#00795f", "#a8256f", "#5a3da6", "#7a4a12", "#1787b8", "#5f6d0c", "#8b1b34")
    """A color for each winch, in order; all stand out on felt and carry white letters."""

    TENSION = ("#efa35c", "#e56a4f", "#c33c6a", "#842681", "#40156b", "#150b37")
    """From little tension to much: as even in lightness as magma, without its ends that felt or paper would swallow."""

    @staticmethod
    def mix(color: str, other: str, share: float) -> str:
        """Color with a share, 0 to 1, of another."""
        pairs = zip(Color.channels(color), Color.channels(other), strict=True)
        return "#" + "".join(f"{round((1 - share) * first + share * second):02x}" for first, second in pairs)

    @staticmethod
    def channels(color: str) -> list[int]:
        """Red, green and blue of a color, 0 to 255."""
        return [int(color[start : start + 2], 16) for start in (1, 3, 5)]

    @staticmethod
    def of_poses(names: Iterable[str]) -> dict[str, str]:
        """Color of each of a robot's poses: the winch colors in reverse, as few robots have that many winches."""
        return {name: Color.WINCHES[-1 - index % len(Color.WINCHES)] for index, name in enumerate(names)}

    @staticmethod
    def of_winches(winches: "Iterable[Named]") -> dict[str, str]:
        """Color of each of a robot's winches, by name; darker ones from the ninth on, and again from the 17th."""
        count = len(Color.WINCHES)
        colors = [*Color.WINCHES, *(Color.mix(color, Color.INK, 0.55) for color in Color.WINCHES)]
        return {winch.name: colors[index % (2 * count)] for index, winch in enumerate(winches)}


@runtime_checkable
class Named(Protocol):
    """Object with a name, such as a winch."""

    @property
    def name(self) -> str:
        """Name of the object."""
        ...
