"""`picture`, `show_large`: pictures of what was made, small and large."""

import base64
from collections.abc import Callable, Sequence

from nicegui import ui

from hydrostat.studio.exporting.download import Download


def picture(content: bytes, title: str, enlarge: Callable[[], None], *, kind: str = "png") -> None:
    """A small picture that shows itself large when it is pressed."""
    button = ui.button(on_click=enlarge).props(f'flat no-caps padding=none aria-label="{_plain(title)}, larger"')
    with button.classes("export-picture"), ui.column().classes("w-full gap-0"):
        ui.image(_address(content, kind)).props("fit=contain no-spinner no-transition").classes("export-thumb")
        ui.label(title).classes("export-caption")


def show_large(pictures: Sequence[bytes], title: str, download: Download | None = None, *, kind: str = "png") -> None:
    """Pictures below each other, as large as the window; they are gone when they are closed."""
    with ui.dialog() as dialog, ui.card().classes("export-large"):
        with ui.element("div").classes("studio-row"):
            ui.label(title).classes("studio-title flex-1")
            if download is not None:
                save = ui.button("Download", icon="download").props("flat no-caps")
                save.on_click(lambda: ui.download.content(download.content, download.name, download.media_type))
            ui.button(icon="close", on_click=dialog.close).props('flat round dense aria-label="Close"')
        with ui.scroll_area().classes("export-pages"):
            for content in pictures:
                ui.image(_address(content, kind)).props("no-spinner no-transition").classes("export-page")
    dialog.on("hide", dialog.delete)
    dialog.open()


def _address(content: bytes, kind: str) -> str:
    """A picture as an address of its own, so that nothing in it can reach the page."""
    media = {"png": "image/png", "svg": "image/svg+xml"}[kind]
    return f"data:{media};base64,{base64.b64encode(content).decode()}"


def _plain(words: str) -> str:
    return words.replace('"', "'")
