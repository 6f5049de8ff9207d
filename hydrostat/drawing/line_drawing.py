"""`LineDrawing.of_solids`: solids as lines without hidden parts, with light grey on sides turned from the lamp."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely

from hydrostat.arrays import Bool, Float, Int
from hydrostat.drawing.camera import Camera
from hydrostat.drawing.creases import Facets, Segments
from hydrostat.drawing.depth import DepthBuffer, Polyline

_LAMP = np.array([-0.40, 0.75, 0.55]) / np.linalg.norm([-0.40, 0.75, 0.55])
"""Direction of the light in the view: from above, from the left, from behind the viewer's shoulder."""

_JUMP = 0.02  # a line is thick where what lies behind it is so much deeper, as a share of the picture
_SMOOTH = 0.6  # how far rings may pass beside what they enclose [pixels]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnSolid:
    """One solid of a drawing."""

    vertices: Float[np.ndarray, "vertices 3"]  # [mm]
    triangles: Int[np.ndarray, "triangles 3"]  # seen from outside they turn counter-clockwise
    sharp: float = 30.0  # edges are drawn where the sides turn by more than this [degrees]


@dataclass(frozen=True, eq=False, kw_only=True)
class LineDrawing:
    """Lines and tones as they are seen, in true size [mm]."""

    camera: Camera  # camera of the view
    outlines: tuple[Polyline, ...]  # lines before something deeper, or before nothing: to be drawn thick
    lines: tuple[Polyline, ...]  # other visible lines, to be drawn thin
    tones: tuple[tuple[float, tuple[Polyline, ...]], ...]  # 0 (black) to 1, rings by the even-odd rule
    buffer: DepthBuffer = field(repr=False)  # depth buffer of the view
    solid_of: Int[np.ndarray, " triangles"] = field(repr=False)  # index of the solid of each triangle of the buffer
    source: Int[np.ndarray, " triangles"] = field(repr=False)  # index of the triangle in that solid

    @cached_property
    def box(self) -> Float[np.ndarray, "2 2"]:
        """Lowest and highest coordinates of the drawing [mm]."""
        ways = np.concatenate([*self.outlines, *self.lines])
        return np.array([ways.min(axis=0), ways.max(axis=0)])

    def seen_of(self, way: Float[np.ndarray, "points 3"]) -> tuple[Polyline, ...]:
        """Parts of a line in space [mm] that nothing hides."""
        seen = self.camera.see(way)
        ahead, behind = _visible(np.stack([seen[:-1], seen[1:]], axis=1), self.buffer)
        return (*ahead, *behind)

    def spot_on(self, solid: int) -> Float[np.ndarray, " 2"] | None:
        """Point well inside the visible part of a solid [mm]; None if all of it is hidden."""
        from scipy.ndimage import distance_transform_edt

        mask = (self.buffer.owner >= 0) & (self.solid_of[self.buffer.owner] == solid)
        if not mask.any():
            return None
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        part = np.pad(mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], 1)
        row, column = np.unravel_index(int(np.argmax(np.asarray(distance_transform_edt(part)))), part.shape)
        return self.buffer.low + self.buffer.pixel * np.array(
            [float(columns[0] + column - 1), float(rows[0] + row - 1)]
        )

    def rings_of(self, solid: int, chosen: Bool[np.ndarray, " triangles"]) -> list[Polyline]:
        """Rings around the visible part of some triangles of a solid [mm]."""
        from scipy.ndimage import gaussian_filter

        wanted = (self.solid_of == solid) & chosen[np.minimum(self.source, len(chosen) - 1)]
        mask = (self.buffer.owner >= 0) & wanted[self.buffer.owner]
        return self.buffer.rings(gaussian_filter(mask.astype(float), 1.0), 0.5, tolerance=_SMOOTH)

    @staticmethod
    def of_solids(
        solids: Sequence[DrawnSolid], camera: Camera, *, soft: float = 0.0, pixels: int = 1400
    ) -> "LineDrawing":
        """Draw solids as they are seen, each edge and rim only as far as nothing hides it.

        The light is blurred over a share of the picture (`soft`), for a body with dents. Pixels along the longer side
        tell what is hidden; ten for a millimeter of paper are enough.
        """
        facets = [Facets.of(solid.vertices, solid.triangles, sharp=solid.sharp) for solid in solids]
        spots = np.concatenate([camera.see(item.vertices)[item.triangles] for item in facets])
        lights = np.concatenate([item.corners @ (camera.axes.T @ _LAMP) for item in facets])
        buffer = DepthBuffer.of(spots, lights[..., None], pixels=pixels)
        segments = np.concatenate([part for item in facets for part in (item.sharp_edges(), item.rims(camera.axes[2]))])
        seen = camera.see(segments.reshape(-1, 3)).reshape(-1, 2, 3)
        outlines, lines = _visible(seen, buffer)
        return LineDrawing(
            camera=camera,
            outlines=outlines,
            lines=lines,
            tones=_tones(buffer, soft),
            buffer=buffer,
            solid_of=np.repeat(np.arange(len(facets)), [len(item.triangles) for item in facets]),
            source=np.concatenate([item.source for item in facets]),
        )


