"""`Html`: text that is already safe in a page; everything else is escaped on its way in."""

import html
from collections.abc import Iterable, Sequence


class Html(str):
    """Text that may stand in a page as it is."""

    __slots__ = ()


def safe(content: object) -> Html:
    """Content as it may stand in a page: `Html` as it is, lists joined, anything else escaped."""
    if isinstance(content, Html):
        return content
    if isinstance(content, list | tuple):
        return Html("".join(safe(part) for part in content))
    return Html(html.escape(str(content)))


def tag(name: str, *content: object, **attributes: object) -> Html:
    """An element. In the names of attributes a last underscore is dropped, others become hyphens."""
    pairs = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{html.escape(str(value))}"' for key, value in attributes.items()
    )
    return Html(f"<{name}{pairs}>{safe(list(content))}</{name}>")


def table(heads: Sequence[str], rows: Iterable[Sequence[object]], *, numbers: Iterable[int] = ()) -> Html:
    """A table; columns `numbers` are set flush right."""
    right = set(numbers)

    def line(kind: str, cells: Sequence[object]) -> Html:
        styles = [{"class_": "number"} if index in right else {} for index in range(len(cells))]
        return tag("tr", *[tag(kind, cell, **style) for cell, style in zip(cells, styles, strict=True)])

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
