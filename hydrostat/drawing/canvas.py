"""`Canvas`: a picture as SVG, in millimeters of paper, so that lines and letters have the same size on all of them."""

import html
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Self

import numpy as np

from hydrostat.arrays import Float
from hydrostat.drawing.line_drawing import LineDrawing

NAMESPACE = "http://www.w3.org/2000/svg"


class Html(str):
    """Text that may stand in a page or a drawing as it is."""

    __slots__ = ()


def safe(content: object) -> Html:
    """Content as it may stand in a page: `Html` as it is, lists joined, anything else escaped."""
    if isinstance(content, Html):
        return content
    if isinstance(content, list | tuple):
        return Html("".join(safe(part) for part in content))
    return Html(html.escape(str(content)))


def tag(name: str, *content: object, **attributes: object) -> Html:
    """Element. In the names of attributes a last underscore is dropped, others become hyphens; None is left out."""
    return Html(f"<{name}{_pairs(attributes)}>{safe(list(content))}</{name}>")


def shape(name: str, **attributes: object) -> Html:
    """Element of a drawing without content, with attributes as those of `tag`."""
    return Html(f"<{name}{_pairs(attributes)}/>")


def _pairs(attributes: dict[str, object]) -> str:
    return "".join(
        f' {key.rstrip("_").replace("_", "-")}="{html.escape(str(value))}"'
        for key, value in attributes.items()
        if value is not None
    )


def number(value: float, digits: int) -> str:
    """Number with a largest number of digits after the point, without a minus before nought."""
    text = f"{round(value, digits) + 0.0:.{digits}f}"
    return text.rstrip("0").rstrip(".") if digits else text


def path(lines: Iterable[Iterable[Sequence[float] | np.ndarray]], *, digits: int, closed: bool = False) -> str:
    """Path data of straight lines through points, with numbers as `number` writes them; y counts down."""
    end, point = "Z" if closed else "", f"%.{digits}f %.{digits}f"
    words = []
    for line in lines:
        places = np.round(line, digits).tolist() if isinstance(line, np.ndarray) else list(line)
        values = [value if type(value) is float else round(value, digits) for value in chain.from_iterable(places)]
        words.append("M" + "L".join([point] * len(places)) % tuple(values) + end)
    text = "".join(words)
    return _MINUS_NOUGHT.sub("0", _LAST_NOUGHTS.sub("", text) if digits else text)


_LAST_NOUGHTS, _MINUS_NOUGHT = re.compile(r"\.?0+(?![.\d])"), re.compile(r"-0(?![.\d])")


Spot = tuple[float, float]  # a place on the canvas [mm]: to the right, down
Box = tuple[float, float, float, float]  # left, top, right, bottom [mm]
POINT = 25.4 / 72  # millimeters of a typographic point
FONT = "Libertinus Serif"  # comes with typst, so that a sheet is the same on every machine


@dataclass(frozen=True)
class CanvasFrame:
    """Scale and place of a drawing on a canvas."""

    scale: float  # millimeters on paper per millimeter of the object
    left: float  # canvas coordinate of x = 0 [mm]
    base: float  # canvas coordinate, downwards, of height 0 [mm]

    @classmethod
    def fit(cls, box: Float[np.ndarray, "2 2"], room: Box) -> Self:
        """Fit an object into a room, centered and as large as possible; `box`: its lowest and highest coordinates."""
        left, top, right, bottom = room
        wide, high = np.maximum(box[1] - box[0], 1e-9).tolist()
        scale = min((right - left) / wide, (bottom - top) / high)
        middle_x, middle_y = ((box[0] + box[1]) / 2).tolist()
        return cls(scale, (left + right) / 2 - scale * middle_x, (top + bottom) / 2 + scale * middle_y)

    def on(self, place: Sequence[float] | np.ndarray) -> Spot:
        """Position on the canvas [mm] of a point of the object."""
        return self.left + self.scale * float(place[0]), self.base - self.scale * float(place[1])

    def way(self, places: Iterable[Sequence[float] | np.ndarray]) -> list[Spot]:
        """Positions on the canvas [mm] of points of the object."""
        return [self.on(place) for place in places]


