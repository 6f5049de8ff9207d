"""Pages of a pattern, as other people's programs see and print them."""

import io
import shutil
import subprocess
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image
from plush_robots import SQUARE, crossed, drawn_body, plush_robot
from pypdf import PdfReader, PdfWriter, Transformation
from scipy import ndimage

from hydrostat.fabrication import plush_pattern
from hydrostat.fabrication.kit_options import Paper
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Circle, LaserLine, Layer, PatternPart
from hydrostat.fabrication.sheets.tiles import Tile, tile_grid, tiled_pdf

SIZES = {Paper.A4: (210.0, 297.0), Paper.LETTER: (215.9, 279.4), Paper.A3: (297.0, 420.0)}
PIXEL = 25.4 / 300

needs_poppler = pytest.mark.skipif(shutil.which("pdftoppm") is None, reason="pdftoppm of poppler is not installed")


def read(content: bytes) -> PdfReader:
    return PdfReader(io.BytesIO(content))


def printed(content: bytes, page: int, folder: Path) -> np.ndarray:
    """A page as poppler prints it at 300 pixels an inch, (rows, columns, 3)."""
    (folder / "pages.pdf").write_bytes(content)
    command = ["pdftoppm", "-r", "300", "-f", str(page), "-l", str(page), "-png", "-singlefile", "pages.pdf", "page"]
    subprocess.run(command, cwd=folder, check=True, timeout=300)
    with Image.open(folder / "page.png") as image:
        return np.asarray(image.convert("RGB")).astype(int)


def bar_length(page: np.ndarray) -> float:
    """The longest dark run of the lowest part of a page, end to end [mm]."""
    dark = page[round((len(page) * PIXEL - 24) / PIXEL) :].sum(axis=2) < 380
    longest = 0
    for row in dark:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], row, [0]])))
        longest = max([longest, *(edges[1::2] - edges[::2]).tolist()])
    return longest * PIXEL


def blue_places(page: np.ndarray) -> np.ndarray:
    """Middles of all that is blue [mm], x to the right, y up from the lower edge."""
    blue = (page[..., 2] - page[..., 0] > 60) & (page[..., 2] - page[..., 1] > 60)
    names, count = ndimage.label(blue, structure=np.ones((3, 3)))
    boxes = [(rows, columns) for rows, columns in ndimage.find_objects(names)]
    assert count == len(boxes)
    return PIXEL * np.array([((c.start + c.stop) / 2, len(page) - (r.start + r.stop) / 2) for r, c in boxes])


def off_scale(content: bytes, pattern: Pattern, folder: Path) -> float:
    """Largest error of the bar and of the distances between the pinholes of the first tile [mm]."""
    page = printed(content, 2, folder)
    seen = blue_places(page)
    wanted = np.array([s.center for s in pattern.panel("front").shapes if s.part is PatternPart.PINHOLE])
    assert len(seen) == len(wanted) == 5
    spans = [np.sort([np.linalg.norm(a - b) for i, a in enumerate(p) for b in p[:i]]) for p in (seen, wanted)]
    return max(abs(bar_length(page) - 100.0), float(np.abs(spans[0] - spans[1]).max()))


@pytest.fixture(scope="module")
def pattern() -> Pattern:
    return plush_pattern(crossed())


@needs_poppler
@pytest.mark.parametrize("paper", list(Paper))
@pytest.mark.slow
def test_pages_are_at_true_scale(paper, pattern, tmp_path):
    """Oracle: poppler and pixels: the bar and all distances of pinholes within 0.2 mm."""
    assert off_scale(tiled_pdf(pattern, paper), pattern, tmp_path) < 0.2


@needs_poppler
@pytest.mark.slow
def test_the_check_of_the_scale_of_pages_can_fail(pattern, tmp_path):
    """Oracle: the same pages printed at 99.5 %, as by "fit to page"."""
    writer = PdfWriter(clone_from=io.BytesIO(tiled_pdf(pattern, Paper.A4)))
    writer.pages[1].add_transformation(Transformation().scale(0.995))
    shrunk = io.BytesIO()
    writer.write(shrunk)
    assert off_scale(shrunk.getvalue(), pattern, tmp_path) > 0.2


