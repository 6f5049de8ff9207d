"""`download_button`, `send`: files from the session to the person."""

from nicegui import ui

from hydrostat.studio.exporting.download import Download


def download_button(download: Download) -> None:
    """A button that hands over a file."""
    button = ui.button(on_click=lambda: send(download)).props("unelevated no-caps").classes("w-full")
    button.props(f'data-testid="download-{download.name}"')
    with button:
        ui.icon("download", size="20px").classes("q-mr-sm")
        ui.label(download.name).classes("ellipsis")
        ui.label(download.size).classes("export-size")


def send(download: Download) -> None:
    """Hand over a file to the person of this window."""
    ui.download.content(download.content, download.name, download.media_type)
