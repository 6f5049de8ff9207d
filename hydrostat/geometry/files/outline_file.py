"""Outlines from any kind of flat file."""

from functools import lru_cache
from pathlib import PurePath

import numpy as np
from shapely.errors import GEOSException

from hydrostat.errors import GIVE_SIZE, InputError, OutlineError
from hydrostat.files import MAX_DRAWN_BYTES
from hydrostat.geometry.files.drawing_body import Inner
from hydrostat.geometry.files.rings import Drawing, Page, one_line
from hydrostat.geometry.outline import Outline

MAX_SIZE = 20.0
"""Longest side of a drawn body [m]; what is longer has the wrong unit."""

OUTLINE_SUFFIXES = tuple(MAX_DRAWN_BYTES)  # names of files that outlines are read from end in one of these


def read_outline(
    content: bytes,
    *,
    name: str,
    size: float | None = None,
    page: Page | None = None,
    inner: Inner = Inner.HOLES,
    part: int | None = None,
) -> Outline:
    """Read the outline of a body [m] from a drawing or a picture; its name says which kind it is, and stands in errors.

    The x axis points right, y up, the origin is the center of the bounding box or that of the `page`: of another
    drawing, which this one was drawn over. `size` is the longest side of the bounding box [m], not needed where the
    file has a unit. `inner` says whether shapes in the body are holes, or drawn on it. `part` is the number of the
    closed shape that is the body, the largest area is 1; the reader chooses if it is left out.

    Raises:
        OutlineError: no kind of file that is read, or no body can be made of it; the message says why.
        InputError: `size` is not positive, or there is a page as well.
    """
    return read_drawing(content, name=name, size=size, page=page, inner=inner, part=part).outline


def read_drawing(
    content: bytes,
    *,
    name: str,
    size: float | None = None,
    page: Page | None = None,
    inner: Inner = Inner.HOLES,
    part: int | None = None,
) -> Drawing:
    """Read the outline of a body, with notes on omissions; otherwise as `read_outline`.

    The last drawing is kept: who makes a robot of one reads it several times.
    """
    return _read_drawing(content, name, size, page, inner, part)


@lru_cache(maxsize=1)
def _read_drawing(
    content: bytes, name: str, size: float | None, page: Page | None, inner: Inner, part: int | None
) -> Drawing:
    if size is not None and page is not None:
        raise InputError(f"{name}: a drawing on the page of another has its size from there: leave the size out")
    if size is not None and not 0.0 < size < np.inf:
        raise InputError(f"{name}: the size must be positive, not {size} m")
    suffix = PurePath(name).suffix.lower()
    if suffix not in OUTLINE_SUFFIXES:
        raise OutlineError(
            f"{name}: outlines are read from SVG, DXF, PNG and JPG files: save the drawing as one of these"
        )
    if not content.strip():
        raise OutlineError(f"{name}: the file is empty: save it again")
    if len(content) > MAX_DRAWN_BYTES[suffix]:
        raise OutlineError(
            f"{name}: the file has {len(content) / 1e6:.0f} MB, "
            f"at most {MAX_DRAWN_BYTES[suffix] / 1e6:.0f} MB are read: "
            "save the outline alone, or a smaller picture"
        )
    if suffix == ".svg":
        from hydrostat.geometry.files.svg import read_svg as read
    elif suffix == ".dxf":
        from hydrostat.geometry.files.dxf import read_dxf as read
    else:
        from hydrostat.geometry.files.image import read_image as read
    try:
        drawing = read(content, name, size, page, inner, part)
    except GEOSException as error:
        raise OutlineError(f"{name}: its shapes cannot be sorted ({one_line(error)}): simplify the drawing") from None
    if size is None and page is None and drawing.outline.size > MAX_SIZE:
        long = f"{drawing.outline.size:.4g} m long"
        raise OutlineError(f"{name}: would be {long}, as its unit says (at most {MAX_SIZE:g} m): {GIVE_SIZE}")
    return drawing
