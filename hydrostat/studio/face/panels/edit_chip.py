"""`chip`, `light`: small buttons of which some are on."""

from collections.abc import Callable
from typing import Any

from nicegui import ui


def chip(words: str, press: Callable[[], Any]) -> ui.button:
    """A chip that is off."""
    button = ui.button(words, on_click=press, color=None).props('dense flat padding="1px 10px" no-caps')
    return button.style("font-size: 13px; border-radius: 9px; min-height: 26px")


def light(button: ui.button, on: bool) -> None:
    """Show whether a chip is on."""
    button.style(f"background: {'#0b5fa5' if on else 'transparent'}; color: {'white' if on else 'var(--ink)'}")
