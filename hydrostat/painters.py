"""Registry of functions that draw records, and of two that know motors: lower rooms need not import upper ones."""

import base64
import html
import io
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Painter = Callable[..., "Figure"]

_registered: dict[str, Painter] = {}


def register_painters(painters: dict[str, Painter]) -> None:
    """Register functions that draw records, by the kind of picture."""
    _registered.update(painters)


def draw_record(kind: str, *records: object, **options: Any) -> "Figure":
    """Draw records by the function that is registered for this kind of picture, such as "pose"."""
    return _registered[kind](*records, **options)


def make_winch_parts(robot: object) -> Any:
    """Make the parts of the body that are winches, by the function registered as "winches": it knows the motors."""
    return _registered["winches"](robot)


def check_motor(key: str) -> None:
    """Check that a motor has this key, by the function registered as "motor" (InputError: none has it)."""
    _registered["motor"](key)


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
