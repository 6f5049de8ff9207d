"""`render`: a body in space as a shaded image, by a small renderer of our own."""

from dataclasses import dataclass

import numpy as np

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.drawing.camera import Spots
from hydrostat.drawing.creases import smooth_normals
from hydrostat.drawing.depth import DepthBuffer, Polyline
from hydrostat.drawing.palette import Color, paint, sky_shares

FINER = 2  # samples along each side of a pixel
CREASE = 42.0  # a sharper bend than this between two facets is drawn as an edge [degree]
RAMP = (
    (0.0, Color.SHADE),
    (0.30, Color.SEAM),
    (0.52, Color.mix(Color.SEAM, Color.FELT, 0.62)),
    (0.74, Color.FELT),
    (0.92, Color.FELT_LIGHT),
    (1.0, Color.STITCH),
)
"""Colors of felt from deep shade to full light."""


@dataclass(frozen=True, eq=False)
class Render:
    """Image of a body."""

    colors: Float[np.ndarray, "height width 4"]  # red, green, blue, cover, 0 to 1; the lowest row first
    buffer: DepthBuffer  # depth of the surface at each pixel

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, lower and upper end of the image [mm]."""
        rows, columns = self.buffer.depth.shape
        left, low = self.buffer.low - self.buffer.pixel / 2
        right, high = left + columns * self.buffer.pixel, low + rows * self.buffer.pixel
        return float(left), float(right), float(low), float(high)

    def covers(self, spots: Spots) -> Vector:
        """Depth of points, as the camera sees them [mm], behind the surface [mm]; 0 in front of it or next to it."""
        return np.maximum(-self.buffer.behind(spots), 0.0)

    def rings(self) -> list[Polyline]:
        """Silhouette as rings [mm], the widest first."""
        rings = [ring[:-1] for ring in self.buffer.rings(self.colors[..., 3], 0.5, tolerance=0.15)]
        return sorted(rings, key=lambda ring: float(np.prod(np.ptp(ring, axis=0))), reverse=True)

    def with_tint(self, facets: Bool[np.ndarray, " facets"], color: str) -> "Render":
        """Return the image with some of its facets tinted."""
        weight = 0.45 * ((self.buffer.owner >= 0) & facets[self.buffer.owner])[..., None]
        colors = self.colors.copy()
        colors[..., :3] = (1 - weight) * colors[..., :3] + weight * _shares(color)
        return Render(colors, self.buffer)

    @staticmethod
    def silhouette(spots: Spots, facets: Int[np.ndarray, "facets 3"], *, pixel: float) -> "Render":
        """Render cover and depth as `render` does, faster; colors are not valid."""
        samples, _ = _samples(spots[facets], np.empty((*facets.shape, 0)), pixel)
        rows, columns = (count // FINER for count in samples.depth.shape)
        cover = np.isfinite(samples.depth).reshape(rows, FINER, columns, FINER).mean(axis=(1, 3))
        return Render(np.stack([cover] * 4, axis=2), samples.coarser(FINER))


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
) -> Render:
    """Draw the boundary of a body.

    Args:
        spots: its nodes as the camera sees them [mm].
        facets: its boundary, seen from outside with the corners counterclockwise.
        pixel: side of a pixel [mm].
        held: 1 at nodes that are held and 0 elsewhere; they are hatched.
        up: the way up as the camera sees it, from where the sky shines; up in the picture if left out.
        pale: fades the felt behind what lies on it, 0 to 1.
        lines: strength of the mesh edges, 0 to 1.
        point: millimeters that a point (1/72 inch) shows, which sizes lines.
    """
    fine, corners = pixel / FINER, spots[facets]
    samples, steps = _samples(corners, _corner_values(corners, facets, held, fine if lines else 0.0), pixel)
    buffer = samples.coarser(FINER)
    size = float(np.ptp(corners, axis=(0, 1)).max())
    sky = _smooth(sky_shares(buffer.depth / pixel, _unit(buffer.shown[..., :3]), 0.11 * size / pixel))
    sky_way = (0.0, 1.0, 0.0) if up is None else up
    look = np.array([FINER, point / fine, 0.012 * size / fine, sky_way[1], sky_way[2], FINER * (steps[0] - steps[1])])
    inks = np.array(
        [
            _shares(Color.mix(Color.DARK, Color.SEAM, 0.25)),
            _shares(Color.MESH),
            _shares(Color.mix(Color.SEAM, Color.PAPER, pale)),
        ]
    )
    shares = np.array([1.0, 0.5 * lines, 0.9])
    return Render(paint(samples.depth / fine, samples.shown, sky, look, _table(pale), inks, shares), buffer)


def _samples(
    corners: Float[np.ndarray, "facets 3 3"], values: np.ndarray, pixel: float
) -> tuple[DepthBuffer, Float[np.ndarray, " 2"]]:
    """Samples within pixels of a size [mm], with values of the corners [mm]; they lie on a lattice that stays."""
    steps = np.floor(corners.min(axis=(0, 1))[:2] / pixel) - 2
    width, height = (FINER * (int(np.ceil(side / pixel)) + 5) for side in np.ptp(corners, axis=(0, 1))[:2])
    fine = pixel / FINER
    return DepthBuffer.within(corners, values, steps * pixel + fine / 2, fine, (height, width), inside=False), steps


def _corner_values(
    corners: Float[np.ndarray, "facets 3 3"], facets: Int[np.ndarray, "facets 3"], held: Vector | None, fine: float
) -> np.ndarray:
    """Normal, held or not, and distances to the sides in samples of `fine` [mm], per corner: (facets, 3, 4 or 7)."""
    normals = smooth_normals(corners, facets, sharp=CREASE)
    grip = np.zeros(facets.shape) if held is None else held[facets]
    parts = [normals, grip[..., None]]
    if fine:
        flat = corners[:, :, :2]
        (ax, ay), (bx, by) = (flat[:, 1] - flat[:, 0]).T, (flat[:, 2] - flat[:, 0]).T
        sides = np.linalg.norm(flat[:, [2, 0, 1]] - flat[:, [1, 2, 0]], axis=2)
        heights = (ax * by - ay * bx)[:, None] / np.maximum(sides, 1e-12) / fine
        parts.append(heights[:, :, None] * np.eye(3))
    return np.concatenate(parts, axis=2).astype(np.float32)


def _unit(vectors: Float[np.ndarray, "height width 3"]) -> np.ndarray:
    x, y, z = np.moveaxis(vectors, 2, 0)
    return vectors / np.maximum(np.sqrt(x * x + y * y + z * z), 1e-12)[..., None]


def _table(pale: float) -> Float[np.ndarray, "256 3"]:
    """Colors of felt from deep shade to full light."""
    stops = [stop for stop, _ in RAMP]
    colors = np.array([_shares(Color.mix(color, Color.PAPER, pale)) for _, color in RAMP])
    return np.column_stack([np.interp(np.linspace(0, 1, 256), stops, colors[:, channel]) for channel in range(3)])


def _smooth(image: np.ndarray) -> np.ndarray:
    """Image with its grain evened out."""
    for _ in range(2):
        padded = np.pad(image, [(2, 2), (0, 0)], mode="edge")
        outer, inner = padded[:-4] + padded[4:], padded[1:-3] + padded[3:-1]
        image = (0.1 * outer + 0.2 * inner + 0.4 * padded[2:-2]).T
    return image


def _shares(color: str) -> np.ndarray:
    """Red, green and blue of a color, 0 to 1."""
    return np.array(Color.channels(color)) / 255
