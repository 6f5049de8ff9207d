"""What the pages of a report are made of: chapters, tables, pictures with words, bars."""

from collections.abc import Iterable, Sequence
from importlib.resources import files
from typing import NamedTuple

from matplotlib.figure import Figure

from hydrostat.drawing.svg import Html, tag
from hydrostat.plot.picture_file import inline_svg

NARROW = 4.9  # width of pictures that stand side by side [inch]: the narrower, the larger their letters


class Chapter(NamedTuple):
    """A part of the story: its headline, what happens, and what there is to see."""

    head: str
    words: str
    parts: list[Html]


def page(title: str, *content: Html) -> str:
    """A page as text: content under a title in the look of all reports, without need of another file or a network."""
    style = (files("hydrostat.plot") / "report.css").read_text(encoding="utf-8")
    head = tag(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        Html('<meta name="color-scheme" content="light dark">'),
        tag("title", f"{title} \N{MIDDLE DOT} hydrostat"),
        tag("style", Html(f"\n{style}")),
    )
    return f'<!doctype html>\n<html lang="en">{head}<body>{tag("main", *content)}</body></html>\n'


def fact(number: str, unit: str, words: str, *, best: bool = False) -> Html:
    """A large number at the top of a page, and what it says."""
    shown = tag("b", number, tag("small", unit))
    return tag("li", shown, tag("span", words), class_="best" if best else None)


def section(number: int, chapter: Chapter) -> Html:
    """A chapter under its number."""
    words = tag("div", tag("h2", chapter.head), tag("p", chapter.words))
    return tag("section", tag("header", tag("div", number, class_="step"), words), *chapter.parts)


def picture(figure: Figure, name: str, head: str, words: str) -> Html:
    """A figure with a name of its own on the page, and what it shows: a headline and words that follow it."""
    return captioned(Html(inline_svg(figure, name=name, label=head + words)), head, words)


def captioned(content: Html, head: str, words: str, *, kind: str | None = None) -> Html:
    """A picture over its headline and words; `kind` is a class of the style."""
    return tag("figure", content, tag("figcaption", tag("b", head), words), class_=kind)


def grid(*pictures: Html, kind: str = "") -> Html:
    """Pictures side by side; `kind` is a class of the style, for more than one."""
    return tag("div", *pictures, class_=f"grid {'one' if len(pictures) == 1 else kind}".strip())


def table(heads: Sequence[str], rows: Iterable[Sequence[object]], *, numbers: Iterable[int] = ()) -> Html:
    """A table; columns `numbers` are set flush right."""
    right = set(numbers)

    def line(kind: str, cells: Sequence[object]) -> Html:
        return tag("tr", *(tag(kind, cell, class_="number" if i in right else None) for i, cell in enumerate(cells)))

    body = [line("td", row) for row in rows]
    return tag(
        "div", tag("table", tag("thead", line("th", heads) if any(heads) else ""), tag("tbody", *body)), class_="table"
    )


def bar(share: float, colour: str) -> Html:
    """A bar filled to a share, 0 to 1."""
    width = 100 * min(max(share, 0.0), 1.0)
    return tag("span", tag("i", style=f"width:{width:.1f}%;background:{colour}"), class_="bar")


def swatch(colour: str) -> Html:
    """A dot of a colour."""
    return tag("i", class_="swatch", style=f"background:{colour}")
