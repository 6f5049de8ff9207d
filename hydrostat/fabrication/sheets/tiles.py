"""`tiled_pdf`: a pattern at true scale on the paper of an office printer, in tiles that overlap."""

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from itertools import product
from string import ascii_uppercase
from typing import NamedTuple

import numpy as np
import shapely

from hydrostat.fabrication.kit_options import Paper
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Layer, Shape
from hydrostat.fabrication.patterns.svg_writer import COLORS, shapes_svg
from hydrostat.fabrication.sheets.legible import legible

PAPERS = {Paper.A4: (210.0, 297.0), Paper.LETTER: (215.9, 279.4), Paper.A3: (297.0, 420.0)}  # width and height [mm]
MARGIN = 10.0  # white edge of a printer's pages [mm]
FOOTER = 14.0  # room below a tile for its name and the bar [mm]
OVERLAP = 10.0  # overlap of neighboring tiles [mm]


@dataclass(frozen=True, kw_only=True)
class Tile:
    """Content of one printed page."""

    name: str  # column and row, such as "B2"
    column: int  # from the left, from 0
    row: int  # from the top, from 0
    left: float  # position of its left edge on the sheet [mm]
    top: float  # distance of its upper edge below that of the sheet [mm]
    shapes: tuple[Shape, ...]  # shapes on it, in the coordinates of the sheet


@dataclass(frozen=True, kw_only=True)
class TileGrid:
    """All tiles of a sheet."""

    columns: int  # columns of tiles
    rows: int  # rows of tiles
    width: float  # width of a tile [mm]
    height: float  # height of a tile [mm]
    tiles: tuple[Tile, ...]  # row by row; without shapes where the tiles before it show all that is on it

    @property
    def filled_tiles(self) -> tuple[Tile, ...]:
        """Tiles that are not empty."""
        return tuple(tile for tile in self.tiles if tile.shapes)

    def at(self, column: int, row: int) -> Tile | None:
        """The tile of a column and row; None beyond the edge, or where nothing is printed."""
        for tile in self.filled_tiles:
            if (tile.column, tile.row) == (column, row):
                return tile
        return None


def tile_grid(pattern: Pattern, paper: Paper) -> TileGrid:
    """Tiles that hold a sheet: the least rows and columns, laid so that the fewest pages show something."""
    page_width, page_height = PAPERS[paper]
    width, height = page_width - 2 * MARGIN, page_height - 2 * MARGIN - FOOTER
    columns, lefts = _steps(pattern.width, width)
    rows, tops = _steps(pattern.height, height)
    shapes = [*(shape for panel in pattern.panels for shape in panel.shapes), *pattern.shapes]
    tree = shapely.STRtree([shape.geometry for shape in shapes])
    grids = []
    for left, top in product(lefts, tops):
        windows = _Windows(columns, rows, width, height, left, top, pattern.height)
        grids.append((len(np.unique(tree.query(windows.boxes(OVERLAP), predicate="intersects")[0])), windows))
    _, windows = min(grids, key=lambda grid: grid[0])
    needed = set(np.unique(tree.query(windows.boxes(OVERLAP), predicate="intersects")[0]).tolist())
    boxes = windows.boxes(0.0)
    tiles = []
    for index, (row, column) in enumerate(product(range(rows), range(columns))):
        found = np.sort(tree.query(boxes[index], predicate="intersects")).tolist() if index in needed else ()
        tiles.append(
            Tile(
                name=f"{_letters(column)}{row + 1}",
                column=column,
                row=row,
                left=windows.left + column * (width - OVERLAP),
                top=windows.top + row * (height - OVERLAP),
                shapes=tuple(shapes[shape] for shape in found),
            )
        )
    return TileGrid(columns=columns, rows=rows, width=width, height=height, tiles=tuple(tiles))


class _Windows(NamedTuple):
    """Places of tiles on a sheet: y counts up there, rows from the top."""

    columns: int
    rows: int
    width: float
    height: float
    left: float
    top: float
    sheet: float

    def boxes(self, shared: float) -> np.ndarray:
        """A box for each tile, row by row, without what it shares with tiles on the left and above [mm]."""
        row, column = (grid.ravel() for grid in np.indices((self.rows, self.columns)))
        left = self.left + column * (self.width - OVERLAP)
        top = self.sheet - self.top - row * (self.height - OVERLAP)
        return shapely.box(left + shared * (column > 0), top - self.height, left + self.width, top - shared * (row > 0))


def _steps(length: float, tile: float) -> tuple[int, list[float]]:
    """Number of tiles that a length [mm] takes, and starts of the first: in the middle of the room, or elsewhere."""
    count = max(1, math.ceil((length - OVERLAP) / (tile - OVERLAP) - 1e-9))
    room = length - OVERLAP - count * (tile - OVERLAP)
    return count, [room * share for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9, 0.0, 1.0)]


def _letters(index: int) -> str:
    """A, B, ... Z, AA, AB, ..."""
    before, last = divmod(index, len(ascii_uppercase))
    return (_letters(before - 1) if before else "") + ascii_uppercase[last]


