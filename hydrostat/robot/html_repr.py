"""HTML representation of a record for notebooks: its text above its picture."""

import base64
import html
import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
