"""What chapters of the report are made of."""

from typing import NamedTuple

from matplotlib.figure import Figure

from hydrostat.plot.html import Html, tag
from hydrostat.plot.picture_file import inline_svg

NARROW = 4.9
"""Width of pictures that stand side by side [inch]: the narrower, the larger their letters."""


class Chapter(NamedTuple):
    """A part of the story: its headline, what happens, and what there is to see."""

    head: str
    words: str
    parts: list[Html]


def section(number: int, chapter: Chapter) -> Html:
    """A chapter under its number."""
    words = tag("div", tag("h2", chapter.head), tag("p", chapter.words))
    return tag("section", tag("header", tag("div", number, class_="step"), words), *chapter.parts)


def picture(figure: Figure, name: str, head: str, words: str, **attributes: object) -> Html:
    """A figure with a name of its own on the page, and what it shows: a headline and words that follow it."""
    svg = Html(inline_svg(figure, name=name, label=head + words))
    return tag("figure", svg, tag("figcaption", tag("b", head), words), **attributes)


def grid(*pictures: Html, kind: str = "") -> Html:
    """Pictures side by side; `kind` is a class of the style, for more than one."""
    return tag("div", *pictures, class_=f"grid {'one' if len(pictures) == 1 else kind}".strip())
