"""Outlines from pictures: photographs and drawings on plain ground."""

import io
import warnings
from typing import TYPE_CHECKING

import numpy as np
from shapely import Polygon, get_coordinates

from hydrostat.arrays import Float
from hydrostat.errors import OutlineError
from hydrostat.geometry.files.drawing_body import Inner, drawn_picture
from hydrostat.geometry.files.rings import Drawing, Page, one_line, outline_on_page, page_about
from hydrostat.geometry.files.silhouette import (
    Contrast,
    PixelPatch,
    ShadedPart,
    Silhouette,
    contrast,
    count_covered_pixels,
    fit_ground,
    shaded_part,
    silhouette,
)
from hydrostat.units import plural

if TYPE_CHECKING:
    from PIL.Image import Image


MAX_PIXELS = 50_000_000  # a picture with more pixels is refused

_BROKEN = (OSError, ValueError, TypeError, LookupError, SyntaxError, ArithmeticError, AttributeError, EOFError)


def read_image(
    content: bytes, name: str, size: float | None, page: Page | None, inner: Inner, part: int | None = None
) -> Drawing:
    """Read the outline of a body from a photograph or a drawing on plain ground, PNG or JPEG, with notes on omissions.

    A picture with transparent parts tells the body by them; else the body is what differs in color from the ground,
    darker or lighter, which is taken from the border of the picture and may change slowly across it. A drawing of lines
    is filled to the outer side of its outer line, and what is drawn inside plays no part. Elsewhere ground within the
    body is a hole if it is larger than 1 % of the body and nothing lies in it. A soft shadow is left out where the body
    is much stronger. The outline strays from the picture by about half a pixel, of at most 1600 along the longer side.
    A picture has no size of its own: `size` or `page` is needed; see `read_outline`. Raises OutlineError: no picture,
    too large, without size, or no single body on plain ground; the message says where.
    """
    if part not in (None, 1):
        raise OutlineError(f"{name}: parts are numbered in SVG and DXF drawings only: cut the picture to the body")
    pixels, step = _pixels(content, name)
    kind = f"a picture of {step * pixels.shape[1]} x {step * pixels.shape[0]} pixels"
    if page is not None:
        page.check(kind, name)
    found, shadow, notes = _find_body(pixels, name)
    if size is None and page is None:
        raise OutlineError(f'{name}: a picture has no physical size: give the longest side of the body, as "200 mm"')
    page = page or page_about(found.body, kind, (1.0, -1.0), size)
    outline, scale = outline_on_page(found.body, list(found.holes), page, name), page.scale[0]
    coarse = (f"read at one pixel in {step * step}: the outline is known to {1e3 * scale:.2g} mm",) if step > 1 else ()
    shade = (_describe_shade(shadow, page),) if shadow else ()
    drawing = Drawing(outline, page, (*notes, *shade, *_notes(found, page), *coarse))
    return drawn_picture(drawing) if inner is Inner.DRAWN else drawing


