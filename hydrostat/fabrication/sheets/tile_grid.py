"""`TileGrid`: how a large sheet is cut into pages that overlap."""

import math
from dataclasses import dataclass
from string import ascii_uppercase

import numpy as np
import shapely

from hydrostat.fabrication.kit_options import Paper
from hydrostat.fabrication.patterns.pattern import Pattern
from hydrostat.fabrication.patterns.shape import Shape

PAPERS = {Paper.A4: (210.0, 297.0), Paper.LETTER: (215.9, 279.4)}
"""Width and height [mm]."""

MARGIN = 10.0
"""What a printer leaves white along each edge [mm]."""

FOOTER = 14.0
"""Room below a tile for its name and the bar [mm]."""

OVERLAP = 10.0
"""What a tile shares with the next [mm]."""


@dataclass(frozen=True, kw_only=True)
class Tile:
    """What is printed on one page.

    Attributes:
        name: column and row, such as "B2".
        column: from the left, from 0.
        row: from the top, from 0.
        left: of its left edge on the sheet [mm].
        top: how far its upper edge is below that of the sheet [mm].
        shapes: what lies on it, in places of the sheet.
    """

    name: str
    column: int
    row: int
    left: float
    top: float
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, kw_only=True)
class TileGrid:
    """All tiles of a sheet, which lies in the middle of them.

    Attributes:
        columns: of tiles.
        rows: of tiles.
        width: of a tile [mm].
        height: of a tile [mm].
        tiles: row by row, those without any shape too.
    """

    columns: int
    rows: int
    width: float
    height: float
    tiles: tuple[Tile, ...]

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
    """The fewest tiles that hold a sheet."""
    page_width, page_height = PAPERS[paper]
    width, height = page_width - 2 * MARGIN, page_height - 2 * MARGIN - FOOTER
    columns, left = _steps(pattern.width, width)
    rows, top = _steps(pattern.height, height)
    shapes = [*(shape for panel in pattern.panels for shape in panel.shapes), *pattern.shapes]
    tree = shapely.STRtree([shape.geometry for shape in shapes])
    tiles = []
    for row in range(rows):
        for column in range(columns):
            x, y = left + column * (width - OVERLAP), top + row * (height - OVERLAP)
            box = shapely.box(x, pattern.height - y - height, x + width, pattern.height - y)
            found = np.sort(tree.query(box, predicate="intersects")).tolist()
            tiles.append(
                Tile(
                    name=f"{_letters(column)}{row + 1}",
                    column=column,
                    row=row,
                    left=x,
                    top=y,
                    shapes=tuple(shapes[index] for index in found),
                )
            )
    return TileGrid(columns=columns, rows=rows, width=width, height=height, tiles=tuple(tiles))


def _steps(length: float, tile: float) -> tuple[int, float]:
    """How many tiles a length [mm] takes, and where the first begins."""
    count = max(1, math.ceil((length - OVERLAP) / (tile - OVERLAP) - 1e-9))
    return count, (length - OVERLAP - count * (tile - OVERLAP)) / 2


def _letters(index: int) -> str:
    """A, B, ... Z, AA, AB, ..."""
    before, last = divmod(index, len(ascii_uppercase))
    return (_letters(before - 1) if before else "") + ascii_uppercase[last]
