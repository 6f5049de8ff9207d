"""`PictureSheet`: an empty picture with a millimeter grid."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from hydrostat.arrays import Float
from hydrostat.drawing import Color
from hydrostat.plot.strokes import StrokeLayers

Place = Float[np.ndarray, " 2"]  # one place, in millimeters unless its function says otherwise
Places = Float[np.ndarray, "_ 2"]  # places, one row each, in millimeters unless their function says otherwise
Spread = Float[np.ndarray, "_ dim"]  # points or nodes of a robot [m], any number of them in one call
WIDTH = 6.4  # width of a picture [inch]
BODY = "body"  # label of an image of a body in space, by which it is known when the picture is written
TALLEST = 1.15  # greatest height of a picture, as a multiple of its width


class _Unclipped(Line2D):
    """Line without a clip path, which takes half the time to add; pictures have thousands."""

    def set_clip_path(self, path: object, transform: object = None) -> None:
        """Do nothing."""


@dataclass(frozen=True, eq=False)
class PictureSheet:
    """A picture to draw on, in millimeters, all sides to the same scale."""

    figure: Figure  # the whole picture
    axes: Axes  # where the body is drawn
    low: np.ndarray  # lower left corner of the axes [mm]
    high: np.ndarray  # upper right corner [mm]
    scale: float  # millimeters of the body that one point (1/72 inch) on the picture shows
    kept: tuple[tuple[float, float, float, float], ...] = ()  # boxes without labels: left, lower, right, upper [mm]
    layers: StrokeLayers | None = None  # draw lines faster where there are hundreds in each frame

    def curve(self, points: Places, **style: object) -> None:
        """A line through points [mm]; rows of NaN break it."""
        look: dict[str, object] = {"solid_capstyle": "round", "solid_joinstyle": "round", "clip_on": False, **style}
        if self.layers is not None and self.layers.take(points, look):
            return
        line = Line2D if look["clip_on"] else _Unclipped
        self.axes.add_artist(line(points[:, 0], points[:, 1], **look))  # pyright: ignore[reportArgumentType]

    def segments(self, ends: np.ndarray, **style: object) -> None:
        """Many separate lines [mm], (lines, 2, 2), as one path."""
        if len(ends):
            self.curve(join_lines(list(ends)), **style)

    def dots(self, points: Places, size: float, **style: object) -> None:
        """Round dots of a diameter [pt] at points [mm]."""
        self.curve(points, linestyle="none", marker="o", markersize=size, **style)

    def area(self, rings: list[Places], **style: object) -> None:
        """A filled shape of one or more rings [mm]."""
        closed = [Path(np.concatenate([ring, ring[:1]]), closed=True) for ring in rings]
        self.axes.add_artist(PathPatch(Path.make_compound_path(*closed), clip_on=False, **style))  # pyright: ignore[reportArgumentType]

    def text(self, place: tuple[float, float], words: str, **style: object) -> None:
        """Words as they are: no formula is read in them."""
        self.axes.text(*place, words, **{"parse_math": False, "clip_on": False, **style})  # pyright: ignore[reportArgumentType]


def join_lines(lines: list[Places]) -> Places:
    """Separate lines as one, broken by rows of NaN."""
    return np.concatenate([part for line in lines for part in (line, np.full((1, 2), np.nan))])


def new_figure(width: float, height: float) -> Figure:
    """An empty clear figure [inch] whose pixels can be read."""
    figure = Figure(figsize=(width, height), facecolor="none")
    FigureCanvasAgg(figure)
    return figure


def new_sheet(
    points: Places,
    *,
    title: str = "",
    subtitle: str = "",
    width: float = WIDTH,
    ruled: bool = True,
    bar: bool = False,
    room: float = 0.09,
) -> PictureSheet:
    """An empty sheet that shows all of the points [mm].

    The subtitle is left out with the title. If ruled it has a grid and numbers in millimeters; the bar is room for one
    of colors, the room a free border as a share of the longest side; width in inches.
    """
    low, high = frame_points(points, room)
    left, right, bottom = (0.42, 0.12, 0.32) if ruled else (0.05, 0.05, 0.05)
    top = 0.62 if title else 0.48 if bar else 0.1
    inches = width - left - right
    wide, tall = high - low
    height = inches * tall / wide
    figure = new_figure(width, height + top + bottom)
    size = figure.get_size_inches()
    axes = figure.add_axes((left / size[0], bottom / size[1], inches / size[0], height / size[1]))
    sheet = PictureSheet(figure, axes, low, high, wide / (inches * 72))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), facecolor="none", autoscale_on=False)
    _rule(sheet) if ruled else axes.set_axis_off()
    if title:
        _head(figure, title, subtitle)
    return sheet


def frame_points(points: Places, room: float) -> tuple[Place, Place]:
    """Return lower left and upper right corner of a frame around points, with a border `room` x its longest side."""
    border = room * float(np.ptp(points, axis=0).max())
    low, high = points.min(axis=0) - border, points.max(axis=0) + border
    wide, tall = high - low
    more = np.array([max(tall / TALLEST - wide, 0.0) / 2, 0.0])
    return low - more, high + more


def _rule(sheet: PictureSheet) -> None:
    """Thin grid lines at round millimeters, numbered along the left and lower sides.

    They are a line and words of our own: ticks, of which each is five artists, take ten times as long.
    """
    step = round_step(float((sheet.high - sheet.low).max()))
    axes, grid, first, room = sheet.axes, [], "", np.inf
    for axis, (low, high) in enumerate(zip(sheet.low, sheet.high, strict=True)):
        ticks = np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step + 0.0  # no -0
        words = [f"{tick:.10g}".replace("-", "\N{MINUS SIGN}") for tick in ticks]
        transform = (axes.get_xaxis_text1_transform, axes.get_yaxis_text1_transform)[axis](4)[0]
        for tick, number in zip(ticks, words, strict=True):
            ends = np.array([sheet.low, sheet.high])
            ends[:, axis] = tick
            grid.append(ends)
            sides = {"ha": "right", "va": "center_baseline"} if axis else {"ha": "center", "va": "top"}
            place = (0.0, tick) if axis else (tick, 0.0)
            sheet.text(place, number, transform=transform, fontsize=7, color=Color.MUTED, zorder=_BEHIND, **sides)
        if axis == 0 and words:
            first, room = words[0], (ticks[0] - low) / sheet.scale
        (axes.yaxis if axis else axes.xaxis).set_visible(False)
    sheet.segments(np.array(grid), color=Color.GRID, linewidth=0.6, solid_capstyle="butt", zorder=_BEHIND)
    for spine in axes.spines.values():
        spine.set_visible(False)
    left = max(4.0, 2.5 * len(first) + 2 - room)  # beside half of the first number [pt]
    axes.annotate(
        "mm", (0, 0), xycoords="axes fraction", xytext=(-left, -4), textcoords="offset points", fontsize=7,
        color=Color.MUTED, ha="right", va="top",
    )  # fmt: skip


_BEHIND = 0.5  # order of drawing: behind all else


def round_step(span: float) -> float:
    """A round distance between grid lines [mm], such that there are four to ten."""
    power = 10.0 ** np.floor(np.log10(span / 4))
    return float(max(factor * power for factor in (1, 2, 5) if factor * power <= span / 4))


def _head(figure: Figure, title: str, subtitle: str) -> None:
    width, height = figure.get_size_inches()
    for words, down, size, color, weight in (
        (title, 0.1, 11, Color.INK, "bold"),
        (subtitle, 0.31, 8, Color.MUTED, "normal"),
    ):
        figure.text(
            0.12 / width, 1 - down / height, words, fontsize=size, color=color, weight=weight, va="top",
            parse_math=False,
        )  # fmt: skip
