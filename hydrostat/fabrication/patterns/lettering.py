"""`Lettering`: text as single strokes, for machines that follow lines and have no fonts."""

import unicodedata
from dataclasses import dataclass
from types import MappingProxyType

from hydrostat.fabrication.patterns.shape import LaserLine, Layer, PatternPart, Place


@dataclass(frozen=True)
class Lettering:
    """One line of text, about its middle."""

    text: str  # any text; small letters are drawn as capitals, accents left off, what has no letter drawn as a box
    height: float  # height of a capital letter [mm]

    @property
    def width(self) -> float:
        """Width from the first stroke to the last [mm]."""
        return self._scale * max((x for stroke in self._strokes for x, _ in stroke), default=0.0)

    def lines(self, middle: Place) -> tuple[LaserLine, ...]:
        """The strokes, with the text's middle at a place [mm]."""
        left, bottom = middle[0] - self.width / 2, middle[1] - self.height / 2
        return tuple(
            LaserLine(
                layer=Layer.GUIDE,
                part=PatternPart.TEXT,
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
        space = 3.0
        between = 2.0
        for letter in _plain(self.text):
            if letter == " ":
                pen += space
                continue
            glyph = [_points(stroke) for stroke in GLYPHS.get(letter, UNKNOWN).split()]
            left = min(x for stroke in glyph for x, _ in stroke)
            right = max(x for stroke in glyph for x, _ in stroke)
            strokes.extend([(pen + x - left, y) for x, y in stroke] for stroke in glyph)
            pen += right - left + between
        return strokes


def _plain(text: str) -> str:
    """Capitals without accents, one space for any white space."""
    apart = unicodedata.normalize("NFKD", " ".join(text.split()).upper())
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def _points(stroke: str) -> list[Place]:
    return [(float(x), float(y)) for x, y in zip(stroke[::2], stroke[1::2], strict=True)]


CAP_HEIGHT = 6  # height of every capital and figure, in units of the font
UNKNOWN = "0006464000"  # the box drawn for a character that has no glyph

GLYPHS = MappingProxyType(
    {
        "A": "0004264440 0343",
        "B": "00063645443303 3342413000",
        "C": "4536160501103041",
        "D": "00062644422000",
        "E": "46060040 0333",
        "F": "460600 0333",
        "G": "45361605011030414323",
        "H": "0006 4046 0343",
        "I": "1030 2026 1636",
        "J": "0110304146",
        "K": "0006 4603 1340",
        "L": "060040",
        "M": "0006234640",
        "N": "00064046",
        "O": "100105163645413010",
        "P": "00063645443303",
        "Q": "100105163645413010 2240",
        "R": "00063645443303 2340",
        "S": "453616050413334241301001",
        "T": "0646 2026",
        "U": "060110304146",
        "V": "062046",
        "W": "0610243046",
        "X": "0046 0640",
        "Y": "062346 2320",
        "Z": "06460040",
        "0": "100105163645413010 0145",
        "1": "152620 1030",
        "2": "05163645440040",
        "3": "0516364544334241301001 1333",
        "4": "30360242",
        "5": "460604344341301001",
        "6": "4536160501103041423303",
        "7": "064620",
        "8": "13040516364544331302011030414233",
        "9": "0110304145361605041343",
        "-": "1333",
        "_": "0040",
        "+": "0343 2125",
        "=": "0242 0444",
        ".": "2021",
        ",": "2110",
        ":": "2122 2425",
        ";": "2110 2425",
        "!": "2622 2021",
        "?": "051636454423 2221",
        "'": "2624",
        '"': "1614 3634",
        "/": "0046",
        "\\": "0640",
        "|": "2026",
        "(": "26151120",
        ")": "16252110",
        "[": "26161020",
        "]": "16262010",
        "<": "450341",
        ">": "054301",
        "*": "0343 1135 3115",
        "#": "1016 3036 0242 0444",
        "%": "0046 0616 3040",
        "&": "4214153635130110203042",
        "°": "1415252414",
    }
)
"""Strokes of every character."""