@needs_poppler
@pytest.mark.slow
def test_lines_survive_a_grey_printer_and_the_margin_is_white(pattern, tmp_path):
    """Oracle: pixels: each color of a line is dark in grey; nothing is within 9.9 mm of the edge."""
    page = printed(tiled_pdf(pattern, Paper.A4), 2, tmp_path)
    grey = page @ [0.299, 0.587, 0.114]
    for channel in (0, 2):
        colored = (page[..., channel] > 200) & (np.delete(page, channel, axis=2).max(axis=2) < 40)
        assert colored.any()
        assert grey[colored].max() < 128
    edge = round(9.9 / PIXEL)
    inner = np.full_like(page, 255)
    inner[edge:-edge, edge:-edge] = page[edge:-edge, edge:-edge]
    assert (inner == page).all()


@needs_poppler
@pytest.mark.slow
def test_neighbors_show_the_same_in_their_overlap(pattern, tmp_path):
    """Oracle: pixels: the 10 mm that two pages share differ nowhere by more than a hair."""
    content = tiled_pdf(pattern, Paper.A4)
    one, other = (printed(content, page, tmp_path).min(axis=2) < 128 for page in (2, 3))
    inch = [round(place / PIXEL) for place in (10, 20, 190, 200, 30, 120)]
    right, left = one[inch[4] : inch[5], inch[2] + 2 : inch[3] - 2], other[inch[4] : inch[5], inch[0] + 2 : inch[1] - 2]
    assert right.any()
    thick = ndimage.binary_dilation(left, iterations=2)
    assert (right & ~thick).sum() == 0


@pytest.mark.parametrize(("paper", "size"), SIZES.items())
def test_pages_have_the_size_of_the_paper(paper, size, pattern):
    """Oracle: pypdf: a map and one page for each tile, exactly as large as the paper."""
    pages = read(tiled_pdf(pattern, paper)).pages
    assert len(pages) == 1 + len(tile_grid(pattern, paper).filled_tiles)
    for page in pages:
        assert [25.4 / 72 * float(x) for x in page.mediabox[2:]] == pytest.approx(size, abs=0.01)


def test_pages_are_named_and_explained(pattern):
    """Oracle: text by pypdf: a sheet of 262 by 148 mm takes two columns of 190 mm that overlap by 10 mm."""
    texts = [page.extract_text() for page in read(tiled_pdf(pattern, Paper.A4)).pages]
    assert [text.count("100 mm") for text in texts] == [1, 1, 1]
    assert "A1 of 2 x 1" in texts[1]
    assert "B1 of 2 x 1" in texts[2]
    assert all("Sam - pattern" in text for text in texts)
    assert "262 x 148 mm" in texts[0]


def two_spots(width: float, height: float) -> Pattern:
    """A sheet with a ring in its lower left and one in its upper right corner."""
    rings = [
        Circle(layer=Layer.CUT, part=PatternPart.EDGE, center=place, radius=5.0)
        for place in ((10.0, 10.0), (width - 10.0, height - 10.0))
    ]
    return Pattern(name="spots", panels=(), shapes=tuple(rings), width=width, height=height)


def test_empty_tiles_are_left_out_and_said_so():
    """Oracle: counting: two of nine tiles hold a ring."""
    pages = read(tiled_pdf(two_spots(500.0, 700.0), Paper.A4)).pages
    assert len(pages) == 3
    text = " ".join(pages[0].extract_text().split())
    assert "A1, B1, B2, C2, A3" not in text
    assert "Nothing is on A1, B1, A2, B2, C2, B3, C3: they are not printed" in text
    assert [page.extract_text().count("of 3 x 3") for page in pages] == [0, 1, 1]
    many = read(tiled_pdf(two_spots(1500.0, 700.0), Paper.A4)).pages
    assert "Nothing is on the 25 crossed out below" in " ".join(many[0].extract_text().split())