@dataclass
class Canvas:
    """Picture that is drawn from back to front."""

    THICK, MIDDLE, THIN = 0.5, 0.32, 0.18  # widths of lines [mm]
    PIXELS = 10  # depth samples for each millimeter of paper: less than the width of a line

    width: float  # [mm]
    height: float  # [mm]
    _parts: list[Html] = field(default_factory=list)

    @property
    def svg(self) -> str:
        """Picture so far."""
        return tag(
            "svg",
            self._parts,
            xmlns=NAMESPACE,
            width=f"{self.width:g}mm",
            height=f"{self.height:g}mm",
            viewBox=f"0 0 {self.width:g} {self.height:g}",
            stroke_linecap="round",
            stroke_linejoin="round",
            font_family=FONT,
            fill="none",
        )

    def line(
        self,
        ways: Iterable[Sequence[Spot]],
        *,
        width: float = MIDDLE,
        grey: float = 0.0,
        dash: tuple[float, float] | None = None,
        closed: bool = False,
        color: str | None = None,
    ) -> None:
        """Lines through spots; `grey` from 0 for black to 1, or a color; `dash`: length of strokes and gaps [mm]."""
        drawn = path((way for way in ways if len(way) > 1), digits=2, closed=closed)
        if drawn:
            dashes = {"stroke_dasharray": f"{dash[0]:g} {dash[1]:g}", "stroke_linecap": "butt"} if dash else {}
            self._parts.append(shape("path", d=drawn, stroke=color or _ink(grey), stroke_width=f"{width:g}", **dashes))

    def fill(self, rings: Iterable[Sequence[Spot]], *, grey: float) -> None:
        """Fill the area enclosed by rings, by the even-odd rule."""
        drawn = path((ring for ring in rings if len(ring) > 2), digits=2, closed=True)
        if drawn:
            self._parts.append(shape("path", d=drawn, fill=_ink(grey), fill_rule="evenodd"))

    def box(self, box: Box, *, grey: float) -> None:
        """Draw a filled rectangle."""
        left, top, right, bottom = box
        self.fill([[(left, top), (right, top), (right, bottom), (left, bottom)]], grey=grey)

    def disc(self, at: Spot, radius: float, *, grey: float = 1.0, edge: float = THIN) -> None:
        """Draw a disc with a black edge of some width [mm]; 0 for none."""
        x, y, r = (number(value, 2) for value in (*at, radius))
        stroke = {"stroke": "black", "stroke_width": f"{edge:g}"} if edge else {}
        self._parts.append(shape("circle", cx=x, cy=y, r=r, fill=_ink(grey), **stroke))

    def text(
        self,
        at: Spot,
        words: str,
        *,
        size: float = 8.5,
        anchor: str = "middle",
        bold: bool = False,
        grey: float = 0.0,
        halo: bool = False,
        color: str | None = None,
    ) -> None:
        """Words of a size [pt], their middle at the height of `at`; with `halo` lines behind them stop short."""
        if halo:
            wide, high = Canvas.text_size(words, size, bold=bold)
            left = at[0] - wide * {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor]
            self.box((left - 0.3, at[1] - high / 2, left + wide + 0.3, at[1] + high / 2), grey=1.0)
        x, y, height = (number(value, 2) for value in (at[0], at[1] + 0.32 * size * POINT, size * POINT))
        face = {"font_size": height, "font_weight": "bold" if bold else None}
        self._parts.append(tag("text", words, x=x, y=y, text_anchor=anchor, **face, fill=color or _ink(grey)))

    def balloon(self, at: Spot, words: str, *, dark: bool = False, size: float = 9.0) -> None:
        """Words in a circle, white on black if `dark`."""
        radius = Canvas.balloon_radius(words, size)
        self.disc(at, radius, grey=0.0 if dark else 1.0, edge=self.MIDDLE)
        self.text(at, words, size=size, bold=True, grey=1.0 if dark else 0.0)

    def arrow(self, start: Spot, end: Spot, *, width: float = THICK, head: float = 2.2) -> None:
        """Draw a straight arrow with a filled head."""
        way = np.subtract(end, start)
        way = way / max(float(np.hypot(*way)), 1e-9)
        aside, foot = np.array([-way[1], way[0]]), np.array(end) - head * way
        corners = [np.array(end), foot + 0.38 * head * aside, foot - 0.38 * head * aside]
        self.line([[start, _spot(foot)]], width=width)
        self.fill([[_spot(corner) for corner in corners]], grey=0.0)

    def drawing(self, drawing: LineDrawing, frame: CanvasFrame) -> None:
        """Draw the lines and tones of solids."""
        for grey, rings in drawing.tones:
            self.fill([frame.way(ring) for ring in rings], grey=grey)
        self.line([frame.way(way) for way in drawing.lines], width=self.THIN)
        self.line([frame.way(way) for way in drawing.outlines], width=self.MIDDLE)

    @staticmethod
    def balloon_radius(words: str, size: float = 9.0) -> float:
        """Radius of the circle round words [mm]."""
        return max(0.62 * size * POINT, 0.56 * Canvas.text_size(words, size)[0] + 0.35)

    @staticmethod
    def text_size(words: str, size: float, *, bold: bool = False) -> tuple[float, float]:
        """Approximate width and height [mm] of a text of a size [pt]."""
        letters = 1.1 * (len(words) + 0.25 * words.count("C")) if bold else len(words)
        return 0.5 * size * POINT * (letters + words.count("W")), 0.75 * size * POINT

    @staticmethod
    def fit_height(box: Float[np.ndarray, "2 2"], width: float, height: float) -> float:
        """Height of a drawing scaled to the largest size that fits a width and a height [mm]."""
        wide, high = np.maximum(box[1] - box[0], 1e-9).tolist()
        return min(height, width * high / wide)


def _ink(grey: float) -> str:
    level = round(255 * min(max(grey, 0.0), 1.0))
    return f"#{level:02x}{level:02x}{level:02x}"


def _spot(place: np.ndarray) -> Spot:
    return float(place[0]), float(place[1])
