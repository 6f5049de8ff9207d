"""Words of a robot for people: key paths in plain words, and one element of HTML for notebooks."""

import base64
import html
import io
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_NAMED = re.compile(r"\b(winch|marker)\[\d+\](?= )")
_POINT = re.compile(r"\bcable\[(\d+)\]\.points\[(\d+)\]")
_RUN = re.compile(r"\bcable\[(\d+)\] between points (\d+) and (\d+)")
_PART = re.compile(r"\b(pin|winch|cable|marker|pose)\[(\d+)\]")


def in_words(text: str) -> str:
    """Sentence in plain words: "cable 1, point 3" for "cable[0].points[2]", "winch left" for "winch[0] left"."""
    text = _POINT.sub(lambda match: f"cable {_next(match[1])}, point {_next(match[2])}", _NAMED.sub(r"\1", text))
    text = _RUN.sub(lambda run: f"cable {_next(run[1])} between points {_next(run[2])} and {_next(run[3])}", text)
    return _PART.sub(lambda match: f"{match[1]} {_next(match[2])}", text)


def _next(number: str) -> int:
    return int(number) + 1


def html_repr(text: str, figure: "Figure") -> str:
    """Return one element of HTML: a text above a picture.

    Args:
        text: description of the record.
        figure: Matplotlib figure, which all pictures of hydrostat are.
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    picture = base64.b64encode(buffer.getvalue()).decode()
    shown = html.escape(text)
    return f'<div><pre>{shown}</pre><img alt="{shown}" src="data:image/png;base64,{picture}"></div>'
