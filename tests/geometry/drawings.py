"""Drawings and pictures made in code, as the bytes of files."""

import io
from collections.abc import Callable, Iterator

import ezdxf
import numpy as np
from ezdxf.document import Drawing as Document
from ezdxf.layouts import Modelspace
from PIL import Image, ImageDraw

Draw = Callable[[ImageDraw.ImageDraw, int], object]
"""Draws on a canvas that has so many dots to a pixel."""


def dxf(draw: Callable[[Modelspace, Document], object], unit: int = 4) -> bytes:
    """A DXF drawing; its unit is a millimeter unless told otherwise."""
    document = ezdxf.new()
    document.header["$INSUNITS"] = unit
    draw(document.modelspace(), document)
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def canvas(*draws: Draw, size: tuple[int, int] = (600, 600), ground: object = "white", fine: int = 4) -> Image.Image:
    """A picture with half-tones along its edges."""
    mode = "RGBA" if isinstance(ground, tuple) and len(ground) == 4 else "RGB"
    image = Image.new(mode, (size[0] * fine, size[1] * fine), ground)  # pyright: ignore[reportArgumentType]
    for draw in draws:
        draw(ImageDraw.Draw(image), fine)
    return image.resize(size, Image.Resampling.BOX)


def picture(image: Image.Image, kind: str = "PNG", **options: object) -> bytes:
    """The bytes of a picture."""
    stream = io.BytesIO()
    image.save(stream, kind, **options)
    return stream.getvalue()


def lit(image: Image.Image, depth: float) -> Image.Image:
    """The picture under light that fades to one side, by the share `depth`."""
    across = np.linspace(0, 1, image.width)[None, :, None] * np.linspace(0.4, 1, image.height)[:, None, None]
    return _image(np.asarray(image, dtype=float) * (1.0 - depth * across))


def noisy(image: Image.Image, spread: float) -> Image.Image:
    """The picture with noise in each pixel, always the same."""
    pixels = np.asarray(image, dtype=float)
    return _image(pixels + np.random.default_rng(5).normal(0.0, spread, pixels.shape))


def shadowed(image: Image.Image, body: Image.Image, depth: float) -> Image.Image:
    """The picture with a soft shadow of the body (white on black) beside it."""
    from PIL import ImageFilter

    shade = np.asarray(body.convert("L").filter(ImageFilter.GaussianBlur(10)), dtype=float)
    shade = np.roll(shade, (20, 20), (0, 1)) * (255.0 - np.asarray(body.convert("L"), dtype=float)) / 255.0**2
    return _image(np.asarray(image, dtype=float) * (1.0 - depth * shade[..., None]))


def _image(pixels: np.ndarray) -> Image.Image:
    return Image.fromarray(np.clip(np.round(pixels), 0, 255).astype(np.uint8))


def disc(color: object, radius: float = 250.0, at: tuple[float, float] = (300.0, 300.0)) -> Draw:
    """A disc; Pillow counts the last dot in, so it ends half a dot earlier."""
    (x, y), r = at, radius
    return lambda draw, fine: draw.ellipse(
        [(x - r) * fine, (y - r) * fine, (x + r) * fine - 1, (y + r) * fine - 1],
        fill=color,  # pyright: ignore[reportArgumentType]
    )


def shape(points: np.ndarray, color: object) -> Draw:
    """A filled polygon of corners (corners, 2)."""
    return lambda draw, fine: draw.polygon([(fine * x, fine * y) for x, y in points], fill=color)  # pyright: ignore[reportArgumentType]


def star(corners: int = 5, outer: float = 260.0, inner: float = 120.0, at: float = 300.0) -> np.ndarray:
    """Corners of a star, one tip at the top, y down."""
    angle = np.arange(2 * corners) * np.pi / corners
    radius = np.where(np.arange(2 * corners) % 2 == 0, outer, inner)
    return at + np.column_stack([radius * np.sin(angle), -radius * np.cos(angle)])


def fish(draw: ImageDraw.ImageDraw, fine: int, width: int = 6, ink: object = "black") -> None:
    """A fish of lines: an ellipse, an eye, a pupil and a mouth."""
    line = {"outline": ink, "width": width * fine}
    draw.ellipse([60 * fine, 180 * fine, 540 * fine - 1, 420 * fine - 1], **line)  # pyright: ignore[reportArgumentType]
    draw.ellipse([420 * fine, 240 * fine, 470 * fine, 290 * fine], **line)  # pyright: ignore[reportArgumentType]
    draw.ellipse([438 * fine, 258 * fine, 454 * fine, 274 * fine], fill=ink)  # pyright: ignore[reportArgumentType]
    draw.arc([420 * fine, 310 * fine, 500 * fine, 370 * fine], 30, 150, fill=ink, width=width * fine)  # pyright: ignore[reportArgumentType]


def mutants(good: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Files with bytes flipped, cut off, repeated, or left out, always the same ones."""
    random = np.random.default_rng(seed)
    for number in range(count):
        bad = bytearray(good)
        if number % 4 == 0:
            for place in random.integers(0, len(bad), random.integers(1, 30)):
                bad[place] = random.integers(0, 256)
        elif number % 4 == 1:
            del bad[random.integers(0, len(bad)) :]
        elif number % 4 == 2:
            start = random.integers(0, len(bad))
            bad[start:start] = bad[start : start + random.integers(1, 4000)] * 3
        else:
            start = random.integers(0, len(bad))
            del bad[start : start + random.integers(1, 200)]
        yield bytes(bad)
