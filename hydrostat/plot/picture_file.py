"""From a figure to bytes: PNG files, and SVG that lies within a page. The same figure gives the same bytes."""

import html
import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.text import Text

from hydrostat.arrays import UInt8
from hydrostat.drawing import Color
from hydrostat.files import replace_file
from hydrostat.plot.labels import HALO
from hydrostat.plot.sheet import BODY


def save_png(figure: Figure, path: str | Path, *, dpi: float = 200) -> Path:
    """Write a figure on white paper as PNG, whole or not at all; returns its path."""
    buffer = io.BytesIO()
    with drawing(), _text_halo(figure):
        look: dict[str, Any] = {"facecolor": Color.PAPER, "metadata": {"Software": None}}
        figure.savefig(buffer, format="png", dpi=dpi, pil_kwargs={"compress_level": _COMPRESSION}, **look)
    return replace_file(Path(path), buffer.getvalue())


_COMPRESSION = 4
"""Level of PNG files, 0 to 9: a third faster than the usual 6, for files 1 to 4 % larger."""


def inline_svg(figure: Figure, *, name: str, label: str) -> str:
    """A figure as an `<svg>` element; its quiet colors and its letters follow the page.

    The name is unique in the page, so that inner references do not meet; the label is for who cannot see it.
    """
    buffer = io.StringIO()
    with drawing(salt=name), _sharp(figure):
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(rf' id="{HALO}"', f' class="{HALO}"', text)
    text = re.sub(r' id="(?:figure|axes|patch|line2d|text|matplotlib\.axis|xtick|ytick|PathCollection)_\d+"', "", text)
    text = re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL)
    text = re.sub(r"font-family: [^;]*;", "", text)
    text = re.sub(r"font: ([^;\"]*?px) [^;\"]*", r"font: \1 var(--figure-font, sans-serif)", text)
    text = re.sub(r"<style.*?</style>", "", text, flags=re.DOTALL)
    text = re.sub(r' (d|points|transform)="([^"]*)"', _shorter, text)
    text = re.sub(r">\s+<", "><", text).replace("<g/>", "").replace("<defs></defs>", "")
    for color, variable in Color.PAGE.items():
        text = text.replace(color, f"var(--{variable}, {color})")
    box = re.search(r'viewBox="[^"]*"', text)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" {box[0] if box else ""}'
    head += f' class="figure" role="img" aria-label="{html.escape(label)}">'
    return re.sub(r"<svg[^>]*>", lambda _: head, text, count=1).strip()


def figure_pixels(figure: Figure, *, dpi: float | None = None) -> UInt8[np.ndarray, "_ _ 4"]:
    """Red, green, blue and cover of each pixel of a figure, the top row first."""
    if dpi is not None:
        figure.set_dpi(dpi)
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    with drawing():
        canvas.draw()
    return np.asarray(canvas.buffer_rgba()).copy()


@contextmanager
def _sharp(figure: Figure) -> Iterator[None]:
    """Images of bodies pixel by pixel, while an SVG is made; else they would be sampled again, and coarser."""
    images = [image for axes in figure.axes for image in axes.images if image.get_label() == BODY]
    for image in images:
        image.set_interpolation("none")
    try:
        yield
    finally:
        for image in images:
            image.set_interpolation("antialiased")


def _shorter(match: re.Match[str]) -> str:
    """An attribute of numbers, to a hundredth of a point and on one line."""
    numbers = re.sub(r"-?\d+\.\d+", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), match[2])
    return f' {match[1]}="{" ".join(numbers.split())}"'


@contextmanager
def drawing(salt: str = "hydrostat") -> Iterator[None]:
    """Settings for drawing; a letter that the font lacks is drawn as a box, without a warning."""
    settings: Any = {"svg.fonttype": "none", "svg.hashsalt": salt, "font.family": ["DejaVu Sans"]}
    settings["path.simplify"] = False
    with rc_context(settings), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        yield


@contextmanager
def _text_halo(figure: Figure) -> Iterator[None]:
    """Words with a border of paper around their letters, while a PNG is made; a page does this by its style."""
    texts = [text for text in figure.findobj(Text) if text.get_gid() == HALO]
    for text in texts:
        text.set_path_effects([withStroke(linewidth=2.4, foreground=Color.PAPER, alpha=0.9)])
    try:
        yield
    finally:
        for text in texts:
            text.set_path_effects([])
