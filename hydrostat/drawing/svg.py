"""Elements of SVG drawings: text that is safe in a page, numbers that are no longer than need be, paths."""

import html
from collections.abc import Iterable, Sequence

import numpy as np

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
    """Number with a largest number of digits after the point, one or more, without a minus before nought."""
    return f"{round(value, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".")


def path(lines: Iterable[Iterable[Sequence[float] | np.ndarray]], *, digits: int, closed: bool = False) -> str:
    """Path data of straight lines through points; y counts down."""
    end = "Z" if closed else ""
    return "".join("M" + "L".join(f"{number(x, digits)} {number(y, digits)}" for x, y in line) + end for line in lines)
