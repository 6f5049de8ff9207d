"""`render`: a body in space as a shaded image, by a small renderer of our own."""

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float, Int

from hydrostat.arrays import Vector
from hydrostat.plot.camera import Spots
from hydrostat.plot.palette import DARK, FELT, FELT_LIGHT, MESH, SEAM, STITCH, mix
from hydrostat.plot.places import Place, Places
from hydrostat.plot.raster import corner_normals, paint, rasterise, sky_shares

FINER = 2
"""Samples along each side of a pixel."""

CREASE = 42.0
"""A sharper bend than this between two facets is drawn as an edge [degree]."""

RAMP = ((0.0, "#7d4527"), (0.30, SEAM), (0.52, mix(SEAM, FELT, 0.62)), (0.74, FELT), (0.92, FELT_LIGHT), (1.0, STITCH))
"""Colours of felt from deep shade to full light."""


@dataclass(frozen=True, eq=False)
class Render:
    """An image of a body.

    Attributes:
        colours: red, green, blue and cover of each pixel, the lowest row first, (height, width, 4), 0 to 1.
        depth: of the surface towards the eye [mm]; minus infinity where there is none, (height, width).
        low: lower left corner of the image [mm].
        pixel: side of a pixel [mm].
    """

    colours: Float[np.ndarray, "height width 4"]
    depth: Float[np.ndarray, "height width"]
    low: Place
    pixel: float

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, lower and upper end of the image [mm]."""
        height, width = self.depth.shape
        low = self.low
        return float(low[0]), float(low[0] + width * self.pixel), float(low[1]), float(low[1] + height * self.pixel)

    def covers(self, spots: Spots) -> Vector:
        """How far points, as the camera sees them [mm], lie behind the surface [mm]; 0 in front of it or beside it."""
        height, width = self.depth.shape
        columns, rows = np.floor((spots[:, :2] - self.low) / self.pixel).astype(int).T
        inside = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
        surface = np.full(len(spots), -np.inf)
        surface[inside] = self.depth[rows[inside], columns[inside]]
        return np.maximum(surface - spots[:, 2], 0.0)

    def rings(self) -> list[Places]:
        """The silhouette as rings [mm], the widest first."""
        from contourpy import contour_generator

        cover = np.pad(self.colours[..., 3], 1)
        lines = contour_generator(z=cover).lines(0.5)
        smooth = [
            shapely.simplify(shapely.LineString(np.asarray(line, dtype=float)), 0.15) for line in lines if len(line) > 4
        ]
        rings = [self.low + (shapely.get_coordinates(line)[:-1] - 0.5) * self.pixel for line in smooth]
        return sorted(rings, key=lambda ring: float(np.prod(np.ptp(ring, axis=0))), reverse=True)


def render(
    spots: Spots,
    facets: Int[np.ndarray, "facets 3"],
    *,
    pixel: float,
    held: Vector | None = None,
    up: Float[np.ndarray, " 3"] | None = None,
    pale: float = 0.0,
    lines: float = 0.0,
    point: float = 1.0,
    shaded: bool = True,
) -> Render:
    """Draw the boundary of a body.

    Args:
        spots: its nodes as the camera sees them [mm].
        facets: its boundary, seen from outside with the corners counterclockwise.
        pixel: side of a pixel [mm].
        held: 1 at nodes that are held and 0 elsewhere; they are hatched.
        up: the way up as the camera sees it, from where the sky shines; up in the picture if left out.
        pale: fades the felt behind what lies on it, 0 to 1.
        lines: how strongly the edges of the mesh are drawn, 0 to 1.
        point: millimetres that a point (1/72 inch) shows, which sizes lines.
        shaded: without, only cover and depth are right, sooner.
    """
    fine = pixel / FINER
    # On a lattice of its own, so that pixels and hatching of what rests stay while other parts move.
    steps = np.floor(spots[facets].min(axis=(0, 1))[:2] / pixel) - 2
    low = steps * pixel
    width, height = (int(np.ceil(side / pixel)) + 5 for side in np.ptp(spots[facets], axis=(0, 1))[:2])
    origin = np.array([low[0], low[1], 0.0])
    corners = ((spots - origin) / fine)[facets]
    held = np.zeros(len(spots)) if held is None else held
    normals = facet_normals(corners, facets) if shaded else np.empty((*facets.shape, 0))
    values = np.concatenate([normals, held[facets][..., None]], axis=2)
    depth, shown, rim = rasterise(corners, values, FINER * width, FINER * height)
    middle = depth[FINER // 2 :: FINER, FINER // 2 :: FINER] * fine
    if not shaded:
        cover = np.isfinite(depth).reshape(height, FINER, width, FINER).mean(axis=(1, 3))
        return Render(np.stack([cover] * 4, axis=2), middle, low, pixel)
    size = float(np.ptp(spots[facets], axis=(0, 1)).max())
    sky = _smooth(sky_shares(middle / pixel, _unit(shown[::FINER, ::FINER, :3]), 0.11 * size / pixel))
    sky_way = (0.0, 1.0, 0.0) if up is None else up
    look = np.array([FINER, point / fine, 0.012 * size / fine, sky_way[1], sky_way[2], FINER * (steps[0] - steps[1])])
    inks = np.array([_hex(mix(DARK, SEAM, 0.25)), _hex(MESH), _hex(mix(SEAM, "#ffffff", pale))])
    shares = np.array([1.0, 0.5 * lines, 0.9])
    return Render(paint(depth, shown, rim, sky, look, _table(pale), inks, shares), middle, low, pixel)


def facet_normals(
    corners: Float[np.ndarray, "facets 3 3"], facets: Int[np.ndarray, "facets 3"]
) -> Float[np.ndarray, "facets 3 3"]:
    """Unit normal at each corner of each facet: smooth, but for creases."""
    order = np.argsort(facets.ravel(), kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(facets.ravel()))])
    return corner_normals(np.ascontiguousarray(corners), facets, starts, order // 3, float(np.cos(np.radians(CREASE))))


def _unit(vectors: Float[np.ndarray, "height width 3"]) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=2, keepdims=True), 1e-12)


def _table(pale: float) -> Float[np.ndarray, "256 3"]:
    """Colours of felt from deep shade to full light."""
    stops = [stop for stop, _ in RAMP]
    colours = np.array([_hex(mix(colour, "#ffffff", pale)) for _, colour in RAMP])
    return np.column_stack([np.interp(np.linspace(0, 1, 256), stops, colours[:, channel]) for channel in range(3)])


def _smooth(image: np.ndarray) -> np.ndarray:
    """An image with its grain evened out."""
    for axis in (0, 1):
        padded = np.pad(image, [(2, 2) if axis == side else (0, 0) for side in (0, 1)], mode="edge")
        count = image.shape[axis]
        parts = [padded.take(range(shift, shift + count), axis=axis) for shift in range(5)]
        image = np.tensordot(np.array([0.1, 0.2, 0.4, 0.2, 0.1]), np.array(parts), axes=1)
    return image


def _hex(colour: str) -> np.ndarray:
    return np.array([int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5)])
