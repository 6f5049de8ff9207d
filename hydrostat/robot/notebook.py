"""`notebook_html`: what a notebook shows of a record: its line, and a picture."""

import base64
import html
import io
from typing import Any


def notebook_html(words: str, figure: Any) -> str:
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