def _pixels(content: bytes, name: str) -> tuple[Float[np.ndarray, "rows columns 4"], int]:
    """Red, green, blue and opacity from 0 to 255, upright, and the number of file pixels per pixel along each side."""
    from PIL import Image, ImageOps

    longest = 1600
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(content), formats=("PNG", "JPEG")) as image:
                columns, rows = image.size
                if columns * rows > MAX_PIXELS:
                    raise _too_large(name, f"{columns} x {rows}")
                step = max(1, -(-max(columns, rows) // longest))
                ImageOps.exif_transpose(image, in_place=True)
                return _plain(image, step), step
    except Image.DecompressionBombError as error:
        raise _too_large(name, "far too many") from error
    except Image.UnidentifiedImageError as error:
        raise OutlineError(f"{name}: neither PNG nor JPEG, whatever its name says: save it as one of them") from error
    except OutlineError:
        raise
    except _BROKEN as error:
        raise OutlineError(f"{name}: cannot be read as a picture ({one_line(error)}): save it again") from error


def _too_large(name: str, pixels: str) -> OutlineError:
    return OutlineError(
        f"{name}: the picture has {pixels} pixels, at most {MAX_PIXELS / 1e6:.0f} million are read: make it smaller"
    )


def _plain(image: "Image", step: int) -> Float[np.ndarray, "rows columns 4"]:
    """Pixels of any mode of image as red, green, blue and opacity, averaged over squares of `step`."""
    from PIL import Image

    if image.mode.startswith(("I", "F")):
        values = np.asarray(image, dtype=float)
        top = max(float(np.max(values, initial=0.0)), 1.0)
        image = Image.fromarray((255.0 * np.clip(values / top, 0.0, 1.0)).astype(np.uint8))
    if image.has_transparency_data:
        # Through premultiplied colors, so that what hides in transparent pixels plays no part.
        colored = image if image.mode == "RGBA" else image.convert("RGBA")
        colored = colored.convert("RGBa").reduce(step).convert("RGBA") if step > 1 else colored
    else:
        colored = image.convert("RGB").reduce(step).convert("RGBA")
    return np.asarray(colored, dtype=float)


def _find_body(
    pixels: Float[np.ndarray, "rows columns 4"], name: str
) -> tuple[Silhouette, ShadedPart | None, tuple[str, ...]]:
    """Return the body in a picture, its possible shadow, and a note on the contrast with its ground."""
    opacity = pixels[..., 3]
    if float((opacity < 128.0).mean()) > 0.005:
        return silhouette(opacity, 127.5, 127.5, name), None, ()
    if min(opacity.shape) < 8:
        raise OutlineError(
            f"{name}: the picture is too small, {opacity.shape[1]} x {opacity.shape[0]} pixels: take a larger one"
        )
    found, shadow, notes = _find_on_ground(pixels[..., :3], name)
    bare = leave_table_out(pixels[..., :3], found)
    if bare is None:
        return found, shadow, notes
    try:
        drawn, shade, more = _find_on_ground(bare, name)
    except OutlineError:  # a body that looks like a sheet
        return found, shadow, notes
    least_drawn = 0.03
    if Polygon(drawn.body).area < least_drawn * Polygon(found.body).area:
        return found, shadow, notes
    return drawn, shade, ("a sheet of paper was taken for the ground, and the table around it left out", *more)


def _find_on_ground(
    pixels: Float[np.ndarray, "rows columns 3"], name: str
) -> tuple[Silhouette, ShadedPart | None, tuple[str, ...]]:
    """Return the same for a picture without transparent parts (OutlineError: its ground is not plain)."""
    seen = contrast(pixels)
    edge = 0.35
    uneven = 80.0
    if seen.edge > edge or seen.faint > uneven:
        raise OutlineError(
            f"{name}: the ground is not plain: put the body on a sheet of one color, away from the picture's border, "
            "or cut it out"
        )
    level, shadow = _body_level(seen)
    note = ("a grey part beside the body was taken for its shadow and left out",) if shadow else ()
    return silhouette(seen.field, level, seen.faint, name), shaded_part(seen, level), note


def _describe_shade(found: ShadedPart, page: Page) -> str:
    """Note on the part of the body that may be its shadow."""
    x, y = found.place[0] - page.origin[0], page.origin[1] - found.place[1]
    scale = 1e3 * page.scale[0]
    where = f"up to {scale * found.width:.2g} mm wide about ({scale * x:.0f}, {scale * y:.0f}) mm"
    return (
        f"{found.share:.0%} of the body has the color of the ground, only darker, {where}: if that is a shadow, the "
        "outline is as much off; take the picture in even light, or draw over it"
    )


def _body_level(seen: Contrast) -> tuple[float, bool]:
    """Contrast at which the body begins, and True if a shadow lies below it."""
    faint, strong = count_covered_pixels(seen.field > seen.faint), count_covered_pixels(seen.field > seen.strong)
    if faint < 1.1 * strong or strong == 0:
        return seen.strong, False
    between = (seen.field > seen.faint) & (seen.field <= seen.strong)
    if faint < 3.0 * strong and float(seen.shaded[between].mean()) > 0.7:
        return seen.strong, True
    return 0.5 * (seen.faint + min(seen.strong, 3.0 * seen.faint)), False


def _notes(found: Silhouette, page: Page) -> tuple[str, ...]:
    """Describe omitted, filled or assumed parts, a line each."""
    notes = []
    if found.lines:
        notes.append("a drawing of lines: filled to its outer line, what is drawn inside plays no part")
    if found.cut:
        notes.append("the body reaches the border of the picture and is cut off there")
    if found.filled:
        notes.append(f"filled {plural(len(found.filled), 'hole')}, {_largest(found.filled, page)}")
    if found.specks:
        notes.append(f"left out {plural(len(found.specks), 'speck')} beside the body, {_largest(found.specks, page)}")
    if found.holes:
        notes.append(f"kept {plural(len(found.holes), 'hole')}")
    return tuple(notes)


def _largest(patches: tuple[PixelPatch, ...], page: Page) -> str:
    """Describe the largest of some patches: its position and size, in millimeters of the body."""
    patch, scale = max(patches, key=lambda one: one.area), page.scale[0]
    x, y = patch.place[0] - page.origin[0], page.origin[1] - patch.place[1]
    across, where = 1e3 * scale * patch.extent, [round(1e3 * scale * value, 1) + 0.0 for value in (x, y)]
    return f"the largest {across:.2g} mm across at ({where[0]:.1f}, {where[1]:.1f}) mm"


_SHARE = 0.3  # of the picture that a sheet covers at least
_MARGIN = 0.02  # of its longer side: at its edge, paper is shaded or curled


def leave_table_out(
    pixels: Float[np.ndarray, "rows columns 3"], found: Silhouette
) -> Float[np.ndarray, "rows columns 3"] | None:
    """Return the picture with the color of the paper in place of all around a sheet; None if the body is no sheet.

    A sheet is pale, large, and bounded by at most seven straight lines: four sides, cut at corners of the picture.
    """
    from PIL import Image, ImageDraw

    shape = Polygon(found.body)
    extent = float(np.ptp(found.body, axis=0).max())
    hull = shape.convex_hull
    corners = len(get_coordinates(hull.simplify(_MARGIN * extent))) - 1
    most_corners, straight = 7, 0.96
    if corners > most_corners or shape.area < max(straight * hull.area, _SHARE * pixels[..., 0].size):
        return None
    sheet = hull.buffer(-_MARGIN * extent)
    canvas = Image.new("1", pixels.shape[1::-1])
    ImageDraw.Draw(canvas).polygon([tuple(place) for place in get_coordinates(sheet)], fill=1)
    inside = np.asarray(canvas, dtype=bool)
    paper, around = np.median(pixels[inside], axis=0), np.median(pixels[~inside], axis=0)
    most_colored = 60.0
    if np.ptp(paper) > most_colored or paper.mean() < around.mean():
        return None
    return np.where(inside[..., None], pixels, fit_ground(pixels, inside, paper)[0])
