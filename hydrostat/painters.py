"""Registry of functions that draw records: the top package fills it, so that lower rooms need not import `plot`."""

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
