"""`Backdrop`, `cut_out`: a picture behind the outline that was read from it, and cut out as a person has it."""

import io
from base64 import b64encode
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageOps
from scipy.ndimage import gaussian_filter

from hydrostat.geometry import Outline, contrast, read_drawing
from hydrostat.studio.starting.draft import PhotoReading

SHOWN = 900  # and shown with so many


@dataclass(frozen=True, kw_only=True)
class Backdrop:
    """A picture where it lies about the body."""

    address: str  # of it, with all its bytes in it
    left: float  # edge of it, to the right of the middle of the body [mm]
    top: float  # edge of it, up from the middle [mm]
    wide: float  # of it [mm]
    high: float  # of it [mm]


def cut_out(content: bytes, reading: PhotoReading) -> bytes:
    """The picture as a PNG that is see-through where the body is not, as a person has it read."""
    image = _upright(content)
    if image.has_transparency_data:
        field, level = np.asarray(image.convert("RGBA"), dtype=float)[..., 3], 127.5
    else:
        seen = contrast(np.asarray(image.convert("RGB"), dtype=float))
        field, level = seen.field, seen.strong
    if reading.threshold is not None:
        level = reading.threshold
    if reading.smoothing > 0:
        field = gaussian_filter(field, reading.smoothing)
    cut = image.convert("RGBA")
    slope = 4.0  # opacity for each step of color about the threshold
    opacity = np.clip(127.5 + slope * (field - level), 0.0, 255.0)
    cut.putalpha(Image.fromarray(opacity.astype(np.uint8)))
    return _bytes(cut, "PNG")


def backdrop(content: bytes, read: bytes, *, name: str, size: float | None) -> Backdrop:
    """The picture behind the outline that is read from the second, which is as large (InputError: no body)."""
    image = _upright(content)
    page = read_drawing(read, name=name, size=size).page
    scale = 1e3 * page.scale[0]
    columns, rows = image.size
    shown = image.convert("RGB")
    shown.thumbnail((SHOWN, SHOWN))
    address = "data:image/jpeg;base64," + b64encode(_bytes(shown, "JPEG")).decode()
    left, top = -(page.origin[0] + 0.5) * scale, (page.origin[1] + 0.5) * scale
    return Backdrop(address=address, left=left, top=top, wide=columns * scale, high=rows * scale)


def overlay(behind: Backdrop, outline: Outline) -> str:
    """The picture with the outline over it, as SVG."""
    rings = [1e3 * ring * (1.0, -1.0) for ring in outline.rings]
    path = " ".join("M" + " L".join(f"{x:.2f},{y:.2f}" for x, y in ring) + "Z" for ring in rings)
    box = f"{behind.left:.3f} {-behind.top:.3f} {behind.wide:.3f} {behind.high:.3f}"
    image = f'<image x="{behind.left:.3f}" y="{-behind.top:.3f}" width="{behind.wide:.3f}" height="{behind.high:.3f}"'
    line = 'fill="none" stroke-linejoin="round" vector-effect="non-scaling-stroke"'
    return (
        f'<svg viewBox="{box}" role="img" aria-label="The outline over the picture" style="width:100%">'
        f'{image} href="{behind.address}" preserveAspectRatio="none"/>'
        f'<path d="{path}" {line} stroke="#ffffff" stroke-width="4" opacity="0.8"/>'
        f'<path d="{path}" {line} stroke="#c8243f" stroke-width="1.8"/></svg>'
    )


def _upright(content: bytes) -> Image.Image:
    """The picture as a person holds it, with as many pixels as it is read with."""
    image = ImageOps.exif_transpose(Image.open(io.BytesIO(content), formats=("PNG", "JPEG")))
    longest = 1600  # a picture is read with so many pixels along its longer side, as `read_image` does
    step = max(1, -(-max(image.size) // longest))
    if step > 1:
        image = image.convert("RGBA" if image.has_transparency_data else "RGB").reduce(step)
    return image


def _bytes(image: Image.Image, kind: str) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, kind)
    return buffer.getvalue()
