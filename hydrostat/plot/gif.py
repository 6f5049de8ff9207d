"""`gif_bytes`: pictures as a GIF with one palette, of which each frame holds only what changes."""

from collections.abc import Iterable, Sequence
from io import BytesIO
from itertools import chain

import numpy as np
from jaxtyping import UInt8

from hydrostat.plot.frame_pictures import Picture

STAYS = 3.0
"""A pixel keeps its colour until it is off by more than this (of 255, in the channel that differs most): no eye tells,
and smooth shades of a body that moves do not flicker."""

Palette = UInt8[np.ndarray, "colours 3"]
Indices = UInt8[np.ndarray, "_ _"]


def gif_bytes(pictures: Iterable[Picture], palette: Palette, times: Sequence[int]) -> bytes:
    """A GIF of pictures of one size and their times [1/100 s] that plays for ever, in at most 255 colours.

    Pillow's own writer would repeat the palette in every frame and store pixels that stay, which makes files of this
    kind two to three times as large; the pixels of a frame are packed by it.
    """
    height = width = 0
    parts: list[bytes] = []
    last: Indices | None = None
    for picture, time in zip(pictures, times, strict=True):
        height, width, _ = picture.shape
        indices = _nearest(picture, palette)
        if last is None:
            box, shown = (0, 0, width, height), indices
        else:
            off = np.abs(palette[last].astype(np.int16) - picture).max(axis=2)
            stays = (off <= STAYS) | (indices == last)
            indices = np.where(stays, last, indices)
            box, shown = _changed(indices, last, len(palette))
        parts.append(_frame(shown, box, time, palette))
        last = indices
    return b"".join(chain([_head(width, height, palette)], parts, [b";"]))


def _nearest(picture: Picture, palette: Palette) -> Indices:
    """The number of the nearest colour for each pixel; without dithering, so that what rests keeps its pixels."""
    from scipy.spatial import KDTree

    packed = picture.astype(np.int64) @ np.array([65536, 256, 1])
    values, places = np.unique(packed, return_inverse=True)
    colours = np.stack([values >> 16, (values >> 8) & 255, values & 255], axis=1)
    nearest = KDTree(palette.astype(float)).query(colours.astype(float))[1].astype(np.uint8)
    return np.take(nearest, places).reshape(picture.shape[:2])


def _changed(indices: Indices, last: Indices, clear: int) -> tuple[tuple[int, int, int, int], Indices]:
    """The box of what changes: left, upper, right and lower end; and in it `clear` where a pixel stays."""
    rows, columns = np.nonzero(indices != last)
    if not len(rows):
        return (0, 0, 1, 1), np.full((1, 1), clear, dtype=np.uint8)
    left, upper, right, lower = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
    inside = slice(upper, lower), slice(left, right)
    shown = np.where(indices[inside] == last[inside], clear, indices[inside]).astype(np.uint8)
    return (int(left), int(upper), int(right), int(lower)), shown


def _head(width: int, height: int, palette: Palette) -> bytes:
    """Size, palette, and that it plays for ever."""
    bits = max(int(np.ceil(np.log2(len(palette) + 1))), 2)  # one number more than colours, for pixels that stay
    table = palette.tobytes().ljust(3 << bits, b"\0")
    size = width.to_bytes(2, "little") + height.to_bytes(2, "little")
    return b"GIF89a" + size + bytes([0x80 | (bits - 1), 0, 0]) + table + b"!\xff\x0bNETSCAPE2.0\x03\x01\0\0\0"


def _frame(shown: Indices, box: tuple[int, int, int, int], time: int, palette: Palette) -> bytes:
    left, upper, right, lower = box
    control = b"!\xf9\x04" + bytes([0x05]) + time.to_bytes(2, "little") + bytes([len(palette), 0])
    sides = [left, upper, right - left, lower - upper]
    return control + b"," + b"".join(side.to_bytes(2, "little") for side in sides) + b"\0" + _packed(shown)


def _packed(shown: Indices) -> bytes:
    """Pixels packed by Pillow: what follows the description of the image in a GIF of its own."""
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(shown), mode="L")
    buffer = BytesIO()
    image.save(buffer, format="GIF", optimize=False, interlace=False)
    whole = buffer.getvalue()
    start = 13 + (3 << ((whole[10] & 7) + 1))
    while whole[start : start + 1] == b"!":
        start = _after_blocks(whole, start + 2)
    return whole[start + 10 : _after_blocks(whole, start + 11)]


def _after_blocks(whole: bytes, start: int) -> int:
    """Place behind a chain of blocks that begins at `start`."""
    while whole[start]:
        start += whole[start] + 1
    return start + 1
