"""`dress`: colours and measures of the page, light and dark."""

from pathlib import Path

from nicegui import ui

STATIC = Path(__file__).parent / "static"


def dress() -> ui.dark_mode:
    """Dress the page of this window; returns its switch between light and dark."""
    ui.colors(primary="#0b5fa5", secondary="#b9774b", accent="#a8256f", positive="#00795f", negative="#c8243f",
              dark="#2a2732")  # fmt: skip
    for style in sorted(STATIC.glob("*.css")):
        ui.add_css(style.read_text(encoding="utf-8"))
    return ui.dark_mode(None)