@pytest.mark.parametrize("paper", list(Paper))
@pytest.mark.parametrize("size", [(50.0, 50.0), (190.0, 263.0), (190.2, 245.6), (623.0, 512.0), (900.0, 1200.0)])
def test_tiles_overlap_by_10_mm_and_hold_the_whole_sheet(paper, size):
    """Oracle: closed form: ceil((length - 10) / (tile - 10)) tiles, the next begins 10 mm before one ends."""
    grid = tile_grid(two_spots(*size), paper)
    width, height = SIZES[paper][0] - 20, SIZES[paper][1] - 34
    assert (grid.width, grid.height) == pytest.approx((width, height))
    assert grid.columns == max(1, int(np.ceil(round((size[0] - 10) / (width - 10), 9))))
    assert grid.rows == max(1, int(np.ceil(round((size[1] - 10) / (height - 10), 9))))
    first, last = grid.tiles[0], grid.tiles[-1]
    assert first.left <= 1e-9
    assert first.top <= 1e-9
    assert last.left + width >= size[0] - 1e-9
    assert last.top + height >= size[1] - 1e-9
    for tile in grid.tiles:
        assert tile.left == pytest.approx(first.left + tile.column * (width - 10))
        assert tile.top == pytest.approx(first.top + tile.row * (height - 10))


@pytest.mark.slow
def test_pages_are_the_same_bytes_on_every_run(pattern):
    """Oracle: a second run of a second pattern after a second; there is no date in the file."""
    content = tiled_pdf(pattern, Paper.A4)
    time.sleep(1.1)
    assert content == tiled_pdf(plush_pattern(crossed()), Paper.A4)
    metadata = read(content).metadata
    assert metadata is not None
    assert metadata.creation_date is None
    assert metadata.modification_date is None


@pytest.mark.parametrize("name", ['<b>&"Sam\'s"</b> #x \\ $y$', "Zoë 海星 \x0b", "]]> [*_", "a\nb"])
def test_any_name_makes_pages(name):
    """Oracle: pypdf, and what of the name can be read."""
    robot = plush_robot(drawn_body(SQUARE), [(0, 0), (20, 10)], name=name)
    pages = read(tiled_pdf(plush_pattern(robot), Paper.A4)).pages
    assert "pattern" in pages[0].extract_text()


@pytest.mark.parametrize("seed", range(8))
def test_no_line_is_lost(seed):
    """Oracle: shapely: the windows of the printed tiles together cover every shape of a sheet of scattered rings."""
    places = np.random.default_rng(seed).uniform(10, 690, size=(9, 2))
    rings = [Circle(layer=Layer.CUT, part=PatternPart.EDGE, center=(float(x), float(y)), radius=8.0) for x, y in places]
    sheet = Pattern(name="rings", panels=(), shapes=tuple(rings), width=700.0, height=700.0)
    assert lost(sheet, tile_grid(sheet, Paper.LETTER).filled_tiles) < 1e-6


def test_the_check_of_lost_lines_can_fail():
    """Oracle: one page torn out."""
    sheet = two_spots(500.0, 700.0)
    assert lost(sheet, tile_grid(sheet, Paper.A4).filled_tiles[1:]) > 1


def lost(sheet: Pattern, tiles: tuple[Tile, ...]) -> float:
    """Length of what no page shows [mm]."""
    width, height = SIZES[Paper.LETTER][0] - 20, SIZES[Paper.LETTER][1] - 34
    windows = [shapely.box(t.left, sheet.height - t.top - height, t.left + width, sheet.height - t.top) for t in tiles]
    drawn = shapely.union_all([shape.geometry for shape in sheet.shapes])
    return drawn.difference(shapely.union_all(windows)).length


def test_a_page_with_nothing_of_its_own_is_saved():
    """Oracle: by hand: a ring in the 10 mm that two tiles share, as far to the right as it fits on the first."""
    ring = Circle(layer=Layer.CUT, part=PatternPart.EDGE, center=(185.0, 100.0), radius=4.0)
    bar = LaserLine(layer=Layer.MARK, part=PatternPart.RULER, points=((1.0, 1.0), (101.0, 1.0)))
    sheet = Pattern(name="ring", panels=(), shapes=(ring, bar), width=370.0, height=200.0)
    assert [tile.name for tile in tile_grid(sheet, Paper.A4).filled_tiles] == ["A1"]


def test_a_line_across_tiles_is_on_each_of_them(pattern):
    """Oracle: a line from corner to corner of a sheet of three columns."""
    line = LaserLine(layer=Layer.CUT, part=PatternPart.EDGE, points=((1.0, 100.0), (499.0, 100.0)))
    grid = tile_grid(replace(pattern, panels=(), shapes=(line,), width=500.0, height=200.0), Paper.A4)
    assert [tile.name for tile in grid.filled_tiles] == ["A1", "B1", "C1"]