def _visible(segments: Segments, buffer: DepthBuffer) -> tuple[tuple[Polyline, ...], tuple[Polyline, ...]]:
    """Parts of lines that are seen, those with a jump of depth behind them first."""
    lengths = np.linalg.norm(segments[:, 1, :2] - segments[:, 0, :2], axis=1)
    steps = np.maximum(np.ceil(2 * lengths / buffer.pixel).astype(int), 1)
    owner = np.repeat(np.arange(len(segments)), steps)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(steps) - steps, steps)
    share = ((place + 0.5) / steps[owner])[:, None]
    middles = (1 - share) * segments[owner, 0] + share * segments[owner, 1]
    seen = buffer.behind(middles, 1) > -1.5 * buffer.pixel
    jump = _JUMP * buffer.pixel * max(buffer.depth.shape)
    thick = seen & (buffer.behind(middles, 2) > jump)
    half = 0.5 / steps[owner][:, None]
    ends = [(1 - at) * segments[owner, 0] + at * segments[owner, 1] for at in (share - half, share + half)]
    parts = np.stack(ends, axis=1)[:, :, :2]
    least = 6 * buffer.pixel
    return _join_steps(parts, owner, thick, least), _join_steps(parts, owner, seen & ~thick, least)


def _join_steps(
    parts: Float[np.ndarray, "parts 2 2"], owner: Int[np.ndarray, " parts"], chosen: np.ndarray, least: float
) -> tuple[Polyline, ...]:
    """Chosen small steps as long lines, without those shorter than `least` [mm]."""
    places = np.flatnonzero(chosen)
    if not len(places):
        return ()
    breaks = np.flatnonzero((np.diff(places) > 1) | (np.diff(owner[places]) != 0))
    starts, stops = places[np.r_[0, breaks + 1]], places[np.r_[breaks, len(places) - 1]]
    runs = np.stack([parts[starts, 0], parts[stops, 1]], axis=1)
    # Ends that meet are the same only to rounding: on a grid of a hundredth of the least length they are equal.
    runs = np.unique(np.round(runs / (least / 100)) * (least / 100), axis=0)
    runs = runs[np.linalg.norm(runs[:, 1] - runs[:, 0], axis=1) > 0]
    merged = shapely.line_merge(shapely.MultiLineString([*runs]))
    whole = shapely.simplify(shapely.get_parts(merged), least / 30)
    return tuple(shapely.get_coordinates(line) for line in whole if line.length >= least)


def _tones(buffer: DepthBuffer, soft: float) -> tuple[tuple[float, tuple[Polyline, ...]], ...]:
    """Rings around the regions darker than each shade."""
    from scipy.ndimage import gaussian_filter

    dark = np.where(buffer.owner >= 0, 1.0 - buffer.shown[..., 0], 0.0)
    if soft:
        solid, reach = np.isfinite(buffer.depth), soft * max(buffer.depth.shape)
        weight = np.maximum(gaussian_filter(solid.astype(float), reach, truncate=2.5), 1e-9)
        dark = np.where(solid, gaussian_filter(np.where(solid, dark, 0.0), reach, truncate=2.5) / weight, 0.0)
    # below which light a side is grey, and how bright: pale enough to write on
    shades = ((0.6, 0.93), (0.05, 0.84))
    return tuple((grey, tuple(buffer.rings(dark, 1.0 - light, tolerance=_SMOOTH))) for light, grey in shades)
