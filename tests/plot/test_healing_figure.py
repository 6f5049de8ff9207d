"""A surface beside what healing made of it, and many robots on one sheet."""

from pathlib import Path

import numpy as np
import pytest
from builders import box_mesh
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from hydrostat import plot
from hydrostat.drawing import Color
from hydrostat.geometry import Surface
from hydrostat.plot.healing_figure import _bad_edges, _weld


def whole() -> Surface:
    mesh = box_mesh((6, 4, 3), size=(0.1, 0.05, 0.03))
    return Surface(mesh.nodes, mesh.boundary)


def soup(surface: Surface, *, away: int = 0, over: int = 0) -> Surface:
    """Triangles with vertices of their own; some of those on top taken away or turned over."""
    triangles = surface.triangles.copy()
    heights = surface.vertices[triangles][..., 2].min(axis=1)
    top = np.flatnonzero(heights > 0.0299)
    triangles[top[away : away + over]] = triangles[top[away : away + over], ::-1]
    triangles = np.delete(triangles, top[:away], axis=0)
    return Surface(surface.vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))


def reds(figure: Figure) -> int:
    """Pixels of about the color of errors."""
    figure.set_dpi(80)
    figure.set_facecolor("white")
    figure.canvas.draw()  # pyright: ignore[reportAttributeAccessIssue]
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)  # pyright: ignore[reportAttributeAccessIssue]
    return int(((pixels[..., 0] - pixels[..., 1] > 90) & (pixels[..., 0] > 150)).sum())


def test_edges_that_do_not_agree() -> None:
    """Oracle: counting. A closed box has none, a triangle away or turned over leaves three, welded or not."""
    assert len(_bad_edges(_weld(whole()))) == 0
    assert len(_bad_edges(_weld(soup(whole())))) == 0
    assert len(_bad_edges(_weld(soup(whole(), away=1)))) == 3
    assert len(_bad_edges(_weld(soup(whole(), over=1)))) == 3


@pytest.mark.slow
def test_what_is_wrong_is_red() -> None:
    """Oracle: a sound surface shows no red, and more red the more is wrong."""
    after = whole()
    counts = [reds(plot.draw_healing(soup(after, away=n, over=n), after, width=3.2)) for n in (0, 2, 8)]
    assert counts[0] == 0
    assert 50 < counts[1] < counts[2]


def test_places_are_ringed_on_the_first_view_only() -> None:
    """Oracle: the place as the picture's camera sees it lies left of the middle."""
    after = whole()
    figure = plot.draw_healing(after, after, places=np.array([[0.12, 0.02, 0.03]]))
    rings = [line for line in figure.axes[0].lines if line.get_markeredgecolor() == Color.ERROR]
    assert len(rings) == 1
    assert np.asarray(rings[0].get_xdata())[0] < np.mean(figure.axes[0].get_xlim())


def test_notes_and_counts_are_written_within_the_picture() -> None:
    """Oracle: matplotlib's own measure of every text."""
    after = whole()
    long = "a part of 0.2 cm^3 at (50, 120, 20) mm was removed: " + "it is far away and small, " * 6
    figure = plot.draw_healing(soup(after, away=2), after, notes=["one hole was closed", long], title="box.stl")
    figure.canvas.draw()  # pyright: ignore[reportAttributeAccessIssue]
    texts = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    words = " ".join(text.get_text() for text in texts)
    assert "one hole was closed" in words
    assert "as it came" in words
    assert f"{len(after.triangles) - 2} triangles" in words
    for text in texts:
        box = text.get_window_extent()
        assert box.x0 >= -1, text
        assert box.y0 >= -1, text
        assert box.x1 <= figure.bbox.x1 + 1, text
        assert box.y1 <= figure.bbox.y1 + 1, text


@pytest.mark.parametrize("width", [3.0, 6.4])
def test_a_hundred_notes_do_not_fill_the_page(width: float) -> None:
    """Oracle: the picture is no taller than twice its width, and what is left out and written is all there is."""
    notes = [f"part {number} was removed" for number in range(100)]
    figure = plot.draw_healing(whole(), whole(), notes=notes, width=width)
    assert figure.get_size_inches()[1] < 2 * width
    texts = [text.get_text() for text in figure.axes[0].texts]
    written = sum(text.startswith("part") for text in texts)
    assert 3 < written < 40
    assert f"... and {100 - written} lines more" in texts


def test_places_close_together_have_one_ring() -> None:
    after = whole()
    places = np.array([[0.12, 0.02, 0.03], [0.1201, 0.02, 0.03], [0.02, 0.02, 0.06]])
    figure = plot.draw_healing(after, after, places=places)
    (rings,) = (line for line in figure.axes[0].lines if line.get_markeredgecolor() == Color.ERROR)
    assert len(np.asarray(rings.get_xdata())) == 2


@pytest.mark.parametrize("size", [(0.01, 0.01, 0.2), (0.2, 0.01, 0.01), (1e-4, 1e-4, 1e-4), (3.0, 2.0, 1.0)])
def test_bodies_of_any_shape_and_size(size: tuple[float, float, float], tmp_path: Path) -> None:
    mesh = box_mesh((2, 2, 2), size=size)
    surface = Surface(mesh.nodes, mesh.boundary)
    path = plot.save_png(plot.draw_healing(surface, surface, width=3.2), tmp_path / "a.png", dpi=50)
    with Image.open(path) as image:
        assert len(image.convert("RGB").getcolors(1 << 20) or []) > 50


def test_a_surface_without_area_is_drawn_as_nothing_rather_than_failing() -> None:
    flat = Surface(np.array([[0.0, 0, 0], [0.1, 0, 0], [0.1, 0, 0]]), np.array([[0, 1, 2]]))
    assert plot.draw_healing(flat, whole()).axes
