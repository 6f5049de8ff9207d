"""`TileGrid`: how a large sheet is cut into pages that overlap."""

import math
from dataclasses import dataclass
from itertools import product
from string import ascii_uppercase
from typing import NamedTuple

import numpy as np
import shapely

from hydrostat.fabrication.kit_options import Paper
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Shape

PAPERS = {Paper.A4: (210.0, 297.0), Paper.LETTER: (215.9, 279.4)}  # width and height [mm]
MARGIN = 10.0  # what a printer leaves white along each edge [mm]
FOOTER = 14.0  # room below a tile for its name and the bar [mm]
OVERLAP = 10.0  # what a tile shares with the next [mm]


@dataclass(frozen=True, kw_only=True)
class Tile:
    """What is printed on one page."""

    name: str  # column and row, such as "B2"
    column: int  # from the left, from 0
    row: int  # from the top, from 0
    left: float  # of its left edge on the sheet [mm]
    top: float  # how far its upper edge is below that of the sheet [mm]
    shapes: tuple[Shape, ...]  # what lies on it, in places of the sheet


@dataclass(frozen=True, kw_only=True)
class TileGrid:
    """All tiles of a sheet."""

    columns: int  # of tiles
    rows: int  # of tiles
    width: float  # of a tile [mm]
    height: float  # of a tile [mm]
    tiles: tuple[Tile, ...]  # row by row; without shapes where the tiles before it show all that is on it

    @property
    def printed(self) -> tuple[Tile, ...]:
        """Tiles that are not empty."""
        return tuple(tile for tile in self.tiles if tile.shapes)

    def at(self, column: int, row: int) -> Tile | None:
        """The tile of a column and row; None beyond the edge, or where nothing is printed."""
        for tile in self.printed:
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
    """How many tiles a length [mm] takes, and where the first may begin: in the middle of the room, or elsewhere."""
    count = max(1, math.ceil((length - OVERLAP) / (tile - OVERLAP) - 1e-9))
    room = length - OVERLAP - count * (tile - OVERLAP)
    return count, [room * share for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.1, 0.9, 0.0, 1.0)]


def _letters(index: int) -> str:
    """A, B, ... Z, AA, AB, ..."""
    before, last = divmod(index, len(ascii_uppercase))
    return (_letters(before - 1) if before else "") + ascii_uppercase[last]
