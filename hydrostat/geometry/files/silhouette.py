"""`Silhouette`: the one body in a picture, separated from plain ground by `Contrast`, as rings in pixel coordinates."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt, find_objects, gaussian_filter, gaussian_filter1d, label
from shapely import Polygon, get_coordinates

from hydrostat.arrays import Bool, Float, Int, Vector
from hydrostat.errors import OutlineError
from hydrostat.geometry.outline import Curve, Ring

_GRAIN = 1.0

Field = Float[np.ndarray, "rows columns"]  # a value for each pixel


@dataclass(frozen=True, eq=False)
class Contrast:
    """Picture against its ground, in steps of color from 0 to 255 and more."""

    field: Field  # distance in color of each pixel from the ground there
    strong: float  # level halfway between ground and what stands out most (Otsu 1979)
    faint: float  # level that the noise of the ground does not reach
    # which pixels have the color of the ground, only darker, as in a soft shadow
    shaded: Bool[np.ndarray, "rows columns"]
    edge: float  # share of the image border that stands out from the ground


def contrast(pixels: Float[np.ndarray, "rows columns 3"]) -> Contrast:
    """Compare a picture (red, green, blue from 0 to 255) with its ground: a color that changes slowly, as light does.

    The ground, a quadratic of the place, is fitted to the border of the picture and then to all that is like it; what
    stands out is left out of the fit, so a body may reach the border in places.
    """
    border = np.zeros(pixels.shape[:2], dtype=bool)
    width = max(2, round(0.02 * min(border.shape)))
    border[:width] = border[-width:] = border[:, :width] = border[:, -width:] = True
    grain = np.abs(np.diff(pixels, axis=0)).max(axis=2)[border[1:] & border[:-1]]
    if float(np.median(grain)) > _GRAIN:
        pixels = gaussian_filter(pixels, (0.8, 0.8, 0.0))
    ground, noise = fit_ground(pixels, border, np.median(pixels[border], axis=0))
    field = np.linalg.norm(pixels - ground, axis=2)
    for _ in range(2):
        ground, noise = fit_ground(pixels, field < _faint(noise), ground)
        field = np.linalg.norm(pixels - ground, axis=2)
    faint = _faint(noise)
    edge = float((field[border] > faint).mean())
    return Contrast(field, max(_otsu(field), faint), faint, _find_shadow(pixels, ground, 0.5 * faint), edge)


def _faint(noise: float) -> float:
    faint = 16.0
    return max(faint, 2.5 * noise)


def fit_ground(
    pixels: Float[np.ndarray, "rows columns 3"],
    like: Bool[np.ndarray, "rows columns"],
    first: Float[np.ndarray, "... 3"],
) -> tuple[Float[np.ndarray, "rows columns 3"], float]:
    """Quadratic color of the ground, fitted to its pixels, and the distance within which 95 % of them lie."""
    rows, columns = pixels.shape[:2]
    y, x = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    where = np.flatnonzero(like)
    most_samples = 40_000
    where = where[:: max(1, len(where) // most_samples)]
    px, py = x.ravel()[where], y.ravel()[where]
    basis = np.stack([np.ones_like(px), px, py, px * px, px * py, py * py], axis=1)
    colors = pixels.reshape(-1, 3)[where]
    away = np.linalg.norm(colors - np.broadcast_to(first, pixels.shape).reshape(-1, 3)[where], axis=1)
    factors = np.zeros((6, 3))
    for _ in range(6):
        kept = away <= max(3.0 * float(np.median(away)), 6.0)
        factors = np.linalg.lstsq(basis[kept], colors[kept], rcond=None)[0]
        away = np.linalg.norm(colors - basis @ factors, axis=1)
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


def _find_shadow(pixels: np.ndarray, ground: np.ndarray, tolerance: float) -> Bool[np.ndarray, "rows columns"]:
    """Find the pixels that are the ground times a number below one."""
    share = np.einsum("rcd,rcd->rc", pixels, ground) / np.maximum(np.einsum("rcd,rcd->rc", ground, ground), 1.0)
    off = np.linalg.norm(pixels - share[..., None] * ground, axis=2)
    darkest_shadow = 0.4
    return (off < tolerance) & (share < 1.0) & (share > darkest_shadow)


@dataclass(frozen=True)
class ShadedPart:
    """Part of the assumed body that has the color of the ground, only darker, as a shadow has."""

    share: float  # share of the body's pixels
    place: tuple[float, float]  # a pixel in the widest of it: column and row
    width: float  # width there [pixels]


def shaded_part(seen: Contrast, level: float) -> ShadedPart | None:
    """Return the part of the body that may be its shadow; None if it is small, or if the whole body is so dark."""
    body = seen.field > level
    shaded = body & seen.shaded
    depth = np.asarray(distance_transform_edt(shaded))
    shade_depth = 3.0  # pixels: along its edge every body is mixed with the ground
    wide = shaded & (depth > shade_depth)
    share = float(shaded.sum() / max(body.sum(), 1))
    outer = float(np.asarray(distance_transform_edt(body))[wide].min(initial=np.inf))
    shade_least, shade_most = 0.02, 0.5
    if not (wide.any() and shade_least < share < shade_most and outer < 2 * shade_depth):
        return None
    row, column = np.unravel_index(int(np.argmax(depth)), depth.shape)
    return ShadedPart(share, (float(column), float(row)), 2.0 * float(depth[row, column]))


_SECOND = 0.02
_HOLE = 0.01
_LINE = 0.03
_NOISE = 3

_Mask = Bool[np.ndarray, "rows columns"]


@dataclass(frozen=True)
class PixelPatch:
    """Connected part of a picture."""

    area: int  # [pixels]
    place: tuple[float, float]  # column and row of its center
    extent: float  # longest side of its box [pixels]


@dataclass(frozen=True, eq=False)
class Silhouette:
    """Body in a picture."""

    body: Ring  # outer ring of the body, columns and rows [pixels]
    holes: tuple[Ring, ...]  # rings of its holes
    specks: tuple[PixelPatch, ...]  # patches outside the body, too small to be intended
    filled: tuple[PixelPatch, ...]  # filled holes
    lines: bool  # True if drawn with lines only
    cut: bool  # True if the body reaches the border of the image


def count_covered_pixels(mask: _Mask) -> int:
    """Pixels of the largest part of a mask, its holes filled."""
    return max((patch.area for patch in _patches(_fill_holes(mask))[1]), default=0)


def silhouette(field: Field, level: float, faint: float, name: str) -> Silhouette:
    """Body in a picture: where the field is above a level, or within the lines where it is drawn with lines.

    Of all that stands out, the part that covers most with its holes filled is the body. Where hardly anything in it is
    thicker than a line, it is a line drawing: all within the outer line is body. Else parts of the ground inside it,
    where the field is surely `faint`, are holes, if they are larger than 1 % of it and hold nothing: the white of an
    eye holds a pupil. Parts outside are specks if they are smaller than 2 % of it. Raises OutlineError: nothing there,
    too small, a second body, or lines that do not close; it names the picture.
    """
    mask = field > level
    filled = _fill_holes(mask)
    labels, patches = _patches(filled)
    least_pixels = 200
    if not patches or max(patch.area for patch in patches) < least_pixels:
        raise OutlineError(f"{name}: no body is seen in the picture: draw or photograph it large on plain ground")
    body = labels == 1 + int(np.argmax([patch.area for patch in patches]))
    lines = _is_lines((field > faint) & body, body, name)
    holes, shut = (np.zeros_like(body), ()) if lines else _holes(body & ~mask, body, field <= faint)
    solid = body & ~holes
    inner, islands = _patches(solid)
    main = inner == 1 + int(np.argmax([patch.area for patch in islands]))
    specks = _specks(filled & ~main & ~holes, int(body.sum()), name)
    cut = bool(main[0].any() or main[-1].any() or main[:, 0].any() or main[:, -1].any())
    rings = _rings(_signed_field(field - level, main, mask), _is_stepped(field, level, main), int(body.sum()))
    return Silhouette(rings[0], tuple(rings[1:]), specks, shut, lines, cut)


def _fill_holes(mask: _Mask) -> _Mask:
    """Mask with its holes filled."""
    parts = _parts(np.pad(~mask, 1, constant_values=True), corners=False)
    return (parts != parts[0, 0])[1:-1, 1:-1]


def _parts(mask: _Mask, *, corners: bool) -> Int[np.ndarray, "rows columns"]:
    """Number of the connected part that each pixel belongs to, 0 outside; pixels that share a corner may connect."""
    parts = np.zeros(mask.shape, dtype=np.int64)
    label(mask, structure=np.ones((3, 3)) if corners else None, output=parts)
    return parts


def _depth(mask: _Mask) -> Field:
    """Distance [pixels] of each pixel of a mask from the outside."""
    return np.asarray(distance_transform_edt(mask), dtype=float)


def _patches(mask: _Mask) -> tuple[np.ndarray, list[PixelPatch]]:
    """Number of the connected part that each pixel belongs to, and the parts; corners connect."""
    labels = _parts(mask, corners=True)
    areas = np.bincount(labels.ravel())[1:]
    patches = []
    for area, (rows, columns) in zip(areas, find_objects(labels), strict=True):
        place = 0.5 * (columns.start + columns.stop - 1), 0.5 * (rows.start + rows.stop - 1)
        patches.append(PixelPatch(int(area), place, float(max(rows.stop - rows.start, columns.stop - columns.start))))
    return labels, patches


def _is_lines(drawn: _Mask, body: _Mask, name: str) -> bool:
    """Return True if a body is drawn with lines, most of its inside left as ground."""
    rows, columns = np.nonzero(body)
    extent = max(np.ptp(rows), np.ptp(columns)) + 1.0
    box = slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1)
    step = max(1, round(extent / 600))
    whole = np.pad(body[box], 1)[::step, ::step]
    width = 2.0 * step * float(_depth(whole).max())
    thin = 0.025
    if width < thin * extent:
        raise OutlineError(
            f"{name}: only a thin line is seen, {width:.3g} pixels wide: close the outline, or fill the body"
        )
    line = _LINE * float(np.sqrt(whole.sum()))
    thick = _depth(np.pad(drawn[box], 1)[::step, ::step]) > line
    opened = _depth(~thick) <= line if thick.any() else thick
    inked = 0.15
    return float((opened & whole).sum()) < inked * float(whole.sum())


def _holes(gaps: _Mask, body: _Mask, ground: _Mask) -> tuple[_Mask, tuple[PixelPatch, ...]]:
    """Find the gaps in a body that are holes in it, and those that are ground but too small, or hold something."""
    labels = _parts(gaps, corners=False)
    areas = np.bincount(labels.ravel())
    bare = np.bincount(labels.ravel(), weights=ground.ravel()) > 0.5 * areas  # else a pale part of the body
    open_ = bare & (areas >= _HOLE * body.sum())
    open_[0] = False
    for number in np.flatnonzero(open_):
        hole = labels == number
        held = _fill_holes(hole) & ~hole
        open_[number] = not _HOLE * areas[number] < held.sum() <= _SECOND * body.sum()
    bare[0] = False
    shut = _patches((bare & ~open_)[labels])[1]
    return open_[labels], tuple(patch for patch in shut if patch.area > _NOISE)


def _specks(mask: _Mask, body: int, name: str) -> tuple[PixelPatch, ...]:
    """Parts outside the body; an error unless all are small."""
    _, patches = _patches(mask)
    second = max(patches, key=lambda patch: patch.area, default=None)
    if second is not None and second.area > _SECOND * body:
        x, y = second.place
        raise OutlineError(
            f"{name}: a second shape, {100 * second.area / body:.2g} % as large as the body, lies apart from it "
            f"at pixel ({x:.0f}, {y:.0f}) from the top left: cut it away, or join the two"
        )
    return tuple(patch for patch in patches if patch.area > _NOISE)


def _signed_field(field: Field, main: _Mask, mask: _Mask) -> Field:
    """Field that is above 0 in the body and nowhere else, and crosses 0 where the picture does."""
    step = 1e-3 * max(float(np.ptp(field)), 1e-300)
    field = np.where(main & ~mask, step, field)
    return np.where(~main & mask, -step, field)


def _is_stepped(field: Field, level: float, main: _Mask) -> bool:
    """Return True if the border of the body runs along pixels, without half-tones that locate it within them."""
    values = field[main & (_depth(main) < 3.0)]
    top = float(np.quantile(values, 0.9))
    return float((values < level + 0.5 * (top - level)).mean()) < 0.05


def _rings(field: Field, stepped: bool, body: int) -> list[Ring]:
    """Ring round the body and those of its holes, smooth, with few corners; columns and rows [pixels]."""
    from contourpy import LineType, contour_generator

    field = np.pad(field, 1, constant_values=-float(np.ptp(field)))
    found = contour_generator(z=field, line_type=LineType.Separate).lines(0.0)
    rings = [np.asarray(ring)[:-1] - 1.0 for ring in found if len(ring) > 3]
    rings.sort(key=lambda ring: -Polygon(ring).area)
    rings = [ring for ring in rings if Polygon(ring).area > 0.3 * _HOLE * body]
    most_corners = 2000
    most = most_corners // (1 + len(rings[1:]) // 4)
    smooth = [_smooth(ring, 4.0 if stepped else 1.0, 0.4 if stepped else 0.15, most) for ring in rings]
    return smooth if Polygon(smooth[0], smooth[1:]).is_valid else rings  # a hole came too near to the outside


def _smooth(ring: Ring, reach: float, tolerance: float, most: int) -> Ring:
    """Ring without the grain of the pixels."""
    curve = Curve(ring)
    count = max(int(2 * curve.length), 16)
    even = curve.at(curve.length * np.arange(count) / count)
    while reach > 0.25:
        smooth = Polygon(gaussian_filter1d(even, 2.0 * reach, axis=0, mode="wrap"))
        allowed = tolerance
        while len(get_coordinates(smooth.simplify(allowed))) > most:
            allowed *= 1.5
        simple = smooth.simplify(allowed)
        if simple.is_valid:
            return get_coordinates(simple)[:-1]
        reach *= 0.5  # a neck of a few pixels has closed
    return ring