_WIDTHS = {Layer.MARK: 0.2, Layer.GUIDE: 0.2, Layer.PINHOLE: 0.3, Layer.CUT: 0.6}
"""Widths of the lines [mm]: the width too shows the operation where the printer knows no color."""


_Box = tuple[float, float, float, float]
_Widths = Mapping[Layer, float]


def tiled_pdf(pattern: Pattern, paper: Paper) -> bytes:
    """The pages: a map of the sheet and how to join its tiles first, then each tile that is not empty.

    Tiles overlap; crosses lie in the corners of the overlap, and fall on each other when the pages are joined.
    """
    grid = tile_grid(pattern, paper)
    width, height = PAPERS[paper]
    pages = [
        (files("hydrostat.fabrication.sheets") / "tiles.typ").read_text(encoding="utf-8"),
        f"#set document(title: {_text(f'{legible(pattern.name)} - pattern')}, date: none)",
        f"#set page(width: {width}mm, height: {height}mm, margin: 0mm)",
        _overview(pattern, grid, paper),
        *(f"#pagebreak()\n{_page(pattern, grid, tile)}" for tile in grid.filled_tiles),
    ]
    return _compile("\n".join(pages))


def _compile(source: str) -> bytes:
    """The PDF: the same bytes on every run, as neither the clock nor the fonts of the machine have a part in it."""
    import typst  # Imported here: a check of a robot sets no page.

    return typst.compile(source.encode(), format="pdf", ignore_system_fonts=True)


def _page(pattern: Pattern, grid: TileGrid, tile: Tile) -> str:
    """A tile with its frame, its crosses, the names of its neighbors, and its foot."""
    size = grid.width, grid.height
    drawing = _image(pattern, tile.shapes, (tile.left, tile.top, *size), size, _WIDTHS)
    right, bottom = MARGIN + grid.width, MARGIN + grid.height
    inset = OVERLAP / 2
    lines = [
        f"#at({MARGIN}, {MARGIN}, box(width: {grid.width}mm, height: {grid.height}mm, clip: true,"
        f' stroke: (thickness: 0.1mm, paint: luma(120), dash: "dotted"), {drawing}))'
    ]
    lines += [f"#cross({x}, {y})" for x in (MARGIN + inset, right - inset) for y in (MARGIN + inset, bottom - inset)]
    middle_x, middle_y = MARGIN + grid.width / 2, MARGIN + grid.height / 2
    for column, row, x, y in (
        (-1, 0, MARGIN + inset, middle_y),
        (1, 0, right - inset, middle_y),
        (0, -1, middle_x, MARGIN + inset),
        (0, 1, middle_x, bottom - inset),
    ):
        other = grid.at(tile.column + column, tile.row + row)
        if other:
            lines.append(
                f"#at({x - 5}, {y - 2.5}, box(width: 10mm, height: 5mm, align(center + horizon,"
                f" text(size: 8pt, fill: luma(90))[{other.name}])))"
            )
    return "\n".join([*lines, *_foot(pattern, grid, f"{tile.name} of {grid.columns} x {grid.rows}")])


def _foot(pattern: Pattern, grid: TileGrid, name: str) -> list[str]:
    """The bar, the name of the page and that of the pattern."""
    y = MARGIN + grid.height + FOOTER - 5
    label = f'#text(size: 13pt, weight: "bold")[#{_text(name)}]'
    title = f"#text(size: 8pt)[#{_text(f'{legible(pattern.name)} - pattern')}]"
    bar = 100.0  # length of the bar that shows whether a page was printed at its true scale [mm]
    return [
        f"#bar({MARGIN}, {y})",
        f"#at({MARGIN + bar + 5}, {y - 5}, box(width: {grid.width - bar - 5}mm, height: 10mm, clip: true,"
        f" align(right + horizon)[{label} \\ {title}]))",
    ]


def _overview(pattern: Pattern, grid: TileGrid, paper: Paper) -> str:
    """The first page: what the lines are, how to join the tiles, the sheet in small with its tiles."""
    page_width, _ = PAPERS[paper]
    pages, empty = len(grid.filled_tiles), [tile.name for tile in grid.tiles if not tile.shapes]
    said = [
        f"{legible(pattern.name)}: a sheet of {pattern.width:.0f} x {pattern.height:.0f} mm on {pages} "
        f"page{'s' if pages > 1 else ''} after this one, tiles A1 to {grid.tiles[-1].name}.{_left_out(empty)}",
        "Print all pages at 100 % (actual size, not fitted to the page) and measure the bar on each of them.",
        f"Cut each page along its dotted frame on the right and below, lay it {OVERLAP:g} mm over the next so that "
        "crosses fall on crosses, and glue or tape them.",
    ]
    lines = [
        f'#at({MARGIN}, {MARGIN}, text(size: 18pt, weight: "bold")[#{_text(f"{legible(pattern.name)} - pattern")}])'
    ]
    body = "".join(f"#par[#{_text(sentence)}]" for sentence in said)
    room = f"box(width: {page_width - 2 * MARGIN}mm)"
    lines.append(f"#at({MARGIN}, {MARGIN + 11}, {room}[#set par(spacing: 2mm)\n{body}])")
    return "\n".join([*lines, *_key(MARGIN + 34), *_map(pattern, grid, MARGIN + 48), *_foot(pattern, grid, "map")])


