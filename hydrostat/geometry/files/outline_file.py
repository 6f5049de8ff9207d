"""Outlines from any kind of flat file."""

from pathlib import PurePath

from hydrostat.errors import InputError, OutlineError
from hydrostat.geometry.files.page import Drawing, Page
from hydrostat.geometry.outline import Outline

OUTLINE_SUFFIXES = (".svg", ".dxf", ".png", ".jpg", ".jpeg")
"""Names of files that outlines are read from end in one of these."""


def read_outline(content: bytes, *, name: str, size: float | None = None, page: Page | None = None) -> Outline:
    """Read the outline of a body from a drawing or a picture; its name says which kind it is.

    Args:
        content: the bytes of the file.
        name: its name, which errors call it.
        size: longest side of the body's bounding box [m]; not needed where the file has a unit.
        page: of another drawing, which this one was drawn over; it says the size and where the origin is.

    Returns:
        The outline [m], x to the right, y up, origin at the centre of its bounding box, or that of the page.

    Raises:
        OutlineError: no kind of file that is read, or no body can be made of it; the message says why.
        InputError: `size` is not positive, or there is a page as well.
    """
    return read_drawing(content, name=name, size=size, page=page).outline


def read_drawing(content: bytes, *, name: str, size: float | None = None, page: Page | None = None) -> Drawing:
    """Read the outline of a body, and in words what was left out; all else is as in `read_outline`."""
    if size is not None and page is not None:
        raise InputError(f"{name}: a drawing on the page of another has its size from there: leave the size out")
    suffix = PurePath(name).suffix.lower()
    if suffix == ".svg":
        from hydrostat.geometry.files.svg import svg_drawing

        return svg_drawing(content, name=name, size=size, page=page)
    if suffix == ".dxf":
        from hydrostat.geometry.files.dxf import dxf_drawing

        return dxf_drawing(content, name=name, size=size, page=page)
    if suffix in OUTLINE_SUFFIXES:
        from hydrostat.geometry.files.image import image_drawing

        return image_drawing(content, name=name, size=size, page=page)
    raise OutlineError(f"{name}: outlines are read from SVG, DXF, PNG and JPG files: save the drawing as one of these")
