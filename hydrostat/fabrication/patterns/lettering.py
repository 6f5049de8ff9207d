"""`Lettering`: text as single strokes, for machines that follow lines and know no fonts."""

import unicodedata
from dataclasses import dataclass

from hydrostat.fabrication.patterns.shape import Layer, Line, Part, Place
from hydrostat.fabrication.patterns.stroke_font import CAP_HEIGHT, GLYPHS, UNKNOWN

_SPACE = 3.0
_BETWEEN = 2.0


@dataclass(frozen=True)
class Lettering:
    """One line of text, about its middle.

    Attributes:
        text: any text; small letters are drawn as capitals, accents left off, what has no letter drawn as a box.
        height: of a capital [mm].
    """

    text: str
    height: float

    @property
    def width(self) -> float:
        """From the first stroke to the last [mm]."""
        return self._scale * max((x for stroke in self._strokes for x, _ in stroke), default=0.0)

    def lines(self, middle: Place) -> tuple[Line, ...]:
        """The strokes, with the text's middle at a place [mm]."""
        left, bottom = middle[0] - self.width / 2, middle[1] - self.height / 2
        return tuple(
            Line(
                layer=Layer.MARK,
                part=Part.TEXT,
                points=tuple((left + self._scale * x, bottom + self._scale * y) for x, y in stroke),
            )
            for stroke in self._strokes
        )

    @property
    def _scale(self) -> float:
        return self.height / CAP_HEIGHT

    @property
    def _strokes(self) -> list[list[Place]]:
        """Strokes in units of the font, the first letter at x = 0."""
        strokes: list[list[Place]] = []
        pen = 0.0
        for letter in _plain(self.text):
            if letter == " ":
                pen += _SPACE
                continue
            glyph = [_points(stroke) for stroke in GLYPHS.get(letter, UNKNOWN).split()]
            left = min(x for stroke in glyph for x, _ in stroke)
            right = max(x for stroke in glyph for x, _ in stroke)
            strokes.extend([(pen + x - left, y) for x, y in stroke] for stroke in glyph)
            pen += right - left + _BETWEEN
        return strokes


def _plain(text: str) -> str:
    """Capitals without accents, one space for any white space."""
    apart = unicodedata.normalize("NFKD", " ".join(text.split()).upper())
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def _points(stroke: str) -> list[Place]:
    return [(float(x), float(y)) for x, y in zip(stroke[::2], stroke[1::2], strict=True)]