def _left_out(empty: list[str]) -> str:
    """Return a sentence on the tiles without a page."""
    if not empty:
        return ""
    named = 12  # so many empty tiles are named; more would fill the page
    if len(empty) > named:
        return f" Nothing is on the {len(empty)} crossed out below: they are not printed."
    return f" Nothing is on {', '.join(empty)}: {'they are' if len(empty) > 1 else 'it is'} not printed."


def _key(y: float) -> list[str]:
    """Legend of the kinds of lines."""
    red, blue = (f'rgb("{COLORS[layer]}")' for layer in (Layer.CUT, Layer.PINHOLE))
    thin = f"width: {_WIDTHS[Layer.MARK]}mm"
    samples = (
        (f"#stroke_at({{x}}, {y}, 12, 0, width: {_WIDTHS[Layer.CUT]}mm, paint: {red})", "cut", 24.0),
        (f"#at({{x}} + 9, {y} - 1, circle(radius: 1mm, stroke: {_WIDTHS[Layer.PINHOLE]}mm + {blue}))", "pinhole", 30.0),
        (f"#stroke_at({{x}}, {y}, 12, 0, {thin})", "seam, or cable outside", 52.0),
        (f"#stroke_at({{x}}, {y}, 12, 0, {thin}, dash: (2mm, 1.3mm))", "cable inside", 37.0),
        (f"#at({{x}}, {y} - 1.5, box(width: 12mm, height: 3mm, stroke: (y: {_WIDTHS[Layer.MARK]}mm)))", "sheath", 0.0),
    )
    x, lines = MARGIN, []
    for sample, text, step in samples:
        lines += [sample.format(x=x), f"#at({x + 14}, {y - 1.6}, [{text}])"]
        x += step
    lines.append(
        f"#at({MARGIN}, {y + 4.5}, [Letters mark notches that meet; small figures number the holes of a cable in "
        "stitch order, from 2 on; a bar is its stopper, a large circle its winch. #linebreak() "
        "Green shows on the right side of the cloth: draw it with a pen that washes out.])"
    )
    return lines


def _map(pattern: Pattern, grid: TileGrid, y: float) -> list[str]:
    """The sheet in small; tiles outlined, those that are left out hatched by a diagonal."""
    room_y = MARGIN + grid.height - y
    whole_x = grid.columns * (grid.width - OVERLAP) + OVERLAP
    whole_y = grid.rows * (grid.height - OVERLAP) + OVERLAP
    scale = min(grid.width / whole_x, room_y / whole_y)
    shapes = [*(shape for panel in pattern.panels for shape in panel.shapes), *pattern.shapes]
    widths = dict.fromkeys(Layer, 0.15 / scale)
    window = grid.tiles[0].left, grid.tiles[0].top, whole_x, whole_y
    drawing = _image(pattern, shapes, window, (scale * whole_x, scale * whole_y), widths)
    lines = [f"#at({MARGIN}, {y}, {drawing})"]
    step_x, step_y = scale * (grid.width - OVERLAP), scale * (grid.height - OVERLAP)
    half = scale * OVERLAP / 2
    for tile in grid.tiles:
        x0, y0 = MARGIN + half + tile.column * step_x, y + half + tile.row * step_y
        grey = "luma(200)" if not tile.shapes else "luma(110)"
        frame = f"rect(width: {step_x:.4f}mm, height: {step_y:.4f}mm, stroke: 0.2mm + luma(110))"
        lines.append(f"#at({x0:.4f}, {y0:.4f}, {frame})")
        if not tile.shapes:
            lines.append(f"#stroke_at({x0:.4f}, {y0:.4f}, {step_x:.4f}, {step_y:.4f}, paint: luma(170))")
        name = f'text(size: 12pt, weight: "bold", fill: {grey})[{tile.name}]'
        lines.append(f"#at({x0 + 1.5:.4f}, {y0 + 1.5:.4f}, {name})")
    return lines


def _image(pattern: Pattern, shapes: Iterable[Shape], window: _Box, size: tuple[float, float], widths: _Widths) -> str:
    """A picture of shapes, for typst: a window of the sheet (left, top, width, height) at a size [mm]."""
    view = " ".join(f"{value:.6f}" for value in window)
    picture = shapes_svg(shapes, pattern.height, view, size, widths)
    return f'image(bytes({_text(picture)}), format: "svg", width: {size[0]:.6f}mm, height: {size[1]:.6f}mm)'


def _text(text: str) -> str:
    """A string of typst; its escapes are those of JSON, but for characters of control."""
    for letter in {*text}:
        if not letter.isprintable():
            text = text.replace(letter, " ")
    return json.dumps(text, ensure_ascii=False)
