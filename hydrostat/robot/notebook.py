"""`picture_of`: a record's own picture; `notebook_html`: what a notebook shows of it: its line, and the picture."""

import base64
import html
import io
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def picture_of(kind: str, *records: object, **options: Any) -> "Figure":
    """The picture that `hydrostat.plot.draw_<kind>` makes of some records.

    Records know no pictures: that room is above theirs, and is looked up by its name only when a person asks.
    """
    return getattr(import_module("hydrostat.plot"), f"draw_{kind}")(*records, **options)


def notebook_html(words: str, figure: "Figure") -> str:
    """One element of HTML: the words above the picture.

    Args:
        words: what is to be said.
        figure: of Matplotlib, as all pictures of hydrostat are.
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    picture = base64.b64encode(buffer.getvalue()).decode()
    shown = html.escape(words)
    return f'<div><pre>{shown}</pre><img alt="{shown}" src="data:image/png;base64,{picture}"></div>'
